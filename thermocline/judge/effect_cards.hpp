// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/diagnostics/effects.hpp"
#include "thermocline/judge/elsewhere.hpp"

namespace couplet::thermocline {

using Card = diagnostics::EffectCard<ElementParameters>;
std::span<const Card> effect_cards();

}  // namespace couplet::thermocline
