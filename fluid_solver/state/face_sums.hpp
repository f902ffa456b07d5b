// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

// Sums over the interior faces of each cell, in the instructions of the processor at hand.

/// sum -= factor times what flows out by phi; gives the sum of the squares of phi.
double subtract_outflow(const mesh::Mesh& mesh, double factor, std::span<const double> phi,
                        std::span<double> sum);
/// phi -= factor g (p_N - p_P).
struct FluxCorrection {
  double factor;
  const double* conductance;  ///< g
  double* phi;
};
/// sum += p_f S, p_f linear between the cells; `correction`: made in the same pass; nullptr for none.
void add_pressure(const mesh::Mesh& mesh, const Placement<2>& at, std::span<const double> p,
                  const FluxCorrection* correction, Vectors<2>& sum);
void add_pressure(const mesh::Mesh& mesh, const Placement<3>& at, std::span<const double> p,
                  const FluxCorrection* correction, Vectors<3>& sum);

}  // namespace couplet::fluid
