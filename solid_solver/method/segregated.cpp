// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/method/segregated.hpp"

#include <chrono>
#include <cmath>

#include "common/base/error.hpp"

namespace couplet::solid {

Segregated::Segregated(const SolidProblem& problem, const MethodParameters& parameters)
    : problem_(problem),
      tolerance_(parameters.relative_tolerance),
      max_iterations_(parameters.max_iterations),
      systems_(problem.mesh, problem.elastic, problem.inertia),
      accelerator_(problem.mesh.comm, problem.elastic.n_unknowns(), acceleration_of(parameters)) {
  residual_.resize(problem.elastic.n_unknowns());
  step_ = residual_;
  name_ = segregated_name(parameters);
}

double Segregated::find_residual(std::span<const double> b, std::span<const double> u) {
  problem_.residual(b, u, residual_);
  return norm(problem_.mesh.comm, residual_);
}

linalg::SolveStatistics Segregated::solve(std::span<const double> b, std::span<double> u) {
  const auto start = std::chrono::steady_clock::now();
  linalg::SolveStatistics statistics;
  const double wanted = tolerance_ * norm(problem_.mesh.comm, b);
  accelerator_.restart();
  statistics.residual = find_residual(b, u);
  while (!(statistics.residual <= wanted)) {
    if (statistics.iterations == max_iterations_ || !std::isfinite(statistics.residual))
      throw SolveFailure(
          "The segregated method did not converge: {} outer iterations, residual {:.3e} of the right-hand "
          "side (tolerance {:.3e}). Bending or large nu couple the components too strongly for it; use "
          "'solution-method: {{type: newton-krylov}}', which needs no outer iterations.",
          statistics.iterations, statistics.residual / wanted * tolerance_, tolerance_);
    ++statistics.iterations;
    statistics.inner_iterations += systems_.find_step(residual_, step_);
    accelerator_.advance(u, step_);
    statistics.residual = find_residual(b, u);
  }
  statistics.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return statistics;
}

}  // namespace couplet::solid
