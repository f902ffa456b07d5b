// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/choices.hpp"

#include <fmt/format.h>

namespace couplet::diagnostics {

std::string text(const EffectChoice& c) {
  if (c.given)
    return fmt::format("auto: {}: set by the case; auto would choose {} ({})", c.key, c.what, c.reason);
  return fmt::format("auto: {}{}{} ({})", c.key, c.key.empty() ? "" : ": ", c.what, c.reason);
}

}  // namespace couplet::diagnostics
