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
  double below = 0, above = 0;                  // off-diagonals over the pivots of the rows before
  for (int i = 0, j = last; i < m; ++i, --j) {  // side by side: neither chain waits for the other
    low_[i] = i > 0 ? a[i] * inverse_[i - 1] : 0;
    inverse_[i] = 1 / (b[i] - a[i] * below);
    up_[i] = below = c[i] * inverse_[i];
    if (j == m) break;
    up_[j] = j < last ? c[j] * inverse_[j + 1] : 0;
    inverse_[j] = 1 / (b[j] - c[j] * above);
    low_[j] = above = a[j] * inverse_[j];
  }
  low_[m] = m > 0 ? a[m] * inverse_[m - 1] : 0;
  up_[m] = m < last ? c[m] * inverse_[m + 1] : 0;
  inverse_[m] = 1 / (b[m] - a[m] * below - c[m] * above);
}

}  // namespace couplet::thermocline
