// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/method/pressure_schur.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"

namespace couplet::solid {
namespace {

// Scales of the elastic part by numerical experiment (in the plane Cook's membrane 8 to 64 a side, in space the elliptic
// plate; nu 1/3 to 0.4999).
constexpr double elastic_of_gradients(int dim) { return dim == 2 ? 1.5 : 1; }
constexpr double elastic_of_faces(int dim) { return dim == 2 ? 3 : 2; }
// Of p of a cell beside its gradient times the cell's size, squared: constants have none.
constexpr double of_values = 0.01;
// Faces that may move give p more to do than those between cells.
constexpr double free_face = 2;
// In space factors fill quickly (37 000 hexahedra: 545 MB); conjugate gradients with multigrid to this tolerance
// cost a fifth more iterations outside.
constexpr double close_enough = 0.01;
// Inertia over mu V / h^2 from which steps are short.
constexpr double inertia_rules = 0.1;

double size_squared(double volume, int dim) { return std::pow(volume, 2.0 / dim); }

/// Cells with one face more than dimensions.
bool are_simplices(const mesh::Mesh& mesh) {
  std::vector<int> faces(mesh.cells.n_owned(), 0);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] < mesh.cells.n_owned()) ++faces[mesh.owner[f]];
    if (f < mesh.n_interior && mesh.neighbour[f] < mesh.cells.n_owned()) ++faces[mesh.neighbour[f]];
  }
  return 2 * std::ranges::count(faces, mesh.dim + 1) > std::ptrdiff_t(faces.size());
}

}  // namespace

/// Triplets of a matrix between this rank's cells.
class PressureSchur::Rows {
 public:
  void add(Index i, Index j, double value) {
    row_.push_back(i);
    column_.push_back(j);
    value_.push_back(value);
  }
  std::unique_ptr<linalg::SparseMatrix> matrix(Index n) {
    auto result =
        std::make_unique<linalg::SparseMatrix>(MPI_COMM_SELF, n, std::move(row_), std::move(column_));
    result->fill(value_);
    return result;
  }

 private:
  std::vector<GlobalIndex> row_, column_;
  std::vector<double> value_;
};

PressureSchur::PressureSchur(const SolidProblem& problem) {
  const mesh::Geometry& geometry = problem.geometry();
  const mesh::Mesh& mesh = problem.mesh;
  const Index n = mesh.cells.n_owned();
  if (n == 0) return;
  const std::vector<double> volume = elastic::pyramid_volumes(mesh, geometry);
  unit_ = problem.elastic.lame(0).mu;
  double inertia = 0, stiffness = 0;
  for (Index c = 0; c < n; ++c) {
    inertia += problem.inertia.empty() ? 0 : problem.inertia[c];
    stiffness += problem.elastic.lame(c).mu * volume[c] / size_squared(volume[c], mesh.dim);
  }
  if (are_simplices(mesh) && inertia < inertia_rules * stiffness)
    by_faces(problem, volume);
  else
    by_gradients(problem, volume);
  linalg::LinearOptions options;
  options.method = mesh.dim == 2 ? linalg::LinearMethod::direct_planar : linalg::LinearMethod::cg_multigrid;
  options.relative_tolerance = close_enough;
  solver_ = std::make_unique<linalg::LinearSolver>("pressure", *matrix_, options);
}

void PressureSchur::by_gradients(const SolidProblem& problem, std::span<const double> volume) {
  const mesh::Geometry& geometry = problem.geometry();
  const mesh::Mesh& mesh = problem.mesh;
  const elastic::ElasticOperator& rows = problem.elastic;
  const Index n = mesh.cells.n_owned();
  const auto bulk = [&](Index c) { return elastic::bulk_of_cells(rows.lame(c), rows.volume_strain()); };
  Rows before, wide;
  std::vector<std::vector<std::pair<Index, Vec3>>> gradient(n);  // V grad p of a cell
  for (Index c = 0; c < n; ++c) {
    const double value = of_values * volume[c] / size_squared(volume[c], mesh.dim);
    const double here = elastic_of_gradients(mesh.dim) * rows.lame(c).mu / unit_ * value +
                        (problem.inertia.empty() ? 0 : problem.inertia[c] / unit_);
    before.add(c, c, here);
    wide.add(c, c, value + here * unit_ / bulk(c));
    inverse_volume_.push_back(1 / volume[c]);
  }
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const Index p = mesh.owner[f], q = f < mesh.n_interior ? mesh.neighbour[f] : n;
    const Vec3& area = geometry.face_area[f];
    const fv::FaceLine line = fv::face_line(mesh, geometry, f);
    const double k = line.area * line.inverse_dn;
    const double elastic = elastic_of_gradients(mesh.dim) * elastic::face_lame(mesh, rows, f).mu / unit_ * k;
    if (p < n && q < n) {
      const auto [here, there] = elastic::pyramids(mesh, geometry, f);
      const double a = here / (here + there), softness = 2 * unit_ / (bulk(p) + bulk(q));
      gradient[p].insert(gradient[p].end(), {{p, a * area}, {q, (1 - a) * area}});
      gradient[q].insert(gradient[q].end(), {{p, -a * area}, {q, (a - 1) * area}});
      for (const auto& [i, j, sign] : {std::tuple{p, p, 1}, {q, q, 1}, {p, q, -1}, {q, p, -1}}) {
        before.add(i, j, sign * elastic);
        wide.add(i, j, sign * elastic * softness);
      }
      continue;
    }
    if (p < n) gradient[p].push_back({p, area});
    if (q < n) gradient[q].push_back({q, -area});
    if (f < mesh.n_interior || p >= n || !rows.at(f).is_free()) continue;
    before.add(p, p, elastic);
    wide.add(p, p, k + elastic * unit_ / bulk(p));
  }
  for (Index c = 0; c < n; ++c)
    for (const auto& [i, x] : gradient[c])
      for (const auto& [j, y] : gradient[c]) wide.add(i, j, x.dot(y) / volume[c]);
  before_ = before.matrix(n);
  matrix_ = wide.matrix(n);
  between_.resize(2 * std::size_t(n));
}

void PressureSchur::by_faces(const SolidProblem& problem, std::span<const double> volume) {
  const mesh::Geometry& geometry = problem.geometry();
  const mesh::Mesh& mesh = problem.mesh;
  const elastic::ElasticOperator& rows = problem.elastic;
  const Index n = mesh.cells.n_owned();
  // Of one volume a cell on average: PETSc takes pivots to be zero by their size.
  double mean = 0;
  for (const double v : volume) mean += v / double(n);
  Rows faces;
  for (Index c = 0; c < n; ++c)
    faces.add(c, c, volume[c] / mean * unit_ / elastic::bulk_of_cells(rows.lame(c), rows.volume_strain()));
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const Index p = mesh.owner[f], q = f < mesh.n_interior ? mesh.neighbour[f] : n;
    const auto [here, there] = elastic::pyramids(mesh, geometry, f);
    const double whole = here + there;
    double weight =
        whole / mean * unit_ / (elastic_of_faces(mesh.dim) * elastic::face_lame(mesh, rows, f).mu);
    if (f >= mesh.n_interior && rows.at(f).is_free()) weight *= free_face;
    const std::array<std::pair<Index, double>, 2> sides{{{p, here / whole}, {q, there / whole}}};
    for (const auto& [i, a] : sides)
      for (const auto& [j, b] : sides)
        if (i < n && j < n) faces.add(i, j, weight * a * b);
  }
  unit_ /= mean;
  matrix_ = faces.matrix(n);
}

void PressureSchur::apply(std::span<const double> r, std::span<double> z) {
  if (!solver_) return;
  const std::size_t n = r.size();
  std::ranges::fill(z, 0.0);
  std::span<const double> right = r;
  if (before_) {
    const std::span<double> scaled = std::span(between_).first(n), smooth = std::span(between_).subspan(n);
    for (std::size_t c = 0; c < n; ++c) scaled[c] = inverse_volume_[c] * r[c];
    before_->multiply(scaled, smooth);
    right = smooth;
  }
  try {
    solver_->solve(right, z);
  } catch (const SolveFailure&) {
    // One rank alone must not leave the others: what it has found is a worse preconditioner, no wrong answer.
    for (double& p : z)
      if (!std::isfinite(p)) p = 0;
  }
  for (double& p : z) p *= unit_;
}

}  // namespace couplet::solid
