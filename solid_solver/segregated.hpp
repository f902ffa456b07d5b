// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/linalg/acceleration.hpp"
#include "common/linalg/linear_solver.hpp"
#include "common/linalg/matrix.hpp"
#include "solid_solver/solution_method.hpp"

namespace couplet {

/// The thesis's segregated method: outer iterations that each solve one scalar system a displacement
/// component, face coefficient (2 mu + lambda) |S| / (d . n), by CG with incomplete Cholesky factors to a
/// hundredth of its residual; what the scalar systems leave out follows from the last iterate. The outer
/// iteration is plain, or accelerated by Aitken (2.70) or Anderson.
class Segregated final : public SolutionMethod {
 public:
  Segregated(const SolidProblem& problem, const MethodParameters& parameters);
  SolveStatistics solve(std::span<const double> b, std::span<double> u) override;

 private:
  struct Component {
    std::unique_ptr<SparseMatrix> matrix;
    std::unique_ptr<LinearSolver> solver;
  };
  void assemble(int component);
  double find_residual(std::span<const double> b, std::span<const double> u);
  /// The scalar solves for the residual; gives their iterations.
  int find_step();

  SolidProblem problem_;
  double tolerance_;
  int max_iterations_;
  std::vector<Component> components_;
  std::vector<double> own_;  // coefficient of each unknown of a face in its row
  Accelerator accelerator_;
  std::vector<double> residual_, step_, scalar_b_, scalar_u_;
};

}  // namespace couplet
