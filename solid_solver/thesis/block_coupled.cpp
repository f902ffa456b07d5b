// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/thesis/block_coupled.hpp"

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {
namespace {

// Size up to which LU is faster and has enough memory (about 20 kB per unknown in 3-D). Without inertia, ILU
// stalls for slender bending, so static problems use LU longer.
constexpr GlobalIndex direct_up_to = 60000, direct_up_to_static = 200000;

linalg::LinearMethod linear_method(const SolidProblem& problem, const MethodParameters& parameters) {
  using Choice = MethodParameters::LinearSolver;
  const Choice choice = parameters.linear_solver;
  if (choice == Choice::direct) return linalg::LinearMethod::direct;
  if (choice == Choice::bicgstab_ilu) return linalg::LinearMethod::bicgstab_ilu;
  if (choice == Choice::gmres_multigrid) return linalg::LinearMethod::gmres_multigrid;
  const GlobalIndex n =
      parallel::sum(problem.mesh.comm, static_cast<GlobalIndex>(problem.elastic.n_unknowns()));
  return n <= (problem.is_static() ? direct_up_to_static : direct_up_to) ? linalg::LinearMethod::direct
                                                                         : linalg::LinearMethod::bicgstab_ilu;
}

linalg::LinearOptions options_of(linalg::LinearMethod method, const MethodParameters& parameters) {
  linalg::LinearOptions options;
  options.method = method;
  options.relative_tolerance = parameters.relative_tolerance;
  options.max_iterations = parameters.max_iterations;
  return options;
}

const char* name_of(linalg::LinearMethod method) {
  if (method == linalg::LinearMethod::direct) return "block-coupled (direct)";
  if (method == linalg::LinearMethod::bicgstab_ilu) return "block-coupled (BiCGStab, ILU)";
  return "block-coupled (GMRES, multigrid)";
}

}  // namespace

BlockCoupled::BlockCoupled(const SolidProblem& problem, const MethodParameters& parameters)
    : linear_(linear_method(problem, parameters)),
      matrix_(problem.elastic.matrix(problem.inertia)),
      solver_("displacement", matrix_, options_of(linear_, parameters)) {
  name_ = name_of(linear_);
}

linalg::SolveStatistics BlockCoupled::find(std::span<const double> b, std::span<double> u) {
  try {
    return solver_.solve(b, u);
  } catch (const SolveFailure& e) {
    // Suggests a method other than the failed one.
    throw SolveFailure(
        "{} The method is {}. If the loads are correct, try 'solution-method: {}'{}.", e.what(), name(),
        linear_ == linalg::LinearMethod::direct ? "{type: newton-krylov, face-gradient: symmetric}"
                                                : "{linear-solver: direct}",
        linear_ == linalg::LinearMethod::direct ? ""
                                                : ", the most robust option, at the highest "
                                                  "memory cost");
  }
}

}  // namespace couplet::solid
