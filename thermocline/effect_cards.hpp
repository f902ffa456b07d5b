// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/effects/card.hpp"
#include "thermocline/elsewhere.hpp"

namespace couplet::thermocline {

/// The verdicts of a tank are sentences of tank_effects.cpp.
struct Evidence {};
using Card = EffectCard<ElementParameters, Evidence>;
std::span<const Card> effect_cards();

}  // namespace couplet::thermocline
