// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/within_step.hpp"

#include <fmt/format.h>

#include <charconv>

namespace couplet::coupling {

std::string WithinStep::name(const std::string& datum, double share) {
  return fmt::format("{}{}{:.15g}", datum, mark, share);
}

std::optional<std::pair<std::string, double>> WithinStep::parse(std::string_view name) {
  const std::size_t at = name.rfind(mark);
  if (at == std::string_view::npos || at == 0) return {};
  const char* last = name.data() + name.size();
  double share = 0;
  const auto [end, code] = std::from_chars(name.data() + at + 1, last, share);
  if (code != std::errc() || end != last || !(share > 0 && share < 1)) return {};
  return std::pair(std::string(name.substr(0, at)), share);
}

}  // namespace couplet::coupling
