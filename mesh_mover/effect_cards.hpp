// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/effects/effects.hpp"
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {

using Card = effects::EffectCard<Parameters>;
std::span<const Card> effect_cards();

}  // namespace couplet::mesh_mover
