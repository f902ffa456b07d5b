// SPDX-License-Identifier: Apache-2.0
#include "thermocline/bed/bed_rows.hpp"

namespace couplet::thermocline {

[[gnu::target_clones("avx2", "default")]] void exchange_rows(const ExchangeLayer& layer,
                                                             const ExchangeInput& in,
                                                             const ExchangeRows& rows) {
  const double tau = layer.tau, own = layer.own, area = layer.area, inner = 1 / layer.surface;
#pragma GCC ivdep
  for (std::size_t i = 0; i < in.n; ++i) {
    // Film and outer half shell in series; none without a film.
    const double h = in.film[i], g = h > 0 ? 1 / (1 / (h * area) + inner) : 0;
    const double share = 1 / (own + g), beta = g * share, heat = beta * in.dz[i], rate = in.capacity[i] / tau;
    rows.rate[i] = rate, rows.share[i] = share, rows.beta[i] = beta, rows.heat[i] = heat;
    rows.diagonal[i] = rate + own * heat;  // g (1 - beta), in a form that does not cancel for large g
  }
}

[[gnu::target_clones("avx2", "default")]] void conduction_rows(int n, const double* conductivity,
                                                               const double* dz, double* lower,
                                                               double* diagonal, double* upper) {
  // Resistance of two half cells; infinite in a bed that does not conduct.
#pragma GCC ivdep
  for (int i = 0; i + 1 < n; ++i)
    upper[i] = -1 / (dz[i] / (2 * conductivity[i]) + dz[i + 1] / (2 * conductivity[i + 1]));
  upper[n - 1] = lower[0] = 0;
  for (int i = 0; i + 1 < n; ++i) lower[i + 1] = upper[i];
  // Each diagonal takes the face below and then the one above.
  if (n > 1) diagonal[0] -= upper[0];
#pragma GCC ivdep
  for (int i = 1; i + 1 < n; ++i) diagonal[i] = diagonal[i] - lower[i] - upper[i];
  if (n > 1) diagonal[n - 1] -= lower[n - 1];
}

}  // namespace couplet::thermocline
