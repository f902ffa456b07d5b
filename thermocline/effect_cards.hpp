// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/effects/effects.hpp"
#include "thermocline/model/elements.hpp"

namespace couplet::thermocline {

using Card = effects::EffectCard<ElementParameters>;
std::span<const Card> effect_cards();

}  // namespace couplet::thermocline
