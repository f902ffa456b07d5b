// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace couplet::dropin {

/// Spline interpolation in time within a window. Knots are averages of the given times (C. de Boor, A
/// Practical Guide to Splines, 1978, ch. XIII). Polynomials up to the degree are reproduced. Degree 1 is
/// piecewise linear, degree 0 takes the value at the next time.
class Waveform {
 public:
  /// `times` has at least two ascending entries. The degree is lowered if they are too few.
  Waveform(std::vector<double> times, int degree);

  /// Weights of the values at the times for the value at t. At one of the times they are 1 and zeros.
  std::vector<double> weights(double t) const;
  int degree() const { return degree_; }

 private:
  /// Values of the degree + 1 splines that are nonzero at t. Returns the first one's index.
  std::size_t splines(double t, std::vector<double>& values) const;
  void factor();
  double& entry(std::size_t row, std::size_t column) {
    return band_[row * (2 * std::size_t(degree_) + 1) + column + std::size_t(degree_) - row];
  }
  double entry(std::size_t row, std::size_t column) const {
    return const_cast<Waveform*>(this)->entry(row, column);
  }

  std::vector<double> times_, knots_;
  int degree_;
  std::vector<double> band_;  // splines (columns) at the times (rows), then its factors L and U
};

}  // namespace couplet::dropin
