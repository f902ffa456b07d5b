// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>

#include "common/effects/card.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

/// What a run has found out (CouplingAudit); most of what the coupler sees is judged by its guards while it runs
/// (guards.hpp). NaN: not known.
struct CouplingEvidence {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double returned =
      unknown;  ///< of a change of the motion: what the next pass makes of it, |H(H(x)) - H(x)| / |H(x) - x|
  double lost_load =
      unknown;  ///< forces at faces that nobody takes, over those taken (root mean squares over faces and steps)
};
/// Share of a change of the motion that one pass a step bears to have returned by the next pass.
double limit_of_one_pass(const CouplingParameters& parameters);
using CouplingCard = effects::EffectCard<CouplingParameters, CouplingEvidence>;
/// All that a coupling can have beside one pass a step over matching surfaces, in the order in which it is told.
std::span<const CouplingCard> coupling_effect_cards();

}  // namespace couplet::coupler
