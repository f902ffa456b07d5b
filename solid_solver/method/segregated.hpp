// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/linalg/acceleration.hpp"
#include "solid_solver/method/scalar_systems.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {

/// The thesis's segregated method: outer iterations that each solve one scalar system a displacement component
/// (ScalarSystems); what these leave out follows from the last iterate. The outer iteration is plain, or
/// accelerated by Aitken (2.70) or Anderson.
class Segregated final : public SolutionMethod {
 public:
  Segregated(const SolidProblem& problem, const MethodParameters& parameters);
  linalg::SolveStatistics solve(std::span<const double> b, std::span<double> u) override;

 private:
  double find_residual(std::span<const double> b, std::span<const double> u);

  SolidProblem problem_;
  double tolerance_;
  int max_iterations_;
  ScalarSystems systems_;
  linalg::Accelerator accelerator_;
  std::vector<double> residual_, step_;
};

}  // namespace couplet::solid
