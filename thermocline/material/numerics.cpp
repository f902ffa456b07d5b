// SPDX-License-Identifier: Apache-2.0
#include "thermocline/material/numerics.hpp"

#include <algorithm>

namespace couplet::thermocline {
namespace {

[[gnu::target_clones("avx2", "default")]] void add_ramp(double at, double bend, const double* t,
                                                        double* value, std::size_t n) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) value[i] += bend * std::max(0.0, t[i] - at);
}

[[gnu::target_clones("avx2", "default")]] void add_mean(double at, double bend, const double* from,
                                                        const double* to, double* value, std::size_t n) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const double a = std::max(0.0, from[i] - at), b = std::max(0.0, to[i] - at), way = to[i] - from[i];
    // Mean if both are beyond the bend, otherwise half the difference of the squares over the distance.
    const bool both = (a > 0) == (b > 0);
    value[i] += bend * (both ? 0.5 * (a + b) : 0.5 * (b * b - a * a) / (way == 0 ? 1 : way));
  }
}

constexpr int chunk = 32;

struct Rows {
  int n;
  const double *a, *b, *c;
  double *low, *up, *inverse;
};

/// Computes the pivots d_i = b_i - a_i c_{i-1}/d_{i-1} as quotients of a continuant, to avoid a chain of
/// divisions. With rows divided by their diagonals, d_i/b_i = p_i/p_{i-1}, p_i = p_{i-1} - e_i p_{i-2}, e_i =
/// a_i c_{i-1}/(b_i b_{i-1}): one subtraction per row and independent divisions. p restarts with 1 every few
/// rows to stay in range.
[[gnu::target_clones("avx2", "default")]] void find_pivots(const Rows& r) {
  const int m = r.n / 2, last = r.n - 1, above = last - m;  // rows over the middle, m or m - 1 of them
  double *const e = r.low, *const diagonal = r.up, *const inverse = r.inverse;
#pragma GCC ivdep
  for (int i = 0; i < r.n; ++i) diagonal[i] = 1 / r.b[i];
  e[0] = 0;
#pragma GCC ivdep
  for (int i = 1; i < r.n; ++i) e[i] = r.a[i] * r.c[i - 1] * (diagonal[i] * diagonal[i - 1]);
  double from_low[chunk + 1], from_high[chunk + 1];
  double low_before = 0, high_before = 0;  // p_{i-2} where p_{i-1} = 1
  for (int first = 0; first < above; first += chunk) {
    const int count = std::min(chunk, above - first);
    double low = from_low[0] = 1, high = from_high[0] = 1;
    for (int k = 0; k < count; ++k) {  // side by side: neither waits for the other
      const int i = first + k, mirrored = last - i;
      const double next_low = low - e[i] * low_before;
      const double next_high = high - (mirrored < last ? e[mirrored + 1] : 0) * high_before;
      low_before = low, low = from_low[k + 1] = next_low;
      high_before = high, high = from_high[k + 1] = next_high;
    }
    low_before /= low, high_before /= high;
#pragma GCC ivdep
    for (int k = 0; k < count; ++k) inverse[first + k] = from_low[k] / from_low[k + 1] * diagonal[first + k];
#pragma GCC ivdep
    for (int k = 0; k < count; ++k)
      inverse[last - first - k] = from_high[k] / from_high[k + 1] * diagonal[last - first - k];
  }
}

/// Factors of the rows from their pivots.
[[gnu::target_clones("avx2", "default")]] void find_factors(const Rows& r) {
  const int m = r.n / 2, last = r.n - 1;
  r.low[0] = 0;
#pragma GCC ivdep
  for (int i = 1; i < m; ++i) r.low[i] = r.a[i] * r.inverse[i - 1];
#pragma GCC ivdep
  for (int i = 0; i < m; ++i) r.up[i] = r.c[i] * r.inverse[i];
#pragma GCC ivdep
  for (int i = m + 1; i <= last; ++i) r.low[i] = r.a[i] * r.inverse[i];
#pragma GCC ivdep
  for (int i = m + 1; i < last; ++i) r.up[i] = r.c[i] * r.inverse[i + 1];
  if (last > m) r.up[last] = 0;
}

}  // namespace

void Ramps::values(const double* t, double* value, std::size_t n) const {
  for (std::size_t i = 0; i < n; ++i) value[i] = first_;
  for (std::size_t s = 0; s < at_.size(); ++s) add_ramp(at_[s], bend_[s], t, value, n);
}

void Ramps::means(const double* from, const double* to, double* value, std::size_t n) const {
  for (std::size_t i = 0; i < n; ++i) value[i] = first_;
  for (std::size_t s = 0; s < at_.size(); ++s) add_mean(at_[s], bend_[s], from, to, value, n);
}

[[gnu::target_clones("avx2", "default")]] void conduction_rows(std::size_t n, const double* half_resistance,
                                                               double* lower, double* upper) {
#pragma GCC ivdep
  for (std::size_t i = 0; i + 1 < n; ++i) upper[i] = -1 / (half_resistance[i] + half_resistance[i + 1]);
  upper[n - 1] = lower[0] = 0;
  for (std::size_t i = 0; i + 1 < n; ++i) lower[i + 1] = upper[i];
}

void Tridiagonal::factorise(const double* a, const double* b, const double* c) {
  const int m = n_ / 2, last = n_ - 1;
  const Rows rows{n_, a, b, c, low_.data(), up_.data(), inverse_.data()};
  find_pivots(rows);
  if (last - m < m) inverse_[m - 1] = 1 / (b[m - 1] - (m > 1 ? a[m - 1] * inverse_[m - 2] * c[m - 2] : 0));
  find_factors(rows);
  low_[m] = m > 0 ? a[m] * inverse_[m - 1] : 0;
  up_[m] = m < last ? c[m] * inverse_[m + 1] : 0;
  inverse_[m] = 1 / (b[m] - (m > 0 ? low_[m] * c[m - 1] : 0) - (m < last ? up_[m] * a[m + 1] : 0));
}

}  // namespace couplet::thermocline
