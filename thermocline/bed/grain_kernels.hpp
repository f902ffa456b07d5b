// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "thermocline/bed/grains.hpp"

/// The loops over cells of the grains' elimination, vectorised over cells. Shells lie one after the other,
/// `n` cells each.
namespace couplet::thermocline {

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

}  // namespace couplet::thermocline
