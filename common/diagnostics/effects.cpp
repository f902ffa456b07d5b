// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/effects.hpp"

#include <fmt/format.h>

#include <algorithm>

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

std::string summary(const std::vector<Effect>& effects) {
  std::string on, off;
  for (const Effect& e : effects) {
    std::string& list = e.on() ? on : off;
    list += list.empty() ? "" : ", ";
    list += e.on() ? fmt::format("{} ({})", e.name, e.asked_by) : e.name;
  }
  return fmt::format("effects: {}{}{}", on.empty() ? "none" : on, off.empty() ? "" : "; off: ", off);
}

std::string explanation(const std::vector<Effect>& effects) {
  std::string lines;
  for (const bool on : {true, false})
    for (const Effect& e : effects)
      if (e.on() == on)
        lines +=
            on ? fmt::format("  on   {}: enabled by {}{}{}\n", e.name, e.asked_by,
                             e.adds.empty() ? "" : "; adds ", e.adds)
               : fmt::format(
                     "  off  {}: {}{}\n", e.name, e.keys,
                     e.judged_when_on || e.judged_by.empty() ? "" : "; judged by the run: " + e.judged_by);
  return lines;
}

std::string markdown(const std::string& program, const std::vector<Effect>& effects) {
  std::string lines = fmt::format(
      "## {}\n\n| effect | enabled by | adds | judged when neglected |\n|---|---|---|---|\n", program);
  for (const Effect& e : effects)
    lines += fmt::format("| {} | {} | {} | {} |\n", e.name, e.keys, e.adds, e.judged_by);
  return lines;
}

}  // namespace couplet::diagnostics
