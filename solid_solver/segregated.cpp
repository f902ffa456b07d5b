// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/segregated.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet {
namespace {

// Of the residual of a component in one outer iteration, as in the thesis.
constexpr double inner_tolerance = 1e-2;

Acceleration acceleration_of(const MethodParameters& parameters) {
  using Choice = MethodParameters::Acceleration;
  const Choice choice = parameters.acceleration;
  return {choice == Choice::none     ? Acceleration::Type::none
          : choice == Choice::aitken ? Acceleration::Type::aitken
                                     : Acceleration::Type::anderson,
          parameters.aitken_interval, parameters.anderson_history};
}

double stiffness(const SolidProblem& problem, Index f) {
  const LameConstants lame = problem.elastic.lame(problem.mesh.owner[f]);
  const FaceLine line = face_line(problem.mesh, problem.mesh.reference, f);
  return (2 * lame.mu + lame.lambda) * line.area * line.inverse_dn;
}

/// What a boundary face adds on the diagonal of its cell.
double boundary_diagonal(const SolidProblem& problem, Index f, int component) {
  const double k = stiffness(problem, f), n = problem.mesh.reference.face_area[f].normalized()[component];
  switch (problem.elastic.condition(f)) {
    case ElasticCondition::prescribed:
      return k;
    case ElasticCondition::symmetry:
      return k * n * n;
    case ElasticCondition::support: {
      const ElasticSupport& s = problem.elastic.support(f);
      const double known = s.known(component, component);
      const double spring = problem.mesh.reference.face_area[f].norm() * s.spring(component, component);
      return k * (known + (1 - known) * spring / (k + spring));
    }
    case ElasticCondition::bonded: {
      const double other =
          stiffness(problem, problem.mesh.n_interior + problem.mesh.twin[f - problem.mesh.n_interior]);
      return k * other / (k + other);
    }
    default:
      return 0;
  }
}

}  // namespace

Segregated::Segregated(const SolidProblem& problem, const MethodParameters& parameters)
    : problem_(problem),
      tolerance_(parameters.relative_tolerance),
      max_iterations_(parameters.max_iterations),
      accelerator_(problem.mesh.comm, problem.elastic.n_unknowns(), acceleration_of(parameters)) {
  const std::size_t n = problem.elastic.n_unknowns();
  residual_.resize(n);
  step_.resize(n);
  scalar_b_.resize(problem.mesh.cells.n_owned());
  scalar_u_ = scalar_b_;
  for (int c = 0; c < problem.mesh.dim; ++c) assemble(c);
  for (const Index f : problem.elastic.unknown_faces()) {
    double own = stiffness(problem, f);
    if (problem.elastic.condition(f) == ElasticCondition::bonded)
      own += stiffness(problem, problem.mesh.n_interior + problem.mesh.twin[f - problem.mesh.n_interior]);
    if (problem.elastic.condition(f) == ElasticCondition::support)
      own += problem.mesh.reference.face_area[f].norm() * problem.elastic.support(f).spring.trace();
    own_.push_back(own);
  }
  name_ = "segregated";
  if (parameters.acceleration == MethodParameters::Acceleration::aitken)
    name_ += fmt::format(" (Aitken every {} iterations)", parameters.aitken_interval);
  if (parameters.acceleration == MethodParameters::Acceleration::anderson)
    name_ += fmt::format(" (Anderson over {} iterations)", parameters.anderson_history);
}

void Segregated::assemble(int component) {
  const Mesh& mesh = problem_.mesh;
  const Index n = mesh.cells.n_owned();
  std::vector<GlobalIndex> row, column;
  std::vector<double> value, diagonal(n, 0);
  const auto couple = [&](Index a, Index b, double k) {
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
      if (from >= n) continue;
      row.push_back(mesh.cells.global(from));
      column.push_back(mesh.cells.global(to));
      value.push_back(-k);
      diagonal[from] += k;
    }
  };
  for (Index f = 0; f < mesh.n_interior; ++f)
    couple(mesh.owner[f], mesh.neighbour[f], stiffness(problem_, f));
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    diagonal[mesh.owner[f]] += boundary_diagonal(problem_, f, component);
  for (Index c = 0; c < n; ++c) {
    if (!problem_.inertia.empty()) diagonal[c] += problem_.inertia[c];
    row.push_back(mesh.cells.global(c));
    column.push_back(mesh.cells.global(c));
    value.push_back(diagonal[c]);
  }
  Component here;
  here.matrix = std::make_unique<SparseMatrix>(mesh.comm, n, std::move(row), std::move(column));
  here.matrix->fill(value);
  LinearOptions options;
  options.method = LinearMethod::cg_icc;
  options.relative_tolerance = inner_tolerance;
  here.solver = std::make_unique<LinearSolver>("a displacement component", *here.matrix, options);
  components_.push_back(std::move(here));
}

double Segregated::find_residual(std::span<const double> b, std::span<const double> u) {
  problem_.residual(b, u, residual_);
  return norm(problem_.mesh.comm, residual_);
}

int Segregated::find_step() {
  int inner = 0;
  const std::size_t n = problem_.mesh.cells.n_owned(), dim = problem_.mesh.dim;
  for (std::size_t a = 0; a < dim; ++a) {
    for (std::size_t c = 0; c < n; ++c) scalar_b_[c] = residual_[c * dim + a];
    std::fill(scalar_u_.begin(), scalar_u_.end(), 0.0);
    inner += components_[a].solver->solve(scalar_b_, scalar_u_).iterations;
    for (std::size_t c = 0; c < n; ++c) step_[c * dim + a] = scalar_u_[c];
  }
  const auto& faces = problem_.elastic.unknown_faces();
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const bool is_support = problem_.elastic.condition(faces[i]) == ElasticCondition::support;
    for (std::size_t a = 0; a < dim; ++a) {
      const double cell = step_[std::size_t(problem_.mesh.owner[faces[i]]) * dim + a];
      const double follows = is_support ? 1 - problem_.elastic.support(faces[i]).known(a, a) : 1;
      step_[(n + i) * dim + a] = follows * cell + residual_[(n + i) * dim + a] / own_[i];
    }
  }
  return inner;
}

SolveStatistics Segregated::solve(std::span<const double> b, std::span<double> u) {
  const auto start = std::chrono::steady_clock::now();
  SolveStatistics statistics;
  const double wanted = tolerance_ * norm(problem_.mesh.comm, b);
  accelerator_.restart();
  statistics.residual = find_residual(b, u);
  while (!(statistics.residual <= wanted)) {
    if (statistics.iterations == max_iterations_ || !std::isfinite(statistics.residual))
      throw SolveFailure(
          "The segregated method did not converge: {} outer iterations, residual {:.3e} of the right-hand "
          "side, {:.3e} "
          "wanted. Bending and large nu couple the components too much for it: 'solution-method: {{type: "
          "newton-krylov}}' "
          "needs no outer iterations.",
          statistics.iterations, statistics.residual / wanted * tolerance_, tolerance_);
    ++statistics.iterations;
    statistics.inner_iterations += find_step();
    accelerator_.advance(u, step_);
    statistics.residual = find_residual(b, u);
  }
  statistics.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return statistics;
}

}  // namespace couplet
