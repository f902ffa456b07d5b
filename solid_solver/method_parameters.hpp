// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/section.hpp"

namespace couplet {

/// How the equations of a step are solved.
struct MethodParameters {
  enum class Type { automatic, block_coupled };
  enum class LinearSolver { automatic, direct, bicgstab_ilu, gmres_multigrid };
  Type type = Type::automatic;
  LinearSolver linear_solver = LinearSolver::automatic;  // of the block-coupled method
  double relative_tolerance = 1e-10;
  int max_iterations = 2000;
};

void declare(config::Section& section, MethodParameters& method);

}  // namespace couplet
