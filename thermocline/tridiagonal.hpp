// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace couplet::thermocline {

/// a_i x_{i-1} + b_i x_i + c_i x_{i+1} = r_i by elimination from both ends at once: the two recurrences are
/// independent, so a processor works on them side by side, which halves the wait on their chains. Factorised
/// once for many right-hand sides. Stable without pivoting for the diagonally dominant matrices of
/// conduction.
class Tridiagonal {
 public:
  void resize(int n) {
    n_ = n;
    low_.assign(n, 0.0), up_.assign(n, 0.0), inverse_.assign(n, 0.0);
  }
  /// Spans of n values; a[0] and c[n-1] are not used.
  void factorise(const double* a, const double* b, const double* c);
  /// In place: right-hand side in, solution out.
  void solve(double* x) const;

 private:
  int n_ = 0;
  // Below the middle: low = a_i/d_{i-1}, up = c_i/d_i; above it mirrored.
  std::vector<double> low_, up_, inverse_;
};

inline void Tridiagonal::factorise(const double* a, const double* b, const double* c) {
  const int m = n_ / 2, last = n_ - 1, above = last - m;  // `above` rows over the middle, m or m - 1 of them
  double below_it = 0, above_it = 0;                      // 1/d of the rows before, from the two ends
  const auto up_row = [&](int i) {
    low_[i] = i > 0 ? a[i] * below_it : 0;
    below_it = inverse_[i] = 1 / (b[i] - (i > 0 ? low_[i] * c[i - 1] : 0));
    up_[i] = c[i] * below_it;
  };
  const auto down_row = [&](int i) {
    up_[i] = i < last ? c[i] * above_it : 0;
    above_it = inverse_[i] = 1 / (b[i] - (i < last ? up_[i] * a[i + 1] : 0));
    low_[i] = a[i] * above_it;
  };
  for (int j = 0; j < above; ++j) up_row(j), down_row(last - j);  // side by side: neither waits for the other
  if (above < m) up_row(m - 1);
  low_[m] = m > 0 ? a[m] * inverse_[m - 1] : 0;
  up_[m] = m < last ? c[m] * inverse_[m + 1] : 0;
  inverse_[m] = 1 / (b[m] - (m > 0 ? low_[m] * c[m - 1] : 0) - (m < last ? up_[m] * a[m + 1] : 0));
}

inline void Tridiagonal::solve(double* x) const {
  const int m = n_ / 2, last = n_ - 1, above = last - m;  // `above` rows over the middle, m or m - 1 of them
  for (int j = 1; j < above; ++j) {
    x[j] -= low_[j] * x[j - 1];
    x[last - j] -= up_[last - j] * x[last - j + 1];
  }
  for (int j = above > 1 ? above : 1; j < m; ++j) x[j] -= low_[j] * x[j - 1];
  double middle = x[m];
  if (m > 0) middle -= low_[m] * x[m - 1];
  if (m < last) middle -= up_[m] * x[m + 1];
  x[m] = middle * inverse_[m];
  for (int j = 1; j <= above; ++j) {
    x[m + j] = x[m + j] * inverse_[m + j] - low_[m + j] * x[m + j - 1];
    x[m - j] = x[m - j] * inverse_[m - j] - up_[m - j] * x[m - j + 1];
  }
  for (int j = above + 1; j <= m; ++j) x[m - j] = x[m - j] * inverse_[m - j] - up_[m - j] * x[m - j + 1];
}

}  // namespace couplet::thermocline
