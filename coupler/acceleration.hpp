// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "coupler/parameters.hpp"

namespace couplet {

/// Aitken's factor for x^{k+2} = x^{k+1} + omega^{k+1} r^{k+1}, thesis (4.23) with its erratum:
///   omega^{k+1} = -omega^k r^k . (r^{k+1} - r^k) / |r^{k+1} - r^k|^2,  r = H(x) - x.
/// The old factor is kept if the residual did not change at all.
double aitken_factor(double omega, std::span<const double> residual, std::span<const double> next_residual);

/// The relaxation over the iterations and steps of a run.
class Acceleration {
 public:
  explicit Acceleration(const AccelerationParameters& parameters)
      : parameters_(parameters), omega_(parameters.initial_relaxation) {}
  /// A step starts with the size of the last factor of the step before, between a hundredth and the maximum:
  /// the sign and the far ends of Aitken's factor are accidents of the last, already small residuals.
  void start_step();
  /// The factor of the next update x += omega r.
  double factor(std::span<const double> residual);

  double omega() const { return omega_; }
  void restore(double omega) { omega_ = omega; }

 private:
  AccelerationParameters parameters_;
  double omega_;
  std::vector<double> last_residual_;  // empty at the start of a step
};

}  // namespace couplet
