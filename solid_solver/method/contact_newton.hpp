// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/linalg/matrix.hpp"
#include "solid_solver/contact/pressing.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {

/// What is solved: K u = b + C^T f(C u), f the forces of the seat.
struct ContactProblem {
  MPI_Comm comm;
  const linalg::LinearMap& stiffness;  ///< K, inertia included
  SolutionMethod& method;              ///< for K alone
  Pressing& pressing;
  std::span<const double> known;  ///< columns, whose part of b stands there
  double tolerance;               ///< of the residual over the rows
  int most_iterations;            ///< of the linear solver
};

/// Semi-smooth Newton's method [hueber2005]: the forces are the slope of a convex energy, so that with the exact length of each
/// correction it ends at any stiffness. The tangent K + C^T k C is solved by conjugate gradients with the preconditioner of K. A body
/// that is clear of the seat is solved for by the method of K, and looked at once. `u`: the first guess on entry. Throws SolveFailure.
/// Collective.
linalg::SolveStatistics solve_with_contact(const ContactProblem& problem, std::span<const double> b,
                                           std::span<double> u);

}  // namespace couplet::solid
