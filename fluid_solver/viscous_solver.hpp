// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fluid_solver/boundary.hpp"
#include "fluid_solver/placement.hpp"

namespace couplet::fluid {

/// Solves  V u + beta sum_f g (u_P - u_f) = b  for all components at once: CG with Jacobi, no matrix, so that
/// a mesh that moves costs nothing extra. beta = a nu dt [m^2]. The system is well conditioned wherever
/// convection limits the step.
template <int D>
class ViscousSolver {
 public:
  ViscousSolver(const Mesh& mesh, const Boundary<D>& boundary) : mesh_(mesh), boundary_(boundary) {}
  /// `b`: per local cell (owned ones count) without boundary parts; `w`: given velocity per boundary face;
  /// `u`: guess on entry, with ghosts current on exit. Returns the iterations; throws SolveFailure.
  /// Collective.
  int solve(const Placement<D>& at, double beta, const Vectors<D>& w, double tolerance, Vectors<D>& b,
            Vectors<D>& u);

 private:
  void multiply(const Placement<D>& at, double beta, Vectors<D>& x, Vectors<D>& y) const;
  const Mesh& mesh_;
  const Boundary<D>& boundary_;
  Vectors<D> r_, q_, search_;
  std::vector<double> inverse_diagonal_;
};

}  // namespace couplet::fluid
