// SPDX-License-Identifier: Apache-2.0
#include "common/log/timer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace couplet::log {

std::string Timers::table(const std::string& title, double total) const {
  std::vector<std::pair<std::string, Entry>> rows(entries_.begin(), entries_.end());
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto& a, const auto& b) { return a.second.seconds > b.second.seconds; });
  std::size_t width = title.size();
  for (const auto& [name, entry] : rows) width = std::max(width, name.size());
  const auto share = [total](double seconds) { return total > 0 ? 100 * seconds / total : 0.0; };
  std::string out = fmt::format("{:<{}}  {:>10}  {:>7}  {:>9}\n", title, width, "seconds", "share", "calls");
  for (const auto& [name, entry] : rows)
    out += fmt::format("{:<{}}  {:>10.3f}  {:>5.1f} %  {:>9}\n", name, width, entry.seconds,
                       share(entry.seconds), entry.calls);
  out += fmt::format("{:<{}}  {:>10.3f}  {:>5.1f} %\n", "total", width, total, share(total));
  return out;
}

Timers& timers() {
  static Timers all;
  return all;
}

}  // namespace couplet::log
