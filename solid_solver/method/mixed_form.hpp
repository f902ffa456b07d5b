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

/// Approximate inverse of the Schur complement S = V/K_P + B (K' + mM)^-1 B^T. Uses one scalar matrix per rank, made once (factors in 2-D,
/// CG with multigrid in 3-D). V/mu, as for stable elements in Stokes flow, works only for smooth pressures: B^T p uses face means p_f, so
/// pressures alternating between cells (rows, checkerboards) do almost no work, and with V/mu the iterations grow with the mesh.
///
/// Quadrilaterals, hexahedra, prisms: S ~ V [s mu L + m rho V]^-1 W + V/K_P, where W is the cell part of B^T (the Gauss gradient of p_f)
/// squared over V, and L the two-point Laplacian, which equals W only for smooth p (commutators as in [elman2006], inertia as in
/// [cahouet1988]). Triangles and tetrahedra, if inertia does not dominate: S ~ sum_f V_f/(s mu) p_f^2 + V/K_P.
class PressureSchur {
 public:
  explicit PressureSchur(const SolidProblem& problem);
  /// z ~ S^-1 r with r [m^3] and z [Pa] of the owned cells, on this rank only.
  void apply(std::span<const double> r, std::span<double> z);

 private:
  class Rows;
  void by_gradients(const SolidProblem& problem, std::span<const double> volume);
  void by_faces(const SolidProblem& problem, std::span<const double> volume);

  double unit_ = 1;                               // [Pa]; scales matrices to about 1
  std::vector<double> inverse_volume_;            // only by_gradients
  std::unique_ptr<linalg::SparseMatrix> before_;  // only by_gradients
  std::unique_ptr<linalg::SparseMatrix> matrix_;  // matrix of solver_
  std::unique_ptr<linalg::LinearSolver> solver_;
  std::vector<double> between_;
};

/// Symmetric operator with the mean stresses p of its cells as additional unknowns [boffi2013],
///   [ K' + mM    B^T   ] [u]   [b]
///   [    B     -V / K_P] [p] = [0].
/// The iterations hardly grow as nu goes to 1/2, whereas those of CG on K = K' + B^T (K_P/V) B diverge. The preconditioner is block
/// triangular: PressureSchur for p, and the compact component-wise operator of K' + mM (ElasticPreconditioner) for u. p is not part of the
/// state. The stress of u is K_P theta, so residuals of volume rows are weighted by it.
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
  double forces_left_;  // residual forces from volume rows, relative to the right-hand side
  std::size_t n_u_, n_p_;
  std::unique_ptr<elastic::ElasticPreconditioner> multigrid_;
  PressureSchur schur_;
  std::vector<double> scale_;      // p over its unknown, and its row [N] over a volume [Pa/m, N/m^3]
  std::vector<double> stiffness_;  // K_P / V [Pa/m^3]
  std::vector<double> with_pressures_, forces_;
  std::unique_ptr<linalg::KrylovSolver> krylov_;
};

}  // namespace couplet::solid
