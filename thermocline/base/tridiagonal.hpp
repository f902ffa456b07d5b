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

inline void Tridiagonal::solve(double* x) const {
  const int m = n_ / 2, last = n_ - 1, above = last - m;  // `above` rows over the middle, m or m - 1 of them
  // The last values of both chains stay in registers: the compiler cannot know that one's store is not the other's
  // next load, and would wait for it.
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

}  // namespace couplet::thermocline
