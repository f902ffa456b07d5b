// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/method/block_coupled.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {
namespace {

// Size up to which LU is faster and has enough memory (about 20 kB per unknown in 3-D). Without inertia, ILU
// stalls for slender bending, so static problems use LU longer.
constexpr GlobalIndex direct_up_to = 60000, direct_up_to_static = 200000;

linalg::LinearMethod linear_method(const SolidProblem& problem, const MethodParameters& parameters) {
  using Choice = MethodParameters::LinearSolver;
  switch (parameters.linear_solver) {
    case Choice::direct:
      return linalg::LinearMethod::direct;
    case Choice::bicgstab_ilu:
      return linalg::LinearMethod::bicgstab_ilu;
    case Choice::gmres_multigrid:
      return linalg::LinearMethod::gmres_multigrid;
    case Choice::automatic:
      break;
  }
  const GlobalIndex n =
      parallel::sum(problem.mesh.comm, static_cast<GlobalIndex>(problem.elastic.n_unknowns()));
  return n <= (problem.is_static() ? direct_up_to_static : direct_up_to) ? linalg::LinearMethod::direct
                                                                         : linalg::LinearMethod::bicgstab_ilu;
}

// Tolerance of the inner linear solve. A tighter one is wasted, because corrections change the equation.
constexpr double deferred_tolerance = 1e-2;
constexpr int deferred_history = 8;

linalg::LinearOptions options_of(linalg::LinearMethod method, const MethodParameters& parameters,
                                 bool deferred) {
  linalg::LinearOptions options;
  options.method = method;
  options.relative_tolerance = deferred ? deferred_tolerance : parameters.relative_tolerance;
  options.max_iterations = parameters.max_iterations;
  return options;
}

const char* name_of(linalg::LinearMethod method) {
  switch (method) {
    case linalg::LinearMethod::direct:
      return "block-coupled (direct)";
    case linalg::LinearMethod::bicgstab_ilu:
      return "block-coupled (BiCGStab, ILU)";
    default:
      return "block-coupled (GMRES, multigrid)";
  }
}

}  // namespace

BlockCoupled::BlockCoupled(const SolidProblem& problem, const MethodParameters& parameters)
    : problem_(problem),
      linear_(linear_method(problem, parameters)),
      tolerance_(parameters.relative_tolerance),
      max_iterations_(parameters.max_iterations),
      matrix_(problem.elastic.matrix(problem.inertia)),
      solver_("displacement", matrix_, options_of(linear_, parameters, problem.is_corrected())) {
  name_ = name_of(linear_);
  if (!problem.is_corrected()) return;
  const std::size_t n = problem.elastic.n_unknowns();
  accelerator_.emplace(problem.mesh.comm, n,
                       linalg::Acceleration{linalg::Acceleration::Type::anderson, 1, deferred_history});
  residual_.resize(n);
  step_.resize(n);
}

linalg::SolveStatistics BlockCoupled::find(std::span<const double> b, std::span<double> u) {
  try {
    return accelerator_ ? solve_corrected(b, u) : solver_.solve(b, u);
  } catch (const SolveFailure& e) {
    // Suggests a method other than the failed one.
    throw SolveFailure(
        "{} The method is {}. If the loads are correct, try 'solution-method: {}'{}.", e.what(), name(),
        linear_ == linalg::LinearMethod::direct ? "{type: newton-krylov}" : "{linear-solver: direct}",
        linear_ == linalg::LinearMethod::direct ? ""
                                                : ", the most robust option, at the highest "
                                                  "memory cost");
  }
}

linalg::SolveStatistics BlockCoupled::solve_corrected(std::span<const double> b, std::span<double> u) {
  const auto start = std::chrono::steady_clock::now();
  linalg::SolveStatistics statistics;
  const double size = norm(problem_.mesh.comm, b);
  accelerator_->restart();
  while (true) {
    problem_.residual(b, u, residual_);
    statistics.residual = norm(problem_.mesh.comm, residual_);
    if (statistics.residual <= tolerance_ * size) break;
    if (statistics.iterations == max_iterations_ || !std::isfinite(statistics.residual))
      throw SolveFailure(
          "The deferred correction of the block-coupled method did not converge: residual {:.3e} of the "
          "right-hand side after {} corrections (tolerance {:.3e}).",
          statistics.residual / size, statistics.iterations, tolerance_);
    ++statistics.iterations;
    std::ranges::fill(step_, 0.0);
    statistics.inner_iterations += solver_.solve(residual_, step_).iterations;
    accelerator_->advance(u, step_);
  }
  statistics.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return statistics;
}

}  // namespace couplet::solid
