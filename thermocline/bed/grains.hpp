// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "thermocline/material/properties.hpp"

namespace couplet::thermocline {

/// Heat conduction in the representative grain of a layer (5.8), per volume of the bed: `n` shells of equal
/// volume, numbered from the surface inward.
///
/// The conductances between shells, and from the outer shell's mean to the surface, are those of the
/// parabolic profile T ~ r^2 of a uniformly warming grain: flux 8 pi k a r^3 over the difference of the shell
/// means of a r^2. A single shell gives the linear driving force model (surface resistance d/(10 k)), and few
/// shells resolve the passing front. With many shells they become the usual 4 pi k r^2/dr.
struct Grains {
  /// `kelvin`: temperature of the properties.
  Grains(const Filler& filler, double porosity, double diameter, int n, double kelvin);

  int n;                        ///< shells
  double capacity;              ///< of each shell [J/(m^3 K)]; 0 in a bed without filler
  double area;                  ///< surface of the grains per volume of the bed [1/m]
  double surface;               ///< outer shell's mean to surface [W/(m^3 K)]
  std::vector<double> between;  ///< shell j to j+1 [W/(m^3 K)]; n - 1 values

  /// Conductance from fluid to outer shell at film coefficient h [W/(m^3 K)]. `ratio`: conductivity of that shell over that of `surface`.
  double exchange(double h, double ratio = 1) const {
    return h > 0 && area > 0 ? 1 / (1 / (h * area) + 1 / (surface * ratio)) : 0;
  }
};

/// Implicit conduction in the grains over a time tau, eliminated from the inside to the surface. With shells
/// theta_j and fluid T, theta_j = alpha_j + beta_j theta_{j-1} and theta_0 = alpha_0 + beta_0 T. All factors
/// except those of the surface are equal in all cells of a layer.
struct GrainElimination {
  GrainElimination(const Grains& grains, double tau);
  int n;
  /// Shell j > 0: alpha_j = keep_j theta_j^n + pass_j alpha_{j+1}.
  std::vector<double> keep, pass, beta;
  // Shell 0: alpha_0 = sum_j weight_j theta_j^n/(own + g), beta_0 = g/(own + g), g fluid to shell 0 [W/(m^3
  // K)].
  std::vector<double> weight;
  double own;
};

// Elimination loops, vectorized over cells. Shells are stored one after the other, with `n` cells each.

inline constexpr int most_shells = 100;

/// Per cell of a layer: input and output of the elimination.
struct GrainCells {
  const double *rate, *share, *beta, *heat;
  std::size_t first, last, n;
};

/// Computes sum_j weight_j theta_j of the grains, and fluid := rate fluid + extra + heat sum. Selected for
/// the processor at run time. Uses no fused operations, so that results are identical on all processors.
void gather_grains(const GrainElimination& e, const GrainCells& c, const double* shells, const double* extra,
                   double* fluid, double* sums);
/// Computes the shells at the new time from the new fluid temperature and the old sums; `to` may be `shells`.
void scatter_grains(const GrainElimination& e, const GrainCells& c, const double* shells, const double* fluid,
                    double* to, const double* sums);

}  // namespace couplet::thermocline
