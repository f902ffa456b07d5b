// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "thermocline/grains.hpp"

/// The loops over cells of the grains' elimination, vectorised over cells. Shells lie one after the other,
/// `n` cells each. The number of shells is a constant of the loop where that pays.
namespace couplet::thermocline {

inline constexpr int most_shells = 100;

/// Per cell of a layer: what the elimination needs and gives.
struct GrainCells {
  const double *rate, *share, *beta, *heat;
  std::size_t first, last, n;
};

/// fluid := rate fluid + extra + heat sum_j weight_j theta_j.
template <int N>
void gather_grains(const GrainElimination& e, const GrainCells& c, const double* shells, const double* extra,
                   double* fluid) {
  const int shells_in_grain = N > 0 ? N : e.n;
  constexpr int size = N > 0 ? N : most_shells;
  std::array<double, size> weight;
  for (int j = 0; j < shells_in_grain; ++j) weight[j] = e.weight[j];
#pragma GCC ivdep
  for (std::size_t i = c.first; i < c.last; ++i) {
    double sum = 0;
    for (int j = 0; j < shells_in_grain; ++j) sum += weight[j] * shells[j * c.n + i];
    fluid[i] = c.rate[i] * fluid[i] + extra[i] + c.heat[i] * sum;
  }
}

/// The shells at the new time from the fluid's temperature there; `to` may be `shells`.
template <int N>
void scatter_grains(const GrainElimination& e, const GrainCells& c, const double* shells, const double* fluid,
                    double* to) {
  const int shells_in_grain = N > 0 ? N : e.n;
  constexpr int size = N > 0 ? N : most_shells;
  std::array<double, size> weight, keep, pass, beta;
  for (int j = 0; j < shells_in_grain; ++j)
    weight[j] = e.weight[j], keep[j] = e.keep[j], pass[j] = e.pass[j], beta[j] = e.beta[j];
#pragma GCC ivdep
  for (std::size_t i = c.first; i < c.last; ++i) {
    std::array<double, size> theta;
    double sum = 0, inside = 0;
    for (int j = 0; j < shells_in_grain; ++j) theta[j] = shells[j * c.n + i], sum += weight[j] * theta[j];
    for (int j = shells_in_grain - 1; j >= 1; --j) theta[j] = inside = keep[j] * theta[j] + pass[j] * inside;
    double outside = c.share[i] * sum + c.beta[i] * fluid[i];
    to[i] = outside;
    for (int j = 1; j < shells_in_grain; ++j) to[j * c.n + i] = outside = theta[j] + beta[j] * outside;
  }
}

/// work(std::integral_constant<int, N>) with N the number of shells, 0 for a number without loops of its own.
template <class Work>
void with_shells(int shells, const Work& work) {
  switch (shells) {
    case 1:
      return work(std::integral_constant<int, 1>());
    case 2:
      return work(std::integral_constant<int, 2>());
    case 3:
      return work(std::integral_constant<int, 3>());
    case 4:
      return work(std::integral_constant<int, 4>());
    case 5:
      return work(std::integral_constant<int, 5>());
    case 6:
      return work(std::integral_constant<int, 6>());
    case 8:
      return work(std::integral_constant<int, 8>());
    default:
      return work(std::integral_constant<int, 0>());
  }
}

}  // namespace couplet::thermocline
