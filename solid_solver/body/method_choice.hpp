// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {

/// Creates the requested method. `automatic` chooses by size and case; the name states the reason.
std::unique_ptr<SolutionMethod> make_solution_method(const SolidProblem& problem,
                                                     const MethodParameters& parameters);

}  // namespace couplet::solid
