// SPDX-License-Identifier: Apache-2.0
#include "thermocline/grain_kernels.hpp"

#include <array>

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

}  // namespace

[[gnu::target_clones("avx2", "default")]] void gather_grains(const GrainElimination& e, const GrainCells& c,
                                                             const double* shells, const double* extra,
                                                             double* fluid, double* sums) {
  switch (e.n) {
    case 1:
      return gather<1>(e, c, shells, extra, fluid, sums);
    case 2:
      return gather<2>(e, c, shells, extra, fluid, sums);
    case 3:
      return gather<3>(e, c, shells, extra, fluid, sums);
    case 4:
      return gather<4>(e, c, shells, extra, fluid, sums);
    case 5:
      return gather<5>(e, c, shells, extra, fluid, sums);
    case 6:
      return gather<6>(e, c, shells, extra, fluid, sums);
    case 8:
      return gather<8>(e, c, shells, extra, fluid, sums);
    default:
      return gather<0>(e, c, shells, extra, fluid, sums);
  }
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
  switch (e.n) {
    case 1:
      return scatter<1>(e, c, shells, fluid, to, sums);
    case 2:
      return scatter<2>(e, c, shells, fluid, to, sums);
    case 3:
      return scatter<3>(e, c, shells, fluid, to, sums);
    case 4:
      return scatter<4>(e, c, shells, fluid, to, sums);
    case 5:
      return scatter<5>(e, c, shells, fluid, to, sums);
    case 6:
      return scatter<6>(e, c, shells, fluid, to, sums);
    case 8:
      return scatter<8>(e, c, shells, fluid, to, sums);
    default:
      return scatter<0>(e, c, shells, fluid, to, sums);
  }
}

}  // namespace couplet::thermocline
