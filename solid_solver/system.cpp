// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/system.hpp"

#include "common/parallel/collective.hpp"

namespace couplet {
namespace {

// LU of a 3-D block matrix with more unknowns than this takes longer than the iterations of a few hundred
// steps.
constexpr GlobalIndex direct_up_to = 60000;

LinearOptions options_of(const SolidLinearSolver& chosen, GlobalIndex n_unknowns) {
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
      options.method = n_unknowns <= direct_up_to ? LinearMethod::direct : LinearMethod::bicgstab_ilu;
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
                        sum(mesh.comm, static_cast<GlobalIndex>(elastic.n_unknowns())))) {}

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
