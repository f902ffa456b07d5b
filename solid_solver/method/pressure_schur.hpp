// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/linalg/linear_solver.hpp"
#include "common/linalg/matrix.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {

/// Approximate inverse of the Schur complement S = V / K_P + B (K' + mM)^-1 B^T of the mixed form, by a scalar
/// matrix between the cells of each rank, made once (factors in the plane, conjugate gradients with multigrid in space). V / mu, as for Stokes' equations with elements that are stable, would
/// do for smooth pressures alone: B^T p sees the means p_f of the faces, so that pressures which change their sign from
/// cell to cell (rows, columns, checkerboards) do next to no work, and without them the iterations grow with the mesh.
///
/// Quadrilaterals, hexahedra, prisms: with W = B^T's part on cells (the Gauss gradient of p_f) squared over V and the
/// two-point Laplacian L, which W is for smooth p but not for the others, S ~ V [s mu L + m rho V]^-1 W + V / K_P
/// (commutators as in [elman2006], inertia as in [cahouet1988]). Triangles and tetrahedra, where inertia does not
/// rule: S ~ sum_f V_f / (s mu) p_f^2 + V / K_P.
class PressureSchur {
 public:
  explicit PressureSchur(const SolidProblem& problem);
  /// z ~ S^-1 r, r [m^3] and z [Pa] of the owned cells; this rank's alone.
  void apply(std::span<const double> r, std::span<double> z);

 private:
  class Rows;
  void by_gradients(const SolidProblem& problem, std::span<const double> volume);
  void by_faces(const SolidProblem& problem, std::span<const double> volume);

  double unit_ = 1;                               // [Pa]: matrices without it are near 1
  std::vector<double> inverse_volume_;            // by_gradients alone
  std::unique_ptr<linalg::SparseMatrix> before_;  // by_gradients alone
  std::unique_ptr<linalg::SparseMatrix> matrix_;  // that is solved with
  std::unique_ptr<linalg::LinearSolver> solver_;
  std::vector<double> between_;
};

}  // namespace couplet::solid
