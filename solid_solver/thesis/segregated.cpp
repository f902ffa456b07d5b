// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/thesis/segregated.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/base/error.hpp"

namespace couplet::solid {

namespace {

// Reduction of a component's residual in one outer iteration, as in [thesis].
constexpr double inner_tolerance = 1e-2;

double stiffness(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, Index f) {
  const mesh::Geometry& geometry = rows.geometry();
  const elastic::LameConstants lame = rows.lame(mesh.owner[f]);
  const fv::FaceLine line = fv::face_line(mesh, geometry, f);
  return (2 * lame.mu + lame.lambda) * line.area * line.inverse_dn;
}

/// Contribution of a boundary face to the diagonal of its cell.
double boundary_diagonal(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, Index f,
                         int component) {
  const mesh::Geometry& geometry = rows.geometry();
  const double k = stiffness(mesh, rows, f);
  const elastic::BoundaryRow& row = rows.at(f);
  if (row.shared) {
    const double other = stiffness(mesh, rows, mesh.n_interior + mesh.twin[f - mesh.n_interior]);
    return k * other / (k + other);
  }
  const double known = row.known(component, component);
  const double spring = geometry.face_area[f].norm() * row.spring(component, component);
  return k * (known + (1 - known) * spring / (k + spring));
}

constexpr int aitken_interval = 5, anderson_history = 30;  // iterations

}  // namespace

linalg::Acceleration acceleration_of(const MethodParameters& parameters) {
  using Choice = MethodParameters::Acceleration;
  const Choice choice = parameters.acceleration;
  return {choice == Choice::none     ? linalg::Acceleration::Type::none
          : choice == Choice::aitken ? linalg::Acceleration::Type::aitken
                                     : linalg::Acceleration::Type::anderson,
          aitken_interval, anderson_history};
}

std::string segregated_name(const MethodParameters& parameters) {
  using Choice = MethodParameters::Acceleration;
  if (parameters.acceleration == Choice::none) return "segregated";
  if (parameters.acceleration == Choice::aitken)
    return fmt::format("segregated (Aitken every {} iterations)", aitken_interval);
  return fmt::format("segregated (Anderson over {} iterations)", anderson_history);
}

ScalarSystems::ScalarSystems(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                             std::span<const double> inertia)
    : mesh_(mesh), rows_(rows), b_(mesh.cells.n_owned()), u_(mesh.cells.n_owned()) {
  const mesh::Geometry& geometry = rows.geometry();
  for (int c = 0; c < mesh.dim; ++c) assemble(c, inertia);
  for (const Index f : rows.unknown_faces()) {
    double own = stiffness(mesh, rows, f);
    if (rows.at(f).shared) own += stiffness(mesh, rows, mesh.n_interior + mesh.twin[f - mesh.n_interior]);
    own += geometry.face_area[f].norm() * rows.at(f).spring.trace();
    own_.push_back(own);
  }
}

void ScalarSystems::assemble(int component, std::span<const double> inertia) {
  const Index n = mesh_.cells.n_owned();
  std::vector<GlobalIndex> row, column;
  std::vector<double> value, diagonal(n, 0);
  const auto couple = [&](Index a, Index b, double k) {
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
      if (from >= n) continue;
      row.push_back(mesh_.cells.global(from));
      column.push_back(mesh_.cells.global(to));
      value.push_back(-k);
      diagonal[from] += k;
    }
  };
  for (Index f = 0; f < mesh_.n_interior; ++f)
    couple(mesh_.owner[f], mesh_.neighbour[f], stiffness(mesh_, rows_, f));
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f)
    diagonal[mesh_.owner[f]] += boundary_diagonal(mesh_, rows_, f, component);
  for (Index c = 0; c < n; ++c) {
    if (!inertia.empty()) diagonal[c] += inertia[c];
    row.push_back(mesh_.cells.global(c));
    column.push_back(mesh_.cells.global(c));
    value.push_back(diagonal[c]);
  }
  Component here;
  here.matrix = std::make_unique<linalg::SparseMatrix>(mesh_.comm, n, std::move(row), std::move(column));
  here.matrix->fill(value);
  linalg::LinearOptions options;
  options.method = linalg::LinearMethod::cg_icc;
  options.relative_tolerance = inner_tolerance;
  here.solver = std::make_unique<linalg::LinearSolver>("a displacement component", *here.matrix, options);
  components_.push_back(std::move(here));
}

int ScalarSystems::find_step(std::span<const double> residual, std::span<double> step) {
  int inner = 0;
  const std::size_t n = mesh_.cells.n_owned(), dim = mesh_.dim;
  for (std::size_t a = 0; a < dim; ++a) {
    for (std::size_t c = 0; c < n; ++c) b_[c] = residual[c * dim + a];
    std::fill(u_.begin(), u_.end(), 0.0);
    inner += components_[a].solver->solve(b_, u_).iterations;
    for (std::size_t c = 0; c < n; ++c) step[c * dim + a] = u_[c];
  }
  const auto& faces = rows_.unknown_faces();
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const elastic::BoundaryRow& row = rows_.at(faces[i]);
    for (std::size_t a = 0; a < dim; ++a) {
      const double cell = step[std::size_t(mesh_.owner[faces[i]]) * dim + a];
      const double follows = 1 - row.known(Index(a), Index(a));
      step[(n + i) * dim + a] = follows * cell + residual[(n + i) * dim + a] / own_[i];
    }
  }
  return inner;
}

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

linalg::SolveStatistics Segregated::find(std::span<const double> b, std::span<double> u) {
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
          "'solution-method: {{type: newton-krylov, face-gradient: symmetric}}', which needs no outer iterations.",
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
