// SPDX-License-Identifier: Apache-2.0
#include "common/time/velocity_errors.hpp"

#include <cmath>

#include "common/base/error.hpp"
#include "common/base/saved_numbers.hpp"

namespace couplet::time {

StepErrors::Seen VelocityErrors::add(std::span<const double> before, std::span<const double> now, double dt,
                                     double dt_old, double size, const Norm& norm, double forgotten) {
  const bool first_order = local_.order == 1, knows_third = !first_order && has_before_;
  if (knows_third && v_before_.size() != now.size())
    throw Error("The checkpoint's step errors are from another mesh. Use an earlier checkpoint.");
  std::vector<double> second(now.size()), third(knows_third ? now.size() : 0);
  for (std::size_t i = 0; i < second.size(); ++i) second[i] = (now[i] - before[i]) / dt;
  for (std::size_t i = 0; i < third.size(); ++i)
    third[i] = 2 * (second[i] - (before[i] - v_before_[i]) / dt_old) / (dt + dt_old);
  StepErrors::Seen seen{
      .rate = norm(now), .size = size, .dt = dt, .order = local_.order, .forgotten = forgotten};
  const double by_two = norm(second);
  seen.below = first_order ? seen.rate : by_two;
  if (first_order || knows_third) {
    seen.highest = first_order ? by_two : norm(third);
    seen.error = std::abs(local_.constant) * std::pow(dt, local_.order + 1) * seen.highest;
    errors_.add(seen, first_order || judged_ ? 1 : 2);
    judged_ = true;
  }
  v_before_.assign(before.begin(), before.end());
  has_before_ = true;
  return seen;
}

std::vector<double> VelocityErrors::numbers() const {
  std::vector<double> values{(judged_ ? 1. : 0.) + (has_before_ ? 2. : 0.)};
  const std::vector<double> sums = errors_.state();
  values.insert(values.end(), sums.begin(), sums.end());
  return values;
}

void VelocityErrors::restore(std::span<const double> numbers, std::vector<double> before) {
  v_before_ = std::move(before);
  errors_ = {};
  judged_ = has_before_ = false;
  if (numbers.empty()) return;
  base::SavedNumbers saved(numbers, "step errors");
  const double kind = saved.real();
  judged_ = kind == 1 || kind == 3;
  has_before_ = kind >= 2;
  errors_.restore(saved.rest());
}

std::vector<double> VelocityErrors::state() const {
  std::vector<double> values{double(v_before_.size())};
  const std::vector<double> all = numbers();
  for (const auto* part : {&v_before_, &all}) values.insert(values.end(), part->begin(), part->end());
  return values;
}

void VelocityErrors::restore(std::span<const double> state) {
  if (state.empty()) return restore({}, {});
  base::SavedNumbers saved(state, "step errors");
  const std::span<const double> v = saved.next(saved.count_of(1));
  restore(saved.rest(), {v.begin(), v.end()});
}

}  // namespace couplet::time
