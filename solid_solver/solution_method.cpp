// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/solution_method.hpp"

#include "solid_solver/block_coupled.hpp"

namespace couplet {

std::unique_ptr<SolutionMethod> make_solution_method(const SolidProblem& problem,
                                                     const MethodParameters& parameters) {
  return std::make_unique<BlockCoupled>(problem, parameters);
}

}  // namespace couplet
