// SPDX-License-Identifier: Apache-2.0
#include "common/effects/expected.hpp"

#include <fmt/format.h>

namespace couplet::effects {

std::string text(const ExpectedCost& c) {
  const bool long_step = c.seconds_a_step >= 1;
  return fmt::format(
      "{} cells: about {:.0f} MB, {:.2g} {} per step on one rank (time within a factor of "
      "three)",
      c.cells, 1e-6 * c.bytes, long_step ? c.seconds_a_step : 1e3 * c.seconds_a_step, long_step ? "s" : "ms");
}

}  // namespace couplet::effects
