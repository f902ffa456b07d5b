// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/diagnostics/phase_drift.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace couplet::solid {

void PhaseDrift::add(double dt, double speed, double size, double kinetic, double strain) {
  if (!std::isfinite(speed + size + kinetic + strain)) return;
  way_ += dt * speed;
  size_ = std::max(size_, size);
  kinetic_ += dt * kinetic;
  strain_ += dt * strain;
}

double PhaseDrift::over_size(double stiffness) const {
  if (!(size_ > 0) || !(strain_ > 0)) return 0;
  // |v| of a swing is 2/pi of its amplitude w A in the mean.
  const double angle = 0.5 * std::numbers::pi * way_ / size_;
  return std::min(2.0, 0.5 * stiffness * angle * std::min(1.0, kinetic_ / strain_));
}

void PhaseDrift::restore(std::span<const double> state) {
  way_ = state[0], size_ = state[1], kinetic_ = state[2], strain_ = state[3];
}

}  // namespace couplet::solid
