// SPDX-License-Identifier: Apache-2.0
#include "thermocline/bed/grains.hpp"

#include <cmath>

namespace couplet::thermocline {

Grains::Grains(const Filler& filler, double porosity, double diameter, int shells)
    : n(shells),
      capacity((1 - porosity) * filler.volumetric() / shells),
      area(6 * (1 - porosity) / diameter) {
  // In units of the radius: shell j lies between radii (1 - j/n)^(1/3) and (1 - (j+1)/n)^(1/3); its mean of
  // r^2 is (3/5)(r_out^5 - r_in^5)/(r_out^3 - r_in^3).
  const auto radius = [&](int j) { return std::cbrt(1 - double(j) / n); };
  const auto mean_square = [&](int j) {
    return 0.6 * (std::pow(radius(j), 5) - std::pow(radius(j + 1), 5)) * n;
  };
  // 8 pi k R r^3/(difference) a grain, 3 (1 - eps)/(4 pi R^3) grains a volume.
  const double radius_m = 0.5 * diameter;
  const double scale = 6 * (1 - porosity) * filler.conductivity / (radius_m * radius_m);
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
  // 1 - beta is carried along by itself: in tiny grains it is far below the rounding of beta.
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

}  // namespace couplet::thermocline
