// SPDX-License-Identifier: Apache-2.0
#include "thermocline/wall/wall_bending.hpp"

#include <algorithm>
#include <cmath>

namespace couplet::thermocline {
namespace {

/// Symmetric, positive definite, two diagonals on each side: L D L^T without pivots.
struct Pentadiagonal {
  std::vector<double> diagonal, next, second;  // a_ii, a_i,i+1, a_i,i+2
  explicit Pentadiagonal(std::size_t n) : diagonal(n, 0.0), next(n, 0.0), second(n, 0.0) {}

  void solve(std::vector<double>& x) {
    const std::size_t n = diagonal.size();
    for (std::size_t i = 0; i < n; ++i) {
      const double d = diagonal[i], b = next[i] / d, c = second[i] / d;
      if (i + 1 < n) diagonal[i + 1] -= b * next[i], next[i + 1] -= b * second[i], x[i + 1] -= b * x[i];
      if (i + 2 < n) diagonal[i + 2] -= c * second[i], x[i + 2] -= c * x[i];
      next[i] = b, second[i] = c;
    }
    for (std::size_t i = n; i-- > 0;) {
      x[i] /= diagonal[i];
      if (i + 1 < n) x[i] -= next[i] * x[i + 1];
      if (i + 2 < n) x[i] -= second[i] * x[i + 2];
    }
  }
};

}  // namespace

WallBending wall_bending(const Rings& rings, const Steel& steel, std::span<const double> hoop,
                         std::span<const double> temperature) {
  const std::size_t n = rings.z.size();
  const double a = rings.diameter / 2, nu = steel.poissons_ratio;
  std::vector<double> modulus(n), free(n), w(n), support(n), stiffness(n);
  Pentadiagonal matrix(n);
  const double start = steel.thermal_strain(temperature[0]);
  for (std::size_t i = 0; i < n; ++i) {
    const double e = rings.thickness[i];
    modulus[i] = steel.youngs_modulus(temperature[i]);
    free[i] = steel.thermal_strain(temperature[i]) - start;
    support[i] = modulus[i] * e / (a * a) * rings.dz[i];
    stiffness[i] = modulus[i] * e * e * e / (12 * (1 - nu * nu));
    matrix.diagonal[i] = support[i];
    w[i] = support[i] * a * (hoop[i] / modulus[i] + free[i]);
  }
  // The least of 1/2 sum D (w'')^2 dz + 1/2 sum E e/a^2 (w - w_m)^2 dz; w'' at inner rings by three values.
  struct Curvature {
    double before, here, after;
  };
  std::vector<Curvature> curvature(n, {0, 0, 0});
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double below = rings.z[i] - rings.z[i - 1], above = rings.z[i + 1] - rings.z[i],
                 both = below + above;
    const Curvature c{2 / (below * both), -2 / (below * above), 2 / (above * both)};
    const double s = stiffness[i] * 0.5 * both;
    curvature[i] = c;
    matrix.diagonal[i - 1] += s * c.before * c.before, matrix.diagonal[i] += s * c.here * c.here;
    matrix.diagonal[i + 1] += s * c.after * c.after;
    matrix.next[i - 1] += s * c.before * c.here, matrix.next[i] += s * c.here * c.after;
    matrix.second[i - 1] += s * c.before * c.after;
  }
  matrix.solve(w);
  WallBending result{std::vector<double>(n), std::vector<double>(n, 0.0)};
  for (std::size_t i = 0; i < n; ++i) {
    result.hoop[i] = modulus[i] * (w[i] / a - free[i]);
    if (i == 0 || i + 1 == n) continue;
    const Curvature& c = curvature[i];
    const double bent = c.before * w[i - 1] + c.here * w[i] + c.after * w[i + 1];
    // Outwards curved (w'' > 0) the outer face is pressed.
    result.axial[i] = -6 * stiffness[i] * bent / (rings.thickness[i] * rings.thickness[i]);
  }
  return result;
}

YieldShares yield_shares(const WallStress& stress, const WallBending& bent, double poissons_ratio) {
  YieldShares shares;
  for (std::size_t i = 0; i < stress.hoop.size(); ++i) {
    shares.rings = std::max(shares.rings, stress.equivalent[i] / stress.yield[i]);
    for (const double face : {-1.0, 1.0}) {
      const double added = face * bent.axial[i], r = stress.radial[i];
      const double t = bent.hoop[i] + poissons_ratio * added, z = stress.axial[i] + added;
      const double equivalent = std::sqrt(0.5 * ((t - z) * (t - z) + (z - r) * (z - r) + (r - t) * (r - t)));
      shares.shell = std::max(shares.shell, equivalent / stress.yield[i]);
    }
  }
  return shares;
}

}  // namespace couplet::thermocline
