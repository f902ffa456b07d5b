// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/linalg/acceleration.hpp"
#include "common/linalg/linear_solver.hpp"
#include "common/linalg/matrix.hpp"
#include "solid_solver/method/solution_method.hpp"
#include "solid_solver/parameters/method_parameters.hpp"

namespace couplet::solid {

/// Implicit part of the segregated method, thesis (2.66)-(2.69): one scalar system per displacement component
/// with face coefficient (2 mu + lambda) |S|/(d . n). Solved by CG with incomplete Cholesky factors to a
/// hundredth of the initial residual. Boundary unknowns follow from their own rows.
class ScalarSystems {
 public:
  /// `inertia`: inertia of each owned cell [N/m], empty if static. Keeps references to mesh (reference geometry) and rows. Collective.
  ScalarSystems(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                std::span<const double> inertia);
  /// Computes the correction `step` for a residual, both packed as the rows. Returns the iterations. Collective.
  int find_step(std::span<const double> residual, std::span<double> step);

 private:
  struct Component {
    std::unique_ptr<linalg::SparseMatrix> matrix;
    std::unique_ptr<linalg::LinearSolver> solver;
  };
  void assemble(int component, std::span<const double> inertia);

  const mesh::Mesh& mesh_;
  const elastic::ElasticOperator& rows_;
  std::vector<Component> components_;
  std::vector<double> own_;  // diagonal coefficient of each face unknown
  std::vector<double> b_, u_;
};

/// Name for the log, for example "segregated (Aitken every 5 iterations)".
std::string segregated_name(const MethodParameters& parameters);
/// Acceleration of the outer iterations.
linalg::Acceleration acceleration_of(const MethodParameters& parameters);

/// Segregated method of the thesis. Each outer iteration solves one scalar system per displacement component (ScalarSystems); the other
/// terms use the last iterate. Outer iterations are plain, or accelerated by Aitken (2.70) or Anderson.
class Segregated final : public SolutionMethod {
 public:
  Segregated(const SolidProblem& problem, const MethodParameters& parameters);

 private:
  linalg::SolveStatistics find(std::span<const double> b, std::span<double> u) override;
  double find_residual(std::span<const double> b, std::span<const double> u);

  SolidProblem problem_;
  double tolerance_;
  int max_iterations_;
  ScalarSystems systems_;
  linalg::VectorAccelerator accelerator_;
  std::vector<double> residual_, step_;
};

}  // namespace couplet::solid
