// SPDX-License-Identifier: Apache-2.0
#include "common/log/progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace couplet::log {

std::string format_duration(double seconds) {
  if (seconds < 9.95) return fmt::format("{:.1f} s", std::max(seconds, 0.0));
  const long s = std::lround(seconds);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  const long minutes = std::lround(seconds / 60);
  if (minutes < 24 * 60) return fmt::format("{} h {} min", minutes / 60, minutes % 60);
  const long hours = std::lround(seconds / 3600);
  return fmt::format("{} d {} h", hours / 24, hours % 24);
}

std::string eta(double done, double total, double wall_seconds) {
  if (done <= 0) return "";
  return fmt::format("ETA {}", format_duration(wall_seconds * std::max(total - done, 0.0) / done));
}

}  // namespace couplet::log
