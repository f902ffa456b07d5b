// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/linalg/linear_solver.hpp"
#include "common/linalg/matrix.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {

/// Block-coupled method of the thesis: all displacement components in one assembled matrix (2.77).
class BlockCoupled final : public SolutionMethod {
 public:
  BlockCoupled(const SolidProblem& problem, const MethodParameters& parameters);

 private:
  linalg::SolveStatistics find(std::span<const double> b, std::span<double> u) override;

  linalg::LinearMethod linear_;
  linalg::SparseMatrix matrix_;
  linalg::LinearSolver solver_;
};

}  // namespace couplet::solid
