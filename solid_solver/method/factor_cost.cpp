// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/method/factor_cost.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/parallel/collective.hpp"
#include "solid_solver/method/newton_krylov.hpp"

namespace couplet::solid {
namespace {

// All measured by benchmarks/linalg/factors.py. Libraries of the factors [s], an entry of them read and multiplied twice [s].
constexpr double loading = 0.1, entry_time = 4e-9;
// Entries a block of rows: two or three rows with as many columns, CHOLMOD's of the nodes and MUMPS's with the vertices.
constexpr double plane_entries = 25, space_entries = 75;
// Set-up over a solve: analysis and elimination.
constexpr double plane_set_up = 70, space_set_up = 120;
// A term of a face in a product and a cycle of multigrid [s], iterations of a motion, whose guesses are good.
constexpr double term_time = 11e-9, iterations = 30, iterations_of_simplices = 100;
// The lighter the stiffness beside the inertia, the fewer: 21, 14, 8 for a heaviness of 1, 10, 100.
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
    // Each vertex with its multiplier.
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
