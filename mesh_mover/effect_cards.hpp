// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/effects/card.hpp"
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {

/// Bad cells are refused when they appear, so that nothing is left for a verdict at the end.
struct Evidence {};
using Card = effects::EffectCard<Parameters, Evidence>;
std::span<const Card> effect_cards();

}  // namespace couplet::mesh_mover
