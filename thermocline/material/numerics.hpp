// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace couplet::thermocline {

inline constexpr double zero_celsius = 273.15;  // [K]
constexpr double celsius(double kelvin) { return kelvin - zero_celsius; }
constexpr double kelvin(double celsius) { return celsius + zero_celsius; }

inline constexpr double seconds_an_hour = 3600, seconds_a_day = 86400;  // [s]
/// Times less than this before a full hour count as that hour [h].
inline constexpr double clock_rounding = 1e-9;

/// Property as a piecewise linear function of temperature, constant beyond its ends. `x` [K] is ascending.
struct Curve {
  std::vector<double> x, y;

  Curve() = default;
  Curve(double constant) : x{0}, y{constant} {}
  Curve(std::vector<double> xs, std::vector<double> ys) : x(std::move(xs)), y(std::move(ys)) {}

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

/// Table for many temperatures at once: y_0 + sum of bend_s max(0, T - x_s), with branch-free loops over
/// temperatures.
class Ramps {
 public:
  Ramps() = default;
  explicit Ramps(const Curve& table) : first_(table.y.front()) {
    double slope = 0;
    for (std::size_t i = 0; i < table.x.size(); ++i) {
      const bool last = i + 1 == table.x.size();
      const double next = last ? 0 : (table.y[i + 1] - table.y[i]) / (table.x[i + 1] - table.x[i]);
      if (next != slope) at_.push_back(table.x[i]), bend_.push_back(next - slope);
      slope = next;
    }
  }
  double operator()(double t) const {
    double value = 0;
    values(&t, &value, 1);
    return value;
  }
  /// Values at n temperatures.
  void values(const double* t, double* value, std::size_t n) const;
  /// Means between two temperatures; the value where they are (nearly) equal.
  void means(const double* from, const double* to, double* value, std::size_t n) const;

 private:
  double first_ = 0;
  std::vector<double> at_, bend_;
};

/// Solves a_i x_{i-1} + b_i x_i + c_i x_{i+1} = r_i by elimination from both ends. The two recurrences are
/// independent, so a processor overlaps them, which halves the latency. Factorized once for many right-hand
/// sides. Stable without pivoting for the diagonally dominant matrices of conduction.
class Tridiagonal {
 public:
  void resize(int n) {
    n_ = n;
    low_.assign(n, 0.0), up_.assign(n, 0.0), inverse_.assign(n, 0.0);
  }
  /// Spans of n values; a[0] and c[n-1] are not used.
  void factorise(const double* a, const double* b, const double* c);
  /// In place: right-hand side on entry, solution on exit.
  void solve(double* x) const;

 private:
  int n_ = 0;
  // Below the middle: low = a_i/d_{i-1}, up = c_i/d_i; mirrored above it.
  std::vector<double> low_, up_, inverse_;
};

inline void Tridiagonal::solve(double* x) const {
  const int m = n_ / 2, last = n_ - 1, above = last - m;  // `above` rows over the middle, m or m - 1 of them
  // The last values of both chains stay in registers. Otherwise the compiler would wait for a possible
  // overlap of one chain's store with the other's load.
  double low = x[0], high = x[last];
  for (int j = 1; j < above; ++j) {
    x[j] = low = x[j] - low_[j] * low;
    x[last - j] = high = x[last - j] - up_[last - j] * high;
  }
  for (int j = above > 1 ? above : 1; j < m; ++j) x[j] = low = x[j] - low_[j] * low;
  double middle = x[m];
  if (m > 0) middle -= low_[m] * low;
  if (m < last) middle -= up_[m] * high;
  x[m] = low = high = middle * inverse_[m];
  for (int j = 1; j <= above; ++j) {
    x[m + j] = high = x[m + j] * inverse_[m + j] - low_[m + j] * high;
    x[m - j] = low = x[m - j] * inverse_[m - j] - up_[m - j] * low;
  }
  for (int j = above + 1; j <= m; ++j) x[m - j] = low = x[m - j] * inverse_[m - j] - up_[m - j] * low;
}

/// Rows for conduction between n cells in a row: lower and upper entries are -1 over the sum of the two
/// half-cell resistances at each face. The diagonal is the storage term minus both.
void conduction_rows(std::size_t n, const double* half_resistance, double* lower, double* upper);

/// Visits lists whose lengths follow from grid and elements, for checkpoints.
template <class Numbers, class... Lists>
void visit_values(Numbers& numbers, Lists&... lists) {
  const auto all = [&](auto& list) {
    for (auto& value : list) numbers(value);
  };
  (all(lists), ...);
}

}  // namespace couplet::thermocline
