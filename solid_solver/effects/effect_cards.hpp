// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/diagnostics/effects.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

using SolidCard = diagnostics::EffectCard<SolidParameters>;
/// Tells whether a volume strain of the cells stands for that of the faces, so that nothing locks near incompressibility.
bool has_volume_strain_of_cells(const SolidParameters& parameters);
/// All that a solid can simulate beside linear elasticity, in the order in which it is told.
std::span<const SolidCard> solid_effect_cards();

}  // namespace couplet::solid
