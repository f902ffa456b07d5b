// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/method/solution_method.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/method/conjugate_gradients.hpp"

namespace couplet::solid {

linalg::SolveStatistics SolutionMethod::solve(std::span<const double> b, std::span<double> u) {
  if (instead_) return instead_->find(b, u);
  if (!cure_) return find(b, u);
  const std::vector<double> guess(u.begin(), u.end());
  try {
    return find(b, u);
  } catch (const SolveFailure& failure) {
    if (!cure(b)) throw;
    log::info(
        "{} From now on it is solved with factors of the matrix; 'preconditioner: factors' skips this attempt.",
        failure.what());
    std::ranges::copy(guess, u.begin());
    return instead_->find(b, u);
  }
}

bool SolutionMethod::cure(std::span<const double> b) {
  if (cure_ && !instead_) instead_ = cure_(b);
  if (instead_) projection_.reset();
  return is_cured();
}

void SolidProblem::apply(std::span<const double> x, std::span<double> y) const {
  if (is_symmetric()) {
    if (mass_factor > 0) return kernel.apply_with_mass(x, {}, mass_factor, true, y);
    return kernel.apply(x, {}, y);
  }
  kernel.apply(x, {}, y);
  const std::size_t dim = mesh.dim;
  for (std::size_t c = 0; c < inertia.size(); ++c)
    for (std::size_t a = 0; a < dim; ++a) y[c * dim + a] += inertia[c] * x[c * dim + a];
}

void SolidProblem::residual(std::span<const double> b, std::span<const double> u, std::span<double> r) const {
  apply(u, r);
  for (std::size_t i = 0; i < b.size(); ++i) r[i] = b[i] - r[i];
}

double norm(MPI_Comm comm, std::span<const double> values) {
  double square = 0;
  for (const double x : values) square += x * x;
  return std::sqrt(parallel::sum(comm, square));
}

namespace {

// Measured by benchmarks/linalg/factors.py. Loading of libraries [s]; reading an entry twice [s].
constexpr double loading = 0.1, entry_time = 4e-9;
// Entries per block of two or three rows and columns: CHOLMOD's of the nodes, MUMPS's including vertices.
constexpr double plane_entries = 25, space_entries = 75;
// Ratio of set-up to a solve: analysis and elimination.
constexpr double plane_set_up = 70, space_set_up = 120;
// Time of a face's term in a product and a multigrid cycle [s]; iterations, and those with good guesses.
constexpr double term_time = 11e-9, iterations = 30, iterations_of_simplices = 100;
// Exponent of the iterations in heaviness: 21, 14, 8 for 1, 10, 100.
constexpr double lightening = 0.25;

struct Counts {
  double cells, nodes, points, sides, terms;
};

Counts counts_of(const mesh::Mesh& mesh) {
  Counts n{double(mesh.cells.n_owned()), double(mesh.cells.n_owned()), 0, 0, 0};
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] >= mesh.cells.n_owned()) continue;
    const bool inner = f < mesh.n_interior;
    if (!inner) n.nodes += 1;
    n.sides += inner ? 2 : 1;
    n.terms += 2 + double(mesh.face_points[f].size());
  }
  for (double* value : {&n.cells, &n.nodes, &n.sides, &n.terms}) *value = parallel::sum(mesh.comm, *value);
  n.points = double(mesh.points.n_global());
  return n;
}

}  // namespace

double FactorCost::pays_after() const {
  if (by_cycle <= solve) return std::numeric_limits<double>::infinity();
  return set_up / (by_cycle - solve);
}

FactorCost factor_cost(const mesh::Mesh& mesh, const mesh::Geometry& geometry, double heaviness) {
  const Counts n = counts_of(mesh);
  const double length = std::max(1.0, slenderness(mesh, geometry) / 2);
  FactorCost cost{};
  double set_up = plane_set_up;
  if (mesh.dim == 2) {
    cost.entries = plane_entries * n.cells * std::max(1.0, std::log2(n.cells / length));
  } else {
    // Each vertex includes its multiplier.
    const double rows = n.nodes + 2 * n.points;
    cost.entries = space_entries * rows * std::max(std::cbrt(rows / length), std::log2(rows) / 2);
    set_up = space_set_up;
  }
  cost.solve = entry_time * cost.entries;
  cost.set_up = loading + set_up * cost.solve;
  const bool simplices = n.sides / n.cells < mesh.dim + 1.5;
  cost.by_cycle = (simplices ? iterations_of_simplices : iterations) * term_time * n.terms /
                  std::pow(1 + heaviness, lightening);
  return cost;
}

}  // namespace couplet::solid
