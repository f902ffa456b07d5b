// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/finite/finite_kernel.hpp"
#include "common/elasticity/solve/current_rigid_modes.hpp"
#include "common/elasticity/solve/elastic_preconditioner.hpp"
#include "common/linalg/krylov.hpp"
#include "common/linalg/linear_solver.hpp"
#include "solid_solver/boundary/seat.hpp"

namespace couplet::solid {

/// Solves K(u) du = r for the tangent of a deformed body by conjugate gradients. Preconditioner: the compact
/// component-wise operator of the undeformed body, made once and applied in the frame that turns with each
/// cell (residuals turned back, corrections turned forth), and rigid motions of aggregates about their present
/// places where the body is not small. Near incompressibility that operator is none of the tangent's: small bodies
/// take factors of the tangent itself, made anew where those of an earlier correction no longer do.
class TangentSolver {
 public:
  enum class By { frames, factors };
  /// `node_inertia`: mass factor times mass of the unknown nodes [N/m]; empty: static. All by reference.
  /// Collective.
  TangentSolver(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, elastic::FiniteKernel& kernel,
                double mass_factor, std::span<const double> node_inertia, By by);

  double mass_factor() const { return mass_factor_; }
  /// The seat whose stiffness is a part of K(u) from here on, by reference; null: none.
  void meet(const Pressing* pressing) { pressing_ = pressing; }
  /// A new load or step: factors of an earlier one are not used again, so that a run that continues takes the same way.
  void forget_factors() { factors_.reset(); }
  /// The preconditioner follows the body: frames, and `with_modes` also the rigid motions. At the last
  /// linearise() of the kernel. Collective.
  void follow(bool with_modes);
  /// du holds the correction. Throws SolveFailure. Collective.
  linalg::SolveStatistics solve(std::span<const double> r, std::span<double> du, double relative_tolerance,
                                int max_iterations);
  /// z near K^-1 r, after follow().
  void precondition(std::span<const double> r, std::span<double> z);

 private:
  linalg::SolveStatistics solve_by_own_factors(std::span<const double> r, std::span<double> du,
                                               const linalg::KrylovOptions& options);
  linalg::SolveStatistics counted(std::span<const double> r, std::span<double> du,
                                  const linalg::KrylovOptions& options);
  void make_factors();
  void find_frames(std::span<const Tensor3> gradient);
  void turn(std::span<const double> from, bool back, std::span<double> to) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const elastic::ElasticOperator& rows_;
  elastic::FiniteKernel& kernel_;
  double mass_factor_;
  std::span<const double> node_inertia_;
  By by_;
  const Pressing* pressing_ = nullptr;
  bool is_unsymmetric_ = false;                   // a pressure follows the surface
  std::unique_ptr<linalg::SparseMatrix> matrix_;  // of factors
  std::unique_ptr<linalg::LinearSolver> factors_;
  bool is_fresh_ = false;  // they are those of the last linearise()
  int iterations_ = 0;     // of the last solution
  std::unique_ptr<elastic::ElasticPreconditioner> compact_;
  std::unique_ptr<elastic::CurrentRigidModes> modes_;  // null: the body is small
  std::vector<Tensor3> frame_;                         // of the unknown nodes
  std::vector<double> turned_, correction_;
  std::unique_ptr<linalg::KrylovSolver> krylov_;
};

}  // namespace couplet::solid
