// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>

namespace couplet::mesh_mover {

/// The first place in (0, limit] where c0 + c1 a + c2 a^2 + c3 a^3 falls to zero, from below to a thousandth; limit:
/// nowhere. c0 > 0.
inline double first_root(const std::array<double, 4>& c, double limit) {
  const auto at = [&](double a) { return c[0] + a * (c[1] + a * (c[2] + a * c[3])); };
  const auto below = [](double x) { return x < 0 ? x : 0; };
  if (c[0] + limit * (below(c[1]) + limit * (below(c[2]) + limit * below(c[3]))) > 0) return limit;
  // Between its extrema it is monotone.
  std::array<double, 3> ends{limit, limit, limit};
  int n = 0;
  const double a = 3 * c[3], b = c[2], root = b * b - a * c[1];
  if (root >= 0) {
    const double q = -(b + (b > 0 ? std::sqrt(root) : -std::sqrt(root)));
    const double first = a != 0 ? q / a : -1, second = q != 0 ? c[1] / q : -1;
    for (const double x : {std::fmin(first, second), std::fmax(first, second)})
      if (x > 0 && x < limit) ends[n++] = x;
  }
  ends[n++] = limit;
  double low = 0;
  for (int i = 0; i < n; ++i) {
    if (at(ends[i]) > 0) {
      low = ends[i];
      continue;
    }
    double high = ends[i];
    while (high - low > 1e-3 * high) {
      const double middle = (low + high) / 2;
      (at(middle) > 0 ? low : high) = middle;
      if (high < 1e-12 * limit) break;
    }
    return low;
  }
  return limit;
}

}  // namespace couplet::mesh_mover
