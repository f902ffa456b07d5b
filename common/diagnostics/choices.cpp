// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/choices.hpp"

#include <fmt/format.h>

namespace couplet::diagnostics {

std::string text(const EffectChoice& c) {
  if (c.given)
    return fmt::format("auto: {}: set by the case; auto would choose {} ({})", c.key, c.what, c.reason);
  return fmt::format("auto: {}{}{} ({})", c.key, c.key.empty() ? "" : ": ", c.what, c.reason);
}

std::string text(const ExpectedCost& c) {
  const bool long_step = c.seconds_a_step >= 1;
  return fmt::format(
      "{} cells: about {:.0f} MB, {:.2g} {} per step on one rank (time within a factor of "
      "three)",
      c.cells, 1e-6 * c.bytes, long_step ? c.seconds_a_step : 1e3 * c.seconds_a_step, long_step ? "s" : "ms");
}

}  // namespace couplet::diagnostics
