// SPDX-License-Identifier: Apache-2.0
#include "thermocline/bed/grains.hpp"

#include <cmath>

namespace couplet::thermocline {
Grains::Grains(const Filler& filler, double porosity, double diameter, int shells, double kelvin)
    : n(shells),
      capacity((1 - porosity) * filler.volumetric(kelvin) / shells),
      area(6 * (1 - porosity) / diameter) {
  // In units of the radius, shell j is between (1 - j/n)^(1/3) and (1 - (j+1)/n)^(1/3); its mean of r^2 is
  // (3/5)(r_out^5 - r_in^5)/(r_out^3 - r_in^3).
  const auto radius = [&](int j) { return std::cbrt(1 - double(j) / n); };
  const auto mean_square = [&](int j) {
    return 0.6 * (std::pow(radius(j), 5) - std::pow(radius(j + 1), 5)) * n;
  };
  // 8 pi k R r^3/(difference) per grain, 3 (1 - eps)/(4 pi R^3) grains per volume.
  const double radius_m = 0.5 * diameter;
  const double scale = 6 * (1 - porosity) * value_of(filler.conductivity, kelvin) / (radius_m * radius_m);
  surface = scale / (1 - mean_square(0));
  for (int j = 0; j + 1 < n; ++j)
    between.push_back(scale * (1 - double(j + 1) / n) / (mean_square(j) - mean_square(j + 1)));
}

GrainElimination::GrainElimination(const Grains& grains, double tau)
    : n(grains.n), keep(n, 0.0), pass(n, 0.0), beta(n, 0.0), weight(n, 0.0) {
  const double store = grains.capacity / tau;
  own = store;
  if (grains.capacity <= 0) {  // no filler: the shells are a name for the fluid
    beta.assign(n, 1.0);
    return;
  }
  // Row j: (store + a_{j-1} + a_j) theta_j - a_{j-1} theta_{j-1} - a_j theta_{j+1} = store theta_j^n.
  // 1 - beta is computed separately, because in tiny grains it is far below the round-off of beta.
  double rest_inside = 1;  // 1 - beta of the shell further in
  for (int j = n - 1; j >= 1; --j) {
    const double outward = grains.between[j - 1], inward = j + 1 < n ? grains.between[j] : 0;
    const double held = store + inward * rest_inside, diagonal = held + outward;
    keep[j] = store / diagonal;
    pass[j] = inward / diagonal;
    beta[j] = outward / diagonal;
    rest_inside = held / diagonal;
  }
  weight[0] = store;
  if (n == 1) return;
  own = store + grains.between[0] * rest_inside;
  double through = grains.between[0];
  for (int j = 1; j < n; ++j) {
    weight[j] = through * keep[j];
    through *= pass[j];
  }
}

[[gnu::target_clones("avx2", "default")]] void gather_grains(const GrainElimination& e, const GrainCells& c,
                                                             const double* shells, const double* extra,
                                                             double* fluid, double* sums) {
  for (std::size_t i = c.first; i < c.last; ++i) sums[i] = e.weight[0] * shells[i];
  for (int j = 1; j < e.n; ++j) {
    const double *shell = shells + j * c.n, weight = e.weight[j];
#pragma GCC ivdep
    for (std::size_t i = c.first; i < c.last; ++i) sums[i] += weight * shell[i];
  }
#pragma GCC ivdep
  for (std::size_t i = c.first; i < c.last; ++i)
    fluid[i] = c.rate[i] * fluid[i] + extra[i] + c.heat[i] * sums[i];
}

[[gnu::target_clones("avx2", "default")]] void scatter_grains(const GrainElimination& e, const GrainCells& c,
                                                              const double* shells, const double* fluid,
                                                              double* to, const double* sums) {
  // From the inside, `to` becomes alpha_j of each shell; from the surface, its temperature.
  for (int j = e.n - 1; j >= 1; --j) {
    const double *shell = shells + j * c.n, keep = e.keep[j], pass = e.pass[j];
    double* own = to + j * c.n;
    const double* inside = j + 1 < e.n ? own + c.n : shell;  // pass is 0 in the innermost shell
#pragma GCC ivdep
    for (std::size_t i = c.first; i < c.last; ++i) own[i] = keep * shell[i] + pass * inside[i];
  }
#pragma GCC ivdep
  for (std::size_t i = c.first; i < c.last; ++i) to[i] = c.share[i] * sums[i] + c.beta[i] * fluid[i];
  for (int j = 1; j < e.n; ++j) {
    const double *outside = to + (j - 1) * c.n, beta = e.beta[j];
    double* own = to + j * c.n;
#pragma GCC ivdep
    for (std::size_t i = c.first; i < c.last; ++i) own[i] += beta * outside[i];
  }
}

}  // namespace couplet::thermocline
