// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include "solid_solver/method/solution_method.hpp"
#include "solid_solver/stability/prestress.hpp"

namespace couplet::solid {

/// The lowest load factor of a linear static run, if it is low.
struct BucklingEstimate {
  /// Below it the lateral motion is off by 1/(factor - 1) of itself and more.
  static constexpr double low = 3;
  double factor = 0;  ///< an upper bound of lambda; 0: not looked for, none, or not below `low`
  int iterations = 0;
};

/// A finding, where `factor` is below `low`; `how` goes before it. Collective.
void tell_buckling(MPI_Comm comm, double factor, const char* how);
/// Of a body in motion, whose inertia may outlast a short load: never `wrong`. Collective.
void tell_dynamic_buckling(MPI_Comm comm, double factor);

/// Conjugate gradients on K + 3 K_sigma with the preconditioner of `method` meet a negative curvature where the factor is below 3: one
/// loose solution more. Nothing is done where the compression is far
/// below what buckles a body as slender as this, 0.2 (t/L)^2 of strain for a clamped column, or hardly more than
/// `compression_seen` [Pa], which it then becomes. Collective.
BucklingEstimate estimate_buckling(const SolidBody& body, const SolidFields& fields, double time,
                                   SolutionMethod& method, double& compression_seen);

}  // namespace couplet::solid
