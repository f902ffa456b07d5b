// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/judge/phase_drift.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/saved_numbers.hpp"

namespace couplet::fluid {
namespace {

constexpr double recent = 0.25;                // "of late" is about this part of the time that has gone by
constexpr double stands_out = 0.1;             // of the swing: what a maximum stands out by
constexpr double same_maxima = 0.05;           // of the swing and of the distance: maxima that are the same
constexpr double no_swing = 1e-9;              // of the value: no swing
constexpr std::size_t most_maxima = 3;         // maxima in a cycle
constexpr std::size_t compared_cycles = 3;     // that are compared
constexpr std::size_t drift_numbers = 4;       // of PhaseDrift itself
constexpr std::size_t repetition_numbers = 8;  // of Repetition, before its maxima

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

std::vector<double> Repetition::state() const {
  std::vector<double> values{extreme_.time, extreme_.height, rises_ ? 1. : 0., time_,
                             dt_,           upper_,          lower_,           double(peaks_.size())};
  for (const Peak& p : peaks_) values.insert(values.end(), {p.time, p.height});
  return values;
}

void Repetition::restore(std::span<const double> state) {
  *this = {};
  base::SavedNumbers saved(state, "maxima of the flow's energy");
  const std::span<const double> head = saved.next(repetition_numbers - 1);
  extreme_ = {head[0], head[1]}, rises_ = head[2] != 0, time_ = head[3], dt_ = head[4], upper_ = head[5],
  lower_ = head[6];
  for (std::size_t n = saved.count_of(2); n > 0; --n) {
    const double time = saved.real();
    peaks_.push_back({time, saved.real()});
  }
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

std::vector<double> PhaseDrift::state() const {
  std::vector<double> values{time_, rate_, change_, weighted_};
  const std::vector<double> maxima = repetition_.state();
  values.insert(values.end(), maxima.begin(), maxima.end());
  return values;
}

void PhaseDrift::restore(std::span<const double> state) {
  *this = {};
  if (state.empty()) return;  // of a run that did not collect them
  base::SavedNumbers saved(state, "drift of the flow's phase");
  const std::span<const double> own = saved.next(drift_numbers);
  time_ = own[0], rate_ = own[1], change_ = own[2], weighted_ = own[3];
  repetition_.restore(saved.rest());
}

}  // namespace couplet::fluid
