// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/error_estimate.hpp"

#include <cmath>

namespace couplet::plate {

void StepErrorEstimate::accepted(const ModalState& before, const ModalState& after) {
  const LocalError local = local_error(scheme_);
  const double dt = after.dt, dt_old = before.dt;
  const bool knows_third = !v_before_.empty();
  double second = 0, third = 0, rate = 0, size = 0;
  for (std::size_t m = 0; m < after.q.size(); ++m) {
    const double change = (after.v[m] - before.v[m]) / dt;
    second += change * change;
    rate += after.v[m] * after.v[m];
    size += after.q[m] * after.q[m];
    if (!knows_third) continue;
    const double bend = 2 * (change - (before.v[m] - v_before_[m]) / dt_old) / (dt + dt_old);
    third += bend * bend;
  }
  const double below = local.order == 1 ? rate : second,
               highest = std::sqrt(local.order == 1 ? second : third);
  if (local.order == 1 || knows_third)
    errors_.add({.error = std::abs(local.constant) * std::pow(dt, local.order + 1) * highest,
                 .rate = std::sqrt(rate),
                 .size = std::sqrt(size),
                 .dt = dt,
                 .order = local.order,
                 .below = std::sqrt(below),
                 .highest = highest},
                local.order == 1 || seen_ ? 1 : 2);
  seen_ = seen_ || knows_third;
  v_before_ = before.v;
}

std::vector<double> StepErrorEstimate::state() const {
  std::vector<double> values{seen_ ? 1. : 0., double(v_before_.size())};
  const std::vector<double> sums = errors_.state();
  for (const auto* part : {&v_before_, &sums}) values.insert(values.end(), part->begin(), part->end());
  return values;
}

void StepErrorEstimate::restore(std::span<const double> state) {
  v_before_.clear();
  errors_ = {};
  seen_ = false;
  if (state.empty()) return;
  seen_ = state[0] != 0;
  const auto n = std::size_t(state[1]);
  v_before_.assign(state.begin() + 2, state.begin() + 2 + std::ptrdiff_t(n));
  errors_.restore(state.subspan(2 + n));
}

}  // namespace couplet::plate
