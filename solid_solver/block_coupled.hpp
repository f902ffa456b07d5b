// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/linalg/linear_solver.hpp"
#include "common/linalg/matrix.hpp"
#include "solid_solver/solution_method.hpp"

namespace couplet {

/// The thesis's block-coupled method: all displacement components in one assembled matrix (2.77).
class BlockCoupled final : public SolutionMethod {
 public:
  BlockCoupled(const SolidProblem& problem, const MethodParameters& parameters);
  SolveStatistics solve(std::span<const double> b, std::span<double> u) override;
  std::string name() const override;

 private:
  LinearMethod linear_;
  SparseMatrix matrix_;
  LinearSolver solver_;
};

}  // namespace couplet
