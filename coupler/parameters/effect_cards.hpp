// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/diagnostics/effects.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

using CouplingCard = diagnostics::EffectCard<CouplingParameters>;
/// All that a coupling can have beside one pass a step over matching surfaces, in the order in which it is told.
std::span<const CouplingCard> coupling_effect_cards();

}  // namespace couplet::coupler
