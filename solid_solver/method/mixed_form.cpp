// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/method/mixed_form.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/method/conjugate_gradients.hpp"

namespace couplet::solid {

namespace {

// Empirical scales of the elastic part (2-D: Cook's membrane, 8 to 64 cells per side; 3-D: elliptic plate; nu 1/3 to 0.4999).
constexpr double elastic_of_gradients(int dim) { return dim == 2 ? 1.5 : 1; }
constexpr double elastic_of_faces(int dim) { return dim == 2 ? 3 : 2; }
// Weight of p relative to its gradient times the cell size, squared; constants have no gradient.
constexpr double of_values = 0.01;
// Factor for free faces, where p does more work than between cells.
constexpr double free_face = 2;
// Tolerance of CG with multigrid in 3-D, where factors fill quickly (37 000 hexahedra: 545 MB). It costs a fifth more outer iterations.
constexpr double close_enough = 0.01;
// Inertia over mu V/h^2 from which a step counts as short.
constexpr double inertia_rules = 0.1;

double size_squared(double volume, int dim) { return std::pow(volume, 2.0 / dim); }

/// True if all cells have one face more than dimensions.
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
  // Scaled to a mean cell volume of one, because PETSc detects zero pivots by their size.
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
    // A rank must not leave the others: a bad value only gives a worse preconditioner.
    for (double& p : z)
      if (!std::isfinite(p)) p = 0;
  }
  for (double& p : z) p *= unit_;
}

namespace {

// Forces from volume residuals allowed in K u = b, relative to b; errors of the mean stress are as large.
constexpr double finest_forces_left = 1e-6;
// Factor above that at which the solution is rejected.
constexpr double too_much = 100;

}  // namespace

MixedForm::MixedForm(const SolidProblem& problem, const MethodParameters& parameters)
    : problem_(problem),
      options_{parameters.relative_tolerance, parameters.max_iterations, false, true},
      forces_left_(std::max(parameters.relative_tolerance, finest_forces_left)),
      n_u_(problem.elastic.n_unknowns()),
      n_p_(std::size_t(problem.mesh.cells.n_owned())),
      schur_(problem),
      with_pressures_(n_u_ + n_p_),
      forces_(n_u_ + n_p_) {
  const std::vector<double> inertia = node_inertia(problem);
  elastic::ElasticPreconditioner::Options options;
  options.node_inertia = inertia;
  options.without_cells_bulk = true;
  multigrid_ = std::make_unique<elastic::ElasticPreconditioner>(problem.mesh, problem.elastic, options);
  find_scales();
  krylov_ = std::make_unique<linalg::KrylovSolver>(
      "displacement and mean stress", problem.mesh.comm, n_u_ + n_p_,
      [this](std::span<const double> x, std::span<double> y) { apply(x, y); },
      [this](std::span<const double> r, std::span<double> z) { precondition(r, z); });
  name_ = "newton-krylov (mixed form: mean stresses of the cells as additional unknowns)";
}

/// Scale mu/h, which makes both kinds of unknowns and rows similar. It is larger if the tolerance leaves
/// volume residuals that K_P/mu would turn into forces.
void MixedForm::find_scales() {
  const std::vector<double> volume = elastic::pyramid_volumes(problem_.mesh, problem_.geometry());
  for (std::size_t c = 0; c < n_p_; ++c) {
    const elastic::LameConstants lame = problem_.elastic.lame(Index(c));
    const double bulk = elastic::bulk_of_cells(lame, problem_.elastic.volume_strain());
    const double weight = std::max(1., bulk / lame.mu * options_.relative_tolerance / forces_left_);
    scale_.push_back(weight * lame.mu / std::pow(volume[c], 1.0 / problem_.mesh.dim));
    stiffness_.push_back(bulk / volume[c]);
  }
}

void MixedForm::apply(std::span<const double> x, std::span<double> y) {
  std::copy_n(x.begin(), n_u_, with_pressures_.begin());
  for (std::size_t c = 0; c < n_p_; ++c) with_pressures_[n_u_ + c] = scale_[c] * x[n_u_ + c];
  const std::span<const double> both(with_pressures_);
  problem_.kernel.apply_mixed(both.first(n_u_), both.subspan(n_u_), problem_.mass_factor, y.first(n_u_),
                              y.subspan(n_u_));
  for (std::size_t c = 0; c < n_p_; ++c) y[n_u_ + c] *= scale_[c];
}

/// z_p = -S^-1 r_p, z_u = M^-1 (r_u - B^T z_p).
void MixedForm::precondition(std::span<const double> r, std::span<double> z) {
  const std::span<double> left = z.subspan(n_u_);
  std::fill_n(with_pressures_.begin(), n_u_, 0.0);
  const std::span<double> p = std::span(with_pressures_).subspan(n_u_);
  for (std::size_t c = 0; c < n_p_; ++c) left[c] = -r[n_u_ + c] / scale_[c];
  schur_.apply(left, p);
  const std::span<double> force = std::span(forces_).first(n_u_);
  problem_.kernel.apply_mixed(std::span<const double>(with_pressures_).first(n_u_), p, 0, force,
                              std::span(forces_).subspan(n_u_));
  for (std::size_t i = 0; i < n_u_; ++i) force[i] = r[i] - force[i];
  multigrid_->apply(force, z.first(n_u_));
  for (std::size_t c = 0; c < n_p_; ++c) left[c] = p[c] / scale_[c];
}

/// Initial p: K_P theta of the guess, unless volume errors, scaled by K_P/mu, increase the residual.
void MixedForm::add_pressures(std::span<const double> b, std::span<double> x) {
  std::vector<double> of_none(x.size()), of_volumes(x.size());
  std::fill(x.begin() + std::ptrdiff_t(n_u_), x.end(), 0.0);
  const auto remainder = [&](std::span<double> r) {
    apply(x, r);
    for (std::size_t i = 0; i < n_u_; ++i) r[i] = b[i] - r[i];
    return norm(problem_.mesh.comm, r);
  };
  const double without = remainder(of_none);
  for (std::size_t c = 0; c < n_p_; ++c) {
    const double volume = of_none[n_u_ + c] / scale_[c];  // B u
    x[n_u_ + c] = stiffness_[c] * volume / scale_[c];
  }
  if (!(remainder(of_volumes) < without)) std::fill(x.begin() + std::ptrdiff_t(n_u_), x.end(), 0.0);
}

linalg::SolveStatistics MixedForm::find(std::span<const double> b, std::span<double> u) {
  const auto start = std::chrono::steady_clock::now();
  std::vector<double> x(n_u_ + n_p_, 0), right(x.size(), 0);
  std::ranges::copy(u, x.begin());
  std::ranges::copy(b, right.begin());
  add_pressures(b, x);
  linalg::SolveStatistics statistics;
  try {
    statistics = krylov_->solve(right, x, options_);
  } catch (const SolveFailure& e) {
    throw SolveFailure(
        "{} Is the solid fully supported, is nu below 0.5, and are the cells well shaped? If so, try 'solution-method: "
        "{{preconditioner: factors}}', the most robust option, at the highest memory cost.",
        e.what());
  }
  if (problem_.is_static()) krylov_->forget_vectors();  // what is written next needs room
  std::copy_n(x.begin(), n_u_, u.begin());
  const std::span<double> left = std::span(right).first(n_u_);
  problem_.residual(b, u, left);
  const double size = norm(problem_.mesh.comm, b), forces = norm(problem_.mesh.comm, left);
  if (!(forces <= too_much * forces_left_ * size))
    throw SolveFailure(
        "The mixed form leaves a residual of {:.1e} of the load in the momentum balance alone (tolerance "
        "{:.0e}): nu is too close to 0.5 for double precision, or the cells are badly shaped.",
        forces / size, forces_left_);
  statistics.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return statistics;
}

}  // namespace couplet::solid
