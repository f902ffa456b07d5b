// SPDX-License-Identifier: Apache-2.0
#include "common/time/step_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/numbers.hpp"

namespace couplet::time {
namespace {

// Fraction of the elapsed time that counts as recent.
constexpr double window = 0.25;

}  // namespace

void StepErrors::add(const Inputs& seen, int steps) {
  if (!std::isfinite(seen.error + seen.rate + seen.size + seen.below + seen.highest)) return;
  time_ += steps * seen.dt;
  way_ += steps * seen.dt * seen.rate;
  largest_ = std::max(largest_, seen.size);
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
  Sum& sum = errors_[{swing, std::ilogb(fading())}];
  sum.all += steps * seen.error, sum.kept += steps * seen.error;
  amplitude_[swing] = std::max(amplitude_[swing], amplitude);
}

double StepErrors::over_size() const {
  if (!(size_ > 0)) return std::numeric_limits<double>::quiet_NaN();
  std::map<int, double> left;
  for (const auto& [key, sum] : errors_) {
    const auto [swing, level] = key;
    const double shrunk =
        level >= std::ilogb(fading()) ? std::min(1.0, fading() / std::ldexp(1.0, level)) : 1.0;
    left[swing] += std::min(sum.all * shrunk, sum.kept);
  }
  double all = 0;
  for (const auto& [swing, error] : left) all += std::min(error, 2 * amplitude_.at(swing));
  return all / size_;
}

StepErrors::Inputs VelocityErrors::add(std::span<const double> before, std::span<const double> now, double dt,
                                       double dt_old, double size, const Norm& norm, double forgotten) {
  const bool first_order = local_.order == 1, knows_third = !first_order && has_before_;
  if (knows_third && v_before_.size() != now.size())
    throw Error("The checkpoint's step errors are from another mesh. Use an earlier checkpoint.");
  std::vector<double> second(now.size()), third(knows_third ? now.size() : 0);
  for (std::size_t i = 0; i < second.size(); ++i) second[i] = (now[i] - before[i]) / dt;
  for (std::size_t i = 0; i < third.size(); ++i)
    third[i] = 2 * (second[i] - (before[i] - v_before_[i]) / dt_old) / (dt + dt_old);
  StepErrors::Inputs seen{
      .rate = norm(now), .size = size, .dt = dt, .order = local_.order, .forgotten = forgotten};
  const double by_two = norm(second);
  seen.below = first_order ? seen.rate : by_two;
  if (first_order || knows_third) {
    seen.highest = first_order ? by_two : norm(third);
    seen.error = std::abs(local_.constant) * std::pow(dt, local_.order + 1) * seen.highest;
    const bool is_second = !first_order && !judged_;
    if (is_second && begins_with_euler_)
      seen.error += 0.5 * (0.5 * dt * dt * by_two);  // of each of the two steps
    errors_.add(seen, is_second ? 2 : 1);
    judged_ = true;
  }
  v_before_.assign(before.begin(), before.end());
  has_before_ = true;
  return seen;
}

std::vector<double> VelocityErrors::numbers() const {
  base::Numbers numbers;
  const_cast<VelocityErrors*>(this)->visit_sums(numbers);  // writing changes nothing
  return numbers.values();
}

void VelocityErrors::restore(std::span<const double> numbers, std::vector<double> before) {
  *this = VelocityErrors(local_, begins_with_euler_);
  v_before_ = std::move(before);
  if (numbers.empty()) return;
  base::Numbers saved(numbers, "step errors");
  visit_sums(saved);
  saved.finish();
}

std::vector<double> VelocityErrors::state() const { return base::to_numbers(*this); }

void VelocityErrors::restore(std::span<const double> state) {
  *this = VelocityErrors(local_, begins_with_euler_);
  if (!state.empty()) base::from_numbers(state, *this, "step errors");
}

}  // namespace couplet::time
