// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/diagnostics/finding.hpp"
#include "solid_solver/effects/evidence.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

/// Judges by the evidence of a run the effects that its scene leaves out, or has in vain.
std::vector<diagnostics::Finding> effect_findings(const SolidParameters& parameters,
                                                  const SolidEvidence& evidence);

}  // namespace couplet::solid
