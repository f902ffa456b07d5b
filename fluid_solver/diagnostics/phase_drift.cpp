// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/diagnostics/phase_drift.hpp"

#include <algorithm>
#include <cmath>

namespace couplet::fluid {
namespace {

constexpr double recent = 0.25;             // recent means cover about this part of the elapsed time
constexpr double stands_out = 0.1;          // of the swing: what a maximum stands out by
constexpr double same_maxima = 0.05;        // of the swing and of the distance: maxima that are the same
constexpr double no_swing = 1e-9;           // of the value: no swing
constexpr std::size_t most_maxima = 3;      // maxima in a cycle
constexpr std::size_t compared_cycles = 3;  // that are compared

}  // namespace

void Repetition::add(double dt, double value) {
  if (!std::isfinite(value)) return;
  if (time_ == 0 && dt_ == 0) upper_ = lower_ = value, extreme_ = {0, value};
  time_ += dt, dt_ = std::max(dt, dt_);
  const double faded = std::min(1.0, dt / (recent * time_));
  upper_ = std::max(value, upper_ + faded * (value - upper_));
  lower_ = std::min(value, lower_ + faded * (value - lower_));
  const double beyond = rises_ ? value - extreme_.height : extreme_.height - value;
  if (beyond >= 0) {
    extreme_ = {time_, value};
  } else if (-beyond > stands_out * (upper_ - lower_)) {
    if (rises_) peaks_.push_back(extreme_);
    if (peaks_.size() > compared_cycles * most_maxima + 1) peaks_.pop_front();
    extreme_ = {time_, value}, rises_ = !rises_;
  }
}

bool Repetition::repeats_after(std::size_t peaks) const {
  const std::size_t n = peaks_.size(), used = compared_cycles * peaks + 1;
  if (n < used) return false;
  const double swing = upper_ - lower_,
               cycle = (peaks_[n - 1].time - peaks_[n - used].time) / compared_cycles;
  for (std::size_t k = n - used; k + peaks < n; ++k) {
    const Peak &now = peaks_[k], &next = peaks_[k + peaks];
    if (std::abs(next.height - now.height) > same_maxima * swing) return false;
    if (std::abs(next.time - now.time - cycle) > std::max(same_maxima * cycle, dt_)) return false;
  }
  return swing > no_swing * std::max(std::abs(upper_), std::abs(lower_));
}

bool Repetition::repeats() const {
  for (std::size_t peaks = 1; peaks <= most_maxima; ++peaks)
    if (repeats_after(peaks)) return true;
  return false;
}

void PhaseDrift::add(double dt, double energy, double rate, double change, double weight) {
  repetition_.add(dt, energy);
  time_ += dt;
  const double share = std::min(1.0, dt / (recent * time_));
  rate_ += share * (rate * rate - rate_), change_ += share * (change * change - change_);
  weighted_ += share * (weight * change * change - weighted_);
}

double PhaseDrift::error() const {
  if (!(rate_ > 0) || !(change_ > 0) || !repetition_.repeats()) return 0;
  const double lag = time_ * weighted_ / rate_;
  return std::min(lag * std::sqrt(rate_), 2 * rate_ / std::sqrt(change_));
}

}  // namespace couplet::fluid
