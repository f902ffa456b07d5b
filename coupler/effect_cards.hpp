// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/effects/card.hpp"
#include "coupler/parameters.hpp"

namespace couplet {

/// What the coupler has seen is judged by its guards while it runs (guards.hpp): nothing is left for a verdict.
struct CouplingEvidence {};
using CouplingCard = EffectCard<CouplingParameters, CouplingEvidence>;
/// All that a coupling can have beside one pass a step over matching surfaces, in the order in which it is told.
std::span<const CouplingCard> coupling_effect_cards();

}  // namespace couplet
