// SPDX-License-Identifier: Apache-2.0
#include "common/time/step_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"

namespace couplet::time {
namespace {

// "Of late" is about this part of the time that has gone by.
constexpr double window = 0.25;

}  // namespace

void StepErrors::add(const Seen& seen, int steps) {
  if (!std::isfinite(seen.error + seen.rate + seen.size + seen.below + seen.highest)) return;
  time_ += steps * seen.dt;
  const double kept = std::exp(-steps * seen.dt / (window * time_));
  for (const auto& [of_late, now] :
       {std::pair{&rate_, seen.rate}, {&size_, seen.size}, {&below_, seen.below}, {&highest_, seen.highest}})
    *of_late = std::max(now, kept * *of_late);
  if (seen.forgotten > 0)
    for (auto& [of, sum] : errors_) sum.kept *= std::exp(-seen.forgotten * steps * seen.dt);
  if (!(seen.error > 0) || !(rate_ > 0)) return;
  int swing = 0;
  double amplitude = std::numeric_limits<double>::infinity();
  if (seen.order > 0 && below_ > 0 && highest_ > 0) {
    const double frequency = highest_ / below_;
    swing = std::ilogb(frequency);
    amplitude = below_ / std::pow(frequency, seen.order);
  }
  Sum& sum = errors_[{swing, std::ilogb(rate_)}];
  sum.all += steps * seen.error, sum.kept += steps * seen.error;
  amplitude_[swing] = std::max(amplitude_[swing], amplitude);
}

double StepErrors::over_size() const {
  if (!(size_ > 0)) return std::numeric_limits<double>::quiet_NaN();
  std::map<int, double> left;
  for (const auto& [key, sum] : errors_) {
    const auto [swing, level] = key;
    const double shrunk = level >= std::ilogb(rate_) ? std::min(1.0, rate_ / std::ldexp(1.0, level)) : 1.0;
    left[swing] += std::min(sum.all * shrunk, sum.kept);
  }
  double all = 0;
  for (const auto& [swing, error] : left) all += std::min(error, 2 * amplitude_.at(swing));
  return all / size_;
}

}  // namespace couplet::time
