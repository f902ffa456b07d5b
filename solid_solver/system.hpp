// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/linalg/linear_solver.hpp"
#include "solid_solver/solid.hpp"

namespace couplet {

/// The linear system of one step size, factorised (or preconditioned) once.
struct Solid::System {
  double dt;                    ///< 0: static
  double damping_scale = 1;     ///< s = 1 + 2 beta / dt
  std::vector<double> inertia;  ///< per owned cell: rho V / s (4 / dt^2 + 2 alpha / dt) [N/m]; empty: static
  SparseMatrix matrix;
  LinearSolver solver;

  System(const Mesh& mesh, const SolidParameters& parameters, const ElasticOperator& elastic, double step);

 private:
  std::vector<double> make_inertia(const Mesh& mesh, const SolidParameters& parameters);
};

}  // namespace couplet
