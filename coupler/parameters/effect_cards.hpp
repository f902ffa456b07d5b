// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/diagnostics/effects.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

using CouplingCard = diagnostics::EffectCard<CouplingParameters>;
/// Features of a coupling beyond one pass per step over matching surfaces, in the order of the report.
std::span<const CouplingCard> coupling_effect_cards();

}  // namespace couplet::coupler
