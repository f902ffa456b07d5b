// SPDX-License-Identifier: Apache-2.0
#include "common/modes/negative_curvature.hpp"

#include <cmath>
#include <utility>

#include "common/parallel/collective.hpp"

namespace couplet::modes {

Curvature look_for_negative_curvature(MPI_Comm comm, const linalg::LinearMap& a,
                                      const linalg::LinearMap& precondition, std::span<const double> b,
                                      double tolerance, int most_iterations) {
  const std::size_t n = b.size();
  const auto dot = [&](const std::vector<double>& x, const std::vector<double>& y) {
    double local = 0;
    for (std::size_t i = 0; i < n; ++i) local += x[i] * y[i];
    return parallel::sum(comm, local);
  };
  Curvature result;
  result.x.assign(n, 0);
  std::vector<double> r(b.begin(), b.end()), z(n), p, q(n);
  const double wanted = tolerance * std::sqrt(dot(r, r));
  double along = 0;
  for (; result.iterations < most_iterations; ++result.iterations) {
    precondition(r, z);
    const double next = dot(r, z);
    if (p.empty())
      p = z;
    else
      for (std::size_t i = 0; i < n; ++i) p[i] = z[i] + next / along * p[i];
    along = next;
    a(p, q);
    const double curvature = dot(p, q);
    if (!(curvature > 0)) {
      result.is_negative = curvature < 0;
      if (result.is_negative) result.x = std::move(p);
      return result;
    }
    const double step = along / curvature;
    for (std::size_t i = 0; i < n; ++i) result.x[i] += step * p[i], r[i] -= step * q[i];
    if (std::sqrt(dot(r, r)) <= wanted) break;
  }
  return result;
}

}  // namespace couplet::modes
