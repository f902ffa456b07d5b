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
    const std::size_t i = x.size() == 2 ? 1 : std::upper_bound(x.begin(), x.end(), at) - x.begin();
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

/// A table for many temperatures at once: y_0 + sum of bend_s max(0, T - x_s), loops without branches over
/// the temperatures.
class Ramps {
 public:
  Ramps() = default;
  explicit Ramps(const Table& table) : first_(table.y.front()) {
    double slope = 0;
    for (std::size_t i = 0; i < table.x.size(); ++i) {
      const bool last = i + 1 == table.x.size();
      const double next = last ? 0 : (table.y[i + 1] - table.y[i]) / (table.x[i + 1] - table.x[i]);
      if (next != slope) at_.push_back(table.x[i]), bend_.push_back(next - slope);
      slope = next;
    }
  }
  /// Values at n temperatures.
  void values(const double* t, double* value, std::size_t n) const;
  /// Means over the way from one temperature to another; the value where they are (nearly) the same.
  void means(const double* from, const double* to, double* value, std::size_t n) const;

 private:
  double first_ = 0;
  std::vector<double> at_, bend_;
};

}  // namespace couplet::thermocline
