// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "common/linalg/acceleration.hpp"
#include "common/linalg/linear_solver.hpp"
#include "common/linalg/matrix.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {

/// Block-coupled method of the thesis: all displacement components in one assembled matrix (2.77). The
/// corrected face gradient uses deferred correction: the assembled matrix repeatedly solves for the residual
/// of the corrected operator, with Anderson acceleration.
class BlockCoupled final : public SolutionMethod {
 public:
  BlockCoupled(const SolidProblem& problem, const MethodParameters& parameters);

 private:
  linalg::SolveStatistics find(std::span<const double> b, std::span<double> u) override;
  linalg::SolveStatistics solve_corrected(std::span<const double> b, std::span<double> u);

  SolidProblem problem_;
  linalg::LinearMethod linear_;
  double tolerance_;
  int max_iterations_;
  linalg::SparseMatrix matrix_;
  linalg::LinearSolver solver_;
  std::optional<linalg::Accelerator> accelerator_;  // for the corrected gradient
  std::vector<double> residual_, step_;
};

}  // namespace couplet::solid
