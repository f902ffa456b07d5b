// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/solve/elastic_preconditioner.hpp"
#include "common/linalg/krylov.hpp"
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

/// The symmetric operator with the mean stresses p of its cells as unknowns beside the displacements [boffi2013],
///   [ K' + mM    B^T   ] [u]   [b]
///   [    B     -V / K_P] [p] = [0],
/// whose iterations hardly grow as nu goes to 1/2, where those of conjugate gradients on K = K' + B^T (K_P / V) B have no
/// end. Preconditioner: block triangular, for p the Schur complement (PressureSchur), for u the compact
/// component-wise operator of K' + mM (ElasticPreconditioner). p is no state of its own: the stress of u is K_P theta, so
/// that rows of volumes are weighed by what is left of them there.
class MixedForm final : public SolutionMethod {
 public:
  MixedForm(const SolidProblem& problem, const MethodParameters& parameters);
  /// The rows of the mixed form and their preconditioner: displacements, then mean stresses over their scale. Collective.
  void apply(std::span<const double> x, std::span<double> y);
  void precondition(std::span<const double> r, std::span<double> z);
  std::size_t n_unknowns() const { return n_u_ + n_p_; }

 private:
  linalg::SolveStatistics find(std::span<const double> b, std::span<double> u) override;
  void find_scales();
  void add_pressures(std::span<const double> b, std::span<double> x);

  SolidProblem problem_;
  linalg::KrylovOptions options_;
  double forces_left_;  // by the rows of volumes, over the right-hand side
  std::size_t n_u_, n_p_;
  std::unique_ptr<elastic::ElasticPreconditioner> multigrid_;
  PressureSchur schur_;
  std::vector<double> scale_;      // p over its unknown, and its row [N] over a volume [Pa/m, N/m^3]
  std::vector<double> stiffness_;  // K_P / V [Pa/m^3]
  std::vector<double> with_pressures_, forces_;
  std::unique_ptr<linalg::KrylovSolver> krylov_;
};

}  // namespace couplet::solid
