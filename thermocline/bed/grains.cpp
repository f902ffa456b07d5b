// SPDX-License-Identifier: Apache-2.0
#include "thermocline/bed/grains.hpp"

#include <array>
#include <cmath>
#include <type_traits>

namespace couplet::thermocline {
namespace {

/// N shells, or e.n shells for N = 0.
template <int N>
[[gnu::always_inline]] inline void gather(const GrainElimination& e, const GrainCells& c,
                                          const double* shells, const double* extra, double* fluid,
                                          double* sums) {
  const int shells_in_grain = N > 0 ? N : e.n;
  constexpr int size = N > 0 ? N : most_shells;
  std::array<double, size> weight;
  for (int j = 0; j < shells_in_grain; ++j) weight[j] = e.weight[j];
#pragma GCC ivdep
  for (std::size_t i = c.first; i < c.last; ++i) {
    double sum = 0;
    for (int j = 0; j < shells_in_grain; ++j) sum += weight[j] * shells[j * c.n + i];
    sums[i] = sum;
    fluid[i] = c.rate[i] * fluid[i] + extra[i] + c.heat[i] * sum;
  }
}

template <int N>
[[gnu::always_inline]] inline void scatter(const GrainElimination& e, const GrainCells& c,
                                           const double* shells, const double* fluid, double* to,
                                           double* sums) {
  const int shells_in_grain = N > 0 ? N : e.n;
  constexpr int size = N > 0 ? N : most_shells;
  std::array<double, size> weight, keep, pass, beta;
  for (int j = 0; j < shells_in_grain; ++j)
    weight[j] = e.weight[j], keep[j] = e.keep[j], pass[j] = e.pass[j], beta[j] = e.beta[j];
#pragma GCC ivdep
  for (std::size_t i = c.first; i < c.last; ++i) {
    std::array<double, size> theta;
    double inside = 0;
    for (int j = shells_in_grain - 1; j >= 1; --j)
      theta[j] = inside = keep[j] * shells[j * c.n + i] + pass[j] * inside;
    double outside = c.share[i] * sums[i] + c.beta[i] * fluid[i];
    double sum = 0;
    sum += weight[0] * outside;
    to[i] = outside;
    for (int j = 1; j < shells_in_grain; ++j) {
      to[j * c.n + i] = outside = theta[j] + beta[j] * outside;
      sum += weight[j] * outside;
    }
    sums[i] = sum;
  }
}

/// Calls f with the number of shells as a compile-time constant if it is one of N, which unrolls the loops;
/// otherwise with 0.
template <int... N, typename F>
[[gnu::always_inline]] inline void with_shells(int n, F&& f) {
  const bool known = ((n == N && (f(std::integral_constant<int, N>{}), true)) || ...);
  if (!known) f(std::integral_constant<int, 0>{});
}

}  // namespace

Grains::Grains(const Filler& filler, double porosity, double diameter, int shells)
    : n(shells),
      capacity((1 - porosity) * filler.volumetric() / shells),
      area(6 * (1 - porosity) / diameter) {
  // In units of the radius, shell j is between (1 - j/n)^(1/3) and (1 - (j+1)/n)^(1/3); its mean of r^2 is
  // (3/5)(r_out^5 - r_in^5)/(r_out^3 - r_in^3).
  const auto radius = [&](int j) { return std::cbrt(1 - double(j) / n); };
  const auto mean_square = [&](int j) {
    return 0.6 * (std::pow(radius(j), 5) - std::pow(radius(j + 1), 5)) * n;
  };
  // 8 pi k R r^3/(difference) per grain, 3 (1 - eps)/(4 pi R^3) grains per volume.
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
  with_shells<1, 2, 3, 4, 5, 6, 8>(
      e.n, [&](auto n) __attribute__((always_inline)) { gather<n()>(e, c, shells, extra, fluid, sums); });
}

[[gnu::target_clones("avx2", "default")]] void gather_sums(const GrainCells& c, const double* extra,
                                                           double* fluid, const double* sums) {
#pragma GCC ivdep
  for (std::size_t i = c.first; i < c.last; ++i)
    fluid[i] = c.rate[i] * fluid[i] + extra[i] + c.heat[i] * sums[i];
}

[[gnu::target_clones("avx2", "default")]] void scatter_grains(const GrainElimination& e, const GrainCells& c,
                                                              const double* shells, const double* fluid,
                                                              double* to, double* sums) {
  with_shells<1, 2, 3, 4, 5, 6, 8>(
      e.n, [&](auto n) __attribute__((always_inline)) { scatter<n()>(e, c, shells, fluid, to, sums); });
}

[[gnu::target_clones("avx2", "default")]] void exchange_rows(const Grains& grains, double own, double tau,
                                                             std::size_t n, const double* capacity,
                                                             const double* film, const double* dz,
                                                             const ExchangeRows& rows) {
  const double area = grains.area, inner = 1 / grains.surface;
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    // Film and outer half shell in series; none without a film.
    const double h = film[i], g = h > 0 ? 1 / (1 / (h * area) + inner) : 0;
    const double share = 1 / (own + g), beta = g * share, heat = beta * dz[i], rate = capacity[i] / tau;
    rows.rate[i] = rate, rows.share[i] = share, rows.beta[i] = beta, rows.heat[i] = heat;
    rows.diagonal[i] = rate + own * heat;  // g (1 - beta), in a form that does not cancel for large g
  }
}

}  // namespace couplet::thermocline
