// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/diagnostics/effects.hpp"
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {

using Card = diagnostics::EffectCard<Parameters>;
std::span<const Card> effect_cards();

}  // namespace couplet::mesh_mover
