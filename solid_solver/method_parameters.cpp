// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/method_parameters.hpp"

namespace couplet {

void declare(config::Section& s, MethodParameters& m) {
  using Type = MethodParameters::Type;
  using LinearSolver = MethodParameters::LinearSolver;
  s.choice("type", m.type, {{"auto", Type::automatic}, {"block-coupled", Type::block_coupled}})
      .doc("block-coupled: one assembled system of all displacement components");
  s.choice("linear-solver", m.linear_solver,
           {{"auto", LinearSolver::automatic},
            {"direct", LinearSolver::direct},
            {"bicgstab-ilu", LinearSolver::bicgstab_ilu},
            {"gmres-multigrid", LinearSolver::gmres_multigrid}})
      .doc("of block-coupled; auto: direct up to 60 000 unknowns (static: 200 000), above that bicgstab-ilu");
  s.value("relative-tolerance", m.relative_tolerance)
      .range(1e-15, 1e-2)
      .doc("residual over right-hand side at which the iteration stops");
  s.value("max-iterations", m.max_iterations).range(1, 1e6).doc("iterations after which a step has failed");
}

}  // namespace couplet
