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

/// Solves K(u) du = r for the tangent of a deformed body by CG. The preconditioner is the compact component-wise operator of the undeformed
/// body, applied in frames that rotate with the cells. Bodies that are not small add the rigid motions of aggregates in their present
/// position. That operator is unsuitable near incompressibility, so small bodies use factors of the tangent itself, recomputed when older
/// ones are no longer good enough.
class TangentSolver {
 public:
  enum class By { frames, factors };
  /// `node_inertia`: mass factor times mass of the unknown nodes [N/m]; empty if static. Keeps references. Collective.
  TangentSolver(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, elastic::FiniteKernel& kernel,
                double mass_factor, std::span<const double> node_inertia, By by);

  double mass_factor() const { return mass_factor_; }
  /// Adds the stiffness of a seat to K(u), by reference; nullptr if there is none.
  void meet(const Pressing* pressing) { pressing_ = pressing; }
  /// Discards factors for a new load or step, so that a restarted run is identical.
  void forget_factors() { factors_.reset(); }
  /// Updates the frames, and with `with_modes` the rigid motions, to the last linearise() of the kernel. Collective.
  void follow(bool with_modes);
  /// Returns the correction in du. Throws SolveFailure. Collective.
  linalg::SolveStatistics solve(std::span<const double> r, std::span<double> du, double relative_tolerance,
                                int max_iterations);
  /// Sets z to an approximation of K^-1 r. Call after follow().
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
  std::unique_ptr<linalg::SparseMatrix> matrix_;  // matrix of the factors
  std::unique_ptr<linalg::LinearSolver> factors_;
  bool is_fresh_ = false;  // factors_ belong to the last linearise()
  int iterations_ = 0;     // of the last solution
  std::unique_ptr<elastic::ElasticPreconditioner> compact_;
  std::unique_ptr<elastic::CurrentRigidModes> modes_;  // nullptr for a small body
  std::vector<Tensor3> frame_;                         // of the unknown nodes
  std::vector<double> turned_, correction_;
  std::unique_ptr<linalg::KrylovSolver> krylov_;
};

}  // namespace couplet::solid
