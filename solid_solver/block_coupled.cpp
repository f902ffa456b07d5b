// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/block_coupled.hpp"

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet {
namespace {

// Up to here LU wins in time and has the memory (about 20 kB an unknown in 3-D). Without inertia slender
// bending stalls ILU, so that static problems stay with LU for longer.
constexpr GlobalIndex direct_up_to = 60000, direct_up_to_static = 200000;

LinearMethod linear_method(const SolidProblem& problem, const MethodParameters& parameters) {
  using Choice = MethodParameters::LinearSolver;
  switch (parameters.linear_solver) {
    case Choice::direct:
      return LinearMethod::direct;
    case Choice::bicgstab_ilu:
      return LinearMethod::bicgstab_ilu;
    case Choice::gmres_multigrid:
      return LinearMethod::gmres_multigrid;
    case Choice::automatic:
      break;
  }
  const GlobalIndex n = sum(problem.mesh.comm, static_cast<GlobalIndex>(problem.elastic.n_unknowns()));
  return n <= (problem.is_static() ? direct_up_to_static : direct_up_to) ? LinearMethod::direct
                                                                         : LinearMethod::bicgstab_ilu;
}

LinearOptions options_of(LinearMethod method, const MethodParameters& parameters) {
  LinearOptions options;
  options.method = method;
  options.relative_tolerance = parameters.relative_tolerance;
  options.max_iterations = parameters.max_iterations;
  return options;
}

}  // namespace

BlockCoupled::BlockCoupled(const SolidProblem& problem, const MethodParameters& parameters)
    : linear_(linear_method(problem, parameters)),
      matrix_(problem.elastic.matrix(problem.inertia)),
      solver_("displacement", matrix_, options_of(linear_, parameters)) {}

SolveStatistics BlockCoupled::solve(std::span<const double> b, std::span<double> u) {
  try {
    return solver_.solve(b, u);
  } catch (const SolveFailure& e) {
    throw SolveFailure(
        "{} The method is {}. If the loads are sound, another 'solution-method: {{linear-solver: ...}}' may "
        "help; 'direct' "
        "needs most memory and bears most.",
        e.what(), name());
  }
}

std::string BlockCoupled::name() const {
  switch (linear_) {
    case LinearMethod::direct:
      return "block-coupled (direct)";
    case LinearMethod::bicgstab_ilu:
      return "block-coupled (BiCGStab, ILU)";
    default:
      return "block-coupled (GMRES, multigrid)";
  }
}

}  // namespace couplet
