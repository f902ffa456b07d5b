// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/diagnostics/compliance.hpp"

#include <algorithm>
#include <cmath>

namespace couplet::fluid {
namespace {

// What fewer steps show is the start of a motion; what is less of the mean square is rounding.
constexpr int judged_steps = 10;
constexpr double rounding = 1e-9;

}  // namespace

// The step in which the flow starts has the impulse of the start in its pressure, which says nothing about what follows.
void ComplianceWatch::add(double dt, const std::vector<double>& swept, const Totals& now) {
  sum_.resize(swept.size());
  square_.resize(swept.size());
  rate_.resize(swept.size());
  if (steps_++ > 0) {
    for (std::size_t i = 0; i < swept.size(); ++i) {
      const double change = swept[i] - last_[i];
      sum_[i] += dt * swept[i];
      square_[i] += dt * swept[i] * swept[i];
      rate_[i] += change * change / dt;
    }
    mean_.swept += dt * now.swept;
    mean_.pressure_volume += dt * now.pressure_volume;
    mean_square_.swept += dt * now.swept * now.swept;
    mean_square_.pressure_volume += dt * now.pressure_volume * now.pressure_volume;
    time_ += dt;
  }
  last_ = swept;
}

ComplianceWatch::Walls ComplianceWatch::walls() const {
  Walls w;
  if (steps_ < judged_steps) return w;
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    const double mean = sum_[i] / time_, square = square_[i] / time_, variance = square - mean * mean;
    if (variance <= rounding * square) continue;
    w.square += variance;
    w.size += std::sqrt(variance);
  }
  for (const double rate : rate_) w.rate += rate / time_;
  return w;
}

ComplianceWatch::Totals ComplianceWatch::totals() const {
  if (!(time_ > 0)) return {};
  const auto deviation = [&](double sum, double square) {
    return std::sqrt(std::max(0.0, square / time_ - sum * sum / (time_ * time_)));
  };
  return {deviation(mean_.swept, mean_square_.swept),
          deviation(mean_.pressure_volume, mean_square_.pressure_volume)};
}

}  // namespace couplet::fluid
