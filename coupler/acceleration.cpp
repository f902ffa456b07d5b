// SPDX-License-Identifier: Apache-2.0
#include "coupler/acceleration.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace couplet {

double aitken_factor(double omega, std::span<const double> residual, std::span<const double> next_residual) {
  assert(residual.size() == next_residual.size());
  double along = 0, square = 0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    const double change = next_residual[i] - residual[i];
    along += residual[i] * change;
    square += change * change;
  }
  return square > 0 ? -omega * along / square : omega;
}

void Acceleration::start_step() {
  last_residual_.clear();
  if (parameters_.type == AccelerationParameters::Type::constant) return;
  const double most = parameters_.maximum_relaxation;
  omega_ = std::clamp(std::abs(omega_), std::min(0.01, most), most);
}

double Acceleration::factor(std::span<const double> residual) {
  if (parameters_.type == AccelerationParameters::Type::constant) return omega_;
  if (!last_residual_.empty()) omega_ = aitken_factor(omega_, last_residual_, residual);
  last_residual_.assign(residual.begin(), residual.end());
  return omega_;
}

}  // namespace couplet
