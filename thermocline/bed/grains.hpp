// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "thermocline/material/properties.hpp"

namespace couplet::thermocline {

/// Heat conduction inside the representative grain of a layer (5.8), per volume of the bed: `n` shells of
/// equal volume, numbered from the surface inwards.
///
/// The conductances between shells, and between the outer shell's mean and the surface, are those of the
/// parabolic profile T ~ r^2 of a grain that warms uniformly: flux 8 pi k a r^3 over the difference of the
/// shell means of a r^2. So one shell alone is the linear driving force model (resistance d/(10 k) on the
/// surface), and few shells resolve the front's passage; with more shells they become the usual 4 pi k
/// r^2/dr.
struct Grains {
  Grains(const Filler& filler, double porosity, double diameter, int n);

  int n;                        ///< shells
  double capacity;              ///< of each shell [J/(m^3 K)]; 0 in a bed without filler
  double area;                  ///< surface of the grains in a volume of the bed [1/m]
  double surface;               ///< outer shell's mean to surface [W/(m^3 K)]
  std::vector<double> between;  ///< shell j to j+1 [W/(m^3 K)]; n - 1 values

  /// Fluid to outer shell at film coefficient h [W/(m^3 K)].
  double exchange(double h) const { return h > 0 && area > 0 ? 1 / (1 / (h * area) + 1 / surface) : 0; }
};

/// Implicit conduction in the grains over a time tau, eliminated from the inside to the surface. With theta_j
/// the shells and T the fluid: theta_j = alpha_j + beta_j theta_{j-1}, theta_0 = alpha_0 + beta_0 T. All
/// factors but those of the surface are the same in all cells of a layer.
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

// The loops over cells of the elimination, vectorized over cells. Shells lie one after the other, `n` cells each.

inline constexpr int most_shells = 100;

/// Per cell of a layer: what the elimination needs and gives.
struct GrainCells {
  const double *rate, *share, *beta, *heat;
  std::size_t first, last, n;
};

/// sum_j weight_j theta_j of the grains, and fluid := rate fluid + extra + heat sum. Chosen by the processor
/// at run time; without fused operations, so that all processors give the same bits.
void gather_grains(const GrainElimination& e, const GrainCells& c, const double* shells, const double* extra,
                   double* fluid, double* sums);
/// The latter part, with sums that scatter_grains() left.
void gather_sums(const GrainCells& c, const double* extra, double* fluid, const double* sums);
/// The shells at the new time from the fluid's temperature there and the sums before; `to` may be `shells`.
/// `sums` are then those of the new shells.
void scatter_grains(const GrainElimination& e, const GrainCells& c, const double* shells, const double* fluid,
                    double* to, double* sums);

// Rows of the matrix of the bed, loops over the cells of a layer without branches.

struct ExchangeRows {
  double *rate, *share, *beta, *heat,
      *diagonal;  ///< as in PackedBed::Operator; what the diagonal begins with
};
/// Fluid against the grains of a layer eliminated over the step `tau` [s], in n cells. `capacity`: eps rho c dz [J/(m^2 K)];
/// `film` [W/(m^2 K)]; `dz` [m].
void exchange_rows(const Grains& grains, double own, double tau, std::size_t n, const double* capacity,
                   const double* film, const double* dz, const ExchangeRows& rows);

}  // namespace couplet::thermocline
