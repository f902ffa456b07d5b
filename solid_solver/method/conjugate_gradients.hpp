// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/solve/current_rigid_modes.hpp"
#include "common/elasticity/solve/elastic_preconditioner.hpp"
#include "common/elasticity/symmetric/symmetric_matrix.hpp"
#include "common/linalg/krylov.hpp"
#include "common/linalg/matrix.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {

/// Conjugate gradients on the operator without a matrix; one Newton step, because the problem is linear.
/// Preconditioned by the compact component-wise operator (ElasticPreconditioner) and rigid motions of
/// aggregates, or by factors of the matrix where one serves so many steps that they pay.
class ConjugateGradients final : public SolutionMethod {
 public:
  ConjugateGradients(const SolidProblem& problem, const MethodParameters& parameters);

 private:
  linalg::SolveStatistics find(std::span<const double> b, std::span<double> u) override;
  bool invert(std::span<const double> r, std::span<double> z) override;
  void choose_multigrid();
  void add_rigid_motions(const std::vector<double>& inertia);
  void choose_factors();
  void project(std::span<double> unknowns) const;

  SolidProblem problem_;
  linalg::KrylovOptions options_;
  std::unique_ptr<elastic::ElasticPreconditioner> multigrid_;
  std::unique_ptr<elastic::CurrentRigidModes> modes_;  // for slender bodies
  std::unique_ptr<linalg::SparseMatrix> matrix_;
  std::unique_ptr<linalg::LinearSolver> factors_;
  std::unique_ptr<elastic::TiedMatrix> tied_;  // in 3-D
  std::unique_ptr<linalg::KrylovSolver> krylov_;
};

/// Body in the reference configuration.
elastic::DeformedBody at_rest(const mesh::Mesh& mesh);

/// Largest extent over mean thickness 2 V/S: L/h (2-D beam), 2 L/h (square beam), 3 (cube). Collective.
double slenderness(const mesh::Mesh& mesh, const mesh::Geometry& geometry);

/// Mean over cells of inertia over the sum of (2 mu + lambda) |S|/(d . n) over faces; 0 if static. For
/// squares and the trapezoidal rule it is the inverse square of the elastic Courant number. Collective.
double heaviness(const SolidProblem& problem);

/// Row sums of the kernel's mass times its factor, one per unknown node; empty if static.
std::vector<double> node_inertia(const SolidProblem& problem);

}  // namespace couplet::solid
