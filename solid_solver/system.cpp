// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/system.hpp"

#include "common/parallel/collective.hpp"

namespace couplet {
namespace {

// Up to here LU wins in time and has the memory (about 20 kB an unknown in 3-D). Without inertia slender
// bending stalls ILU, so that static problems stay with LU for longer.
constexpr GlobalIndex direct_up_to = 60000, direct_up_to_static = 200000;

LinearOptions options_of(const SolidLinearSolver& chosen, GlobalIndex n_unknowns, bool is_static) {
  using Method = SolidLinearSolver::Method;
  LinearOptions options;
  options.relative_tolerance = chosen.relative_tolerance;
  options.max_iterations = chosen.max_iterations;
  switch (chosen.method) {
    case Method::direct:
      options.method = LinearMethod::direct;
      break;
    case Method::bicgstab_ilu:
      options.method = LinearMethod::bicgstab_ilu;
      break;
    case Method::gmres_multigrid:
      options.method = LinearMethod::gmres_multigrid;
      break;
    case Method::automatic:
      options.method = n_unknowns <= (is_static ? direct_up_to_static : direct_up_to)
                           ? LinearMethod::direct
                           : LinearMethod::bicgstab_ilu;
  }
  return options;
}

}  // namespace

Solid::System::System(const Mesh& mesh, const SolidParameters& parameters, const ElasticOperator& elastic,
                      double step)
    : dt(step),
      inertia(make_inertia(mesh, parameters)),
      matrix(elastic.matrix(inertia)),
      solver("displacement", matrix,
             options_of(parameters.linear_solver,
                        sum(mesh.comm, static_cast<GlobalIndex>(elastic.n_unknowns())), dt == 0)) {}

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
