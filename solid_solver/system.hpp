// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "solid_solver/solid.hpp"
#include "solid_solver/solution_method.hpp"

namespace couplet {

/// What belongs to one step size: factors and preconditioners are made once for it.
struct Solid::System {
  double dt;                    ///< 0: static
  double damping_scale = 1;     ///< s = 1 + 2 beta / dt
  std::vector<double> inertia;  ///< per owned cell: rho V / s (4 / dt^2 + 2 alpha / dt) [N/m]; empty: static
  std::unique_ptr<SolutionMethod> method;

  System(const Mesh& mesh, const SolidParameters& parameters, const ElasticOperator& elastic, double step);

 private:
  std::vector<double> make_inertia(const Mesh& mesh, const SolidParameters& parameters);
};

}  // namespace couplet
