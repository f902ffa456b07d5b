// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/system.hpp"

namespace couplet {

Solid::System::System(const Mesh& mesh, const SolidParameters& parameters, const ElasticOperator& elastic,
                      double step)
    : dt(step),
      inertia(make_inertia(mesh, parameters)),
      method(make_solution_method({mesh, elastic, inertia}, parameters.method)) {}

std::vector<double> Solid::System::make_inertia(const Mesh& mesh, const SolidParameters& parameters) {
  std::vector<double> result;
  if (dt == 0) return result;
  const SolidDamping damping = parameters.damping.value_or(SolidDamping{});
  damping_scale = 1 + 2 * damping.stiffness / dt;
  const double factor = parameters.material.density / damping_scale * (4 / (dt * dt) + 2 * damping.mass / dt);
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) result.push_back(factor * mesh.reference.volume[c]);
  return result;
}

}  // namespace couplet
