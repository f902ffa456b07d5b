// SPDX-License-Identifier: Apache-2.0
#include "thermocline/wall/stress_history.hpp"
#include "common/base/saved_numbers.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace couplet::thermocline {

void StressHistory::see(double time, std::span<const double> z, std::span<const double> equivalent,
                        std::span<const double> yield) {
  const std::size_t n = z.size();
  if (z_.size() != n) {
    z_.assign(z.begin(), z.end());
    for (auto* sums : {&sum_lowest_, &sum_highest_, &highest_, &highest_at_}) sums->assign(n, 0);
    day_begun_ = false;
  }
  if (!day_begun_) {
    day_lowest_.assign(n, std::numeric_limits<double>::infinity());
    day_highest_.assign(n, 0);
    day_highest_at_.assign(n, time);
    day_begun_ = true;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double share = equivalent[i] / yield[i];
    day_lowest_[i] = std::min(day_lowest_[i], share);
    if (share <= day_highest_[i]) continue;
    day_highest_[i] = share;
    day_highest_at_[i] = time;
  }
}

void StressHistory::end_day(bool counts) {
  const bool begun = day_begun_;
  day_begun_ = false;
  if (!counts || !begun) return;
  ++days_;
  for (std::size_t i = 0; i < z_.size(); ++i) {
    sum_lowest_[i] += day_lowest_[i];
    sum_highest_[i] += day_highest_[i];
    if (day_highest_[i] <= highest_[i]) continue;
    highest_[i] = day_highest_[i];
    highest_at_[i] = day_highest_at_[i];
  }
}

StressHistory::Factor StressHistory::static_factor() const {
  const auto i = std::size_t(std::max_element(highest_.begin(), highest_.end()) - highest_.begin());
  return {1 / highest_[i], z_[i], highest_at_[i]};
}

StressHistory::Factor StressHistory::dynamic_factor() const {
  Factor least{std::numeric_limits<double>::infinity(), 0, 0};
  for (std::size_t i = 0; i < z_.size(); ++i) {
    const double low = sum_lowest_[i] / days_, high = sum_highest_[i] / days_;
    const double factor = (1 - low) / (high - low);
    if (high > low && factor < least.value) least = {factor, z_[i], 0};
  }
  return least;
}

std::vector<double> StressHistory::mean(const std::vector<double>& sum) const {
  std::vector<double> result = sum;
  for (double& value : result) value /= days_;
  return result;
}

std::vector<double> StressHistory::state() const {
  std::vector<double> all{double(z_.size()), double(days_), double(day_begun_)};
  for (const auto* part : {&z_, &day_lowest_, &day_highest_, &day_highest_at_, &sum_lowest_, &sum_highest_,
                           &highest_, &highest_at_}) {
    all.insert(all.end(), part->begin(), part->end());
    all.resize(all.size() + z_.size() - part->size());  // the day's are empty before the first look
  }
  return all;
}

void StressHistory::restore(std::span<const double>& state) {
  base::SavedNumbers saved(state, "sums of stresses");
  const std::size_t n = saved.count(double(state.size()));
  days_ = static_cast<int>(saved.count(1e9));
  day_begun_ = saved.real() != 0;
  for (auto* part : {&z_, &day_lowest_, &day_highest_, &day_highest_at_, &sum_lowest_, &sum_highest_,
                     &highest_, &highest_at_}) {
    const std::span<const double> values = saved.next(n);
    part->assign(values.begin(), values.end());
  }
  state = saved.rest();
}

}  // namespace couplet::thermocline
