// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace couplet::effects {

/// What a run of a participant on one rank is expected to take, from measured runs of small cases.
struct ExpectedCost {
  std::size_t cells = 0;
  double bytes = 0;           ///< at the most, to about a fifth
  double seconds_a_step = 0;  ///< of the solver, to a factor of three: it depends on the machine and the flow
};

/// "4096 cells: about 54 MB, 20 ms a step on one rank (time to a factor of three)"
std::string text(const ExpectedCost& cost);

}  // namespace couplet::effects
