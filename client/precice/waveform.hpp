// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace couplet::dropin {

/// Interpolation in time within a window: the spline of a degree through values at given times, whose knots are averages
/// of these times (C. de Boor, A Practical Guide to Splines, 1978, ch. XIII). Polynomials up to the degree are
/// reproduced; degree 1 is the line from time to time, degree 0 the value at the next time.
class Waveform {
 public:
  /// `times`: two or more, ascending. A degree that they are too few for is lowered.
  Waveform(std::vector<double> times, int degree);

  /// Weights of the values at the times for the value at t within them; at one of the times 1 and zeros.
  std::vector<double> weights(double t) const;
  int degree() const { return degree_; }

 private:
  /// The first of the degree + 1 splines that differ from zero at t, and their values.
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
