// SPDX-License-Identifier: Apache-2.0
#include "thermocline/bed/grain_kernels.hpp"

#include <array>
#include <type_traits>

namespace couplet::thermocline {
namespace {

/// N shells, or as many as e.n for N = 0.
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

/// Calls f with the number of shells as a constant where that unrolls the loops over them; 0: as many as the grain says.
template <typename F>
[[gnu::always_inline]] inline void with_shells(int n, F&& f) {
  switch (n) {
    case 1:
      return f(std::integral_constant<int, 1>{});
    case 2:
      return f(std::integral_constant<int, 2>{});
    case 3:
      return f(std::integral_constant<int, 3>{});
    case 4:
      return f(std::integral_constant<int, 4>{});
    case 5:
      return f(std::integral_constant<int, 5>{});
    case 6:
      return f(std::integral_constant<int, 6>{});
    case 8:
      return f(std::integral_constant<int, 8>{});
    default:
      return f(std::integral_constant<int, 0>{});
  }
}

}  // namespace

[[gnu::target_clones("avx2", "default")]] void gather_grains(const GrainElimination& e, const GrainCells& c,
                                                             const double* shells, const double* extra,
                                                             double* fluid, double* sums) {
  with_shells(
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
  with_shells(
      e.n, [&](auto n) __attribute__((always_inline)) { scatter<n()>(e, c, shells, fluid, to, sums); });
}

}  // namespace couplet::thermocline
