// SPDX-License-Identifier: Apache-2.0
#include "common/effects/position.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace couplet::effects {
void keep_nearest(std::vector<Coordinate>& kept, const std::vector<Coordinate>& seen) {
  for (const Coordinate& c : seen) {
    const auto before = std::ranges::find(kept, c.quantity, &Coordinate::quantity);
    if (before == kept.end())
      kept.push_back(c);
    else if (c.used() > before->used())
      *before = c;
  }
}

std::string position_sentence(const std::vector<Coordinate>& position) {
  if (position.empty()) return {};
  std::string list;
  for (const Coordinate& c : position)
    list += fmt::format("{}{} {:.3g} of {}{:.3g}", list.empty() ? "" : ", ", c.quantity, c.value,
                        c.floor ? "at least " : "", c.limit);
  const Coordinate& nearest = *std::ranges::max_element(position, {}, &Coordinate::used);
  const double used = nearest.used();
  return fmt::format("on the map: {}; {}: {} (docs/stability.md, map {}).", list,
                     used > 1 ? "beyond the limit" : "nearest limit",
                     fmt::format("{}, {:.0f} % of the way", nearest.quantity, 100 * used), nearest.map);
}

}  // namespace couplet::effects
