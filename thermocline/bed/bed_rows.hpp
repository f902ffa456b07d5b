// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

/// Rows of the bed's matrix, loops over the cells of a layer without branches.
namespace couplet::thermocline {

struct ExchangeLayer {
  double tau, own, area, surface;  ///< step [s]; of GrainElimination and Grains
};
struct ExchangeInput {
  const double *capacity, *film, *dz;  ///< eps rho c dz [J/(m^2 K)], [W/(m^2 K)], [m]
  std::size_t n;
};
struct ExchangeRows {
  double *rate, *share, *beta, *heat,
      *diagonal;  ///< as in PackedBed::Operator; what the diagonal begins with
};
/// Fluid against the eliminated grains, in layers with grains.
void exchange_rows(const ExchangeLayer& layer, const ExchangeInput& in, const ExchangeRows& rows);

/// Conduction between cells: lower and upper are set, the diagonal is added to.
void conduction_rows(int n, const double* conductivity, const double* dz, double* lower, double* diagonal,
                     double* upper);

}  // namespace couplet::thermocline
