// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace couplet::thermocline {

/// A property as a piecewise linear function of temperature, constant beyond its ends. `x` [K] grows.
struct Table {
  std::vector<double> x, y;

  Table() = default;
  Table(double constant) : x{0}, y{constant} {}
  Table(std::vector<double> xs, std::vector<double> ys) : x(std::move(xs)), y(std::move(ys)) {}

  double operator()(double at) const {
    if (at <= x.front()) return y.front();
    if (at >= x.back()) return y.back();
    const std::size_t i = std::upper_bound(x.begin(), x.end(), at) - x.begin();
    return y[i - 1] + (y[i] - y[i - 1]) * (at - x[i - 1]) / (x[i] - x[i - 1]);
  }
  /// Integral from x.front() to `at`, exact for the piecewise linear function.
  double integral(double at) const {
    if (at <= x.front()) return y.front() * (at - x.front());
    double sum = 0;
    for (std::size_t i = 1; i < x.size() && x[i - 1] < at; ++i) {
      const double end = std::min(at, x[i]);
      sum += 0.5 * (y[i - 1] + (*this)(end)) * (end - x[i - 1]);
    }
    return at > x.back() ? sum + y.back() * (at - x.back()) : sum;
  }
};

}  // namespace couplet::thermocline
