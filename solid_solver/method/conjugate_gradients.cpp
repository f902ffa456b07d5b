// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/method/conjugate_gradients.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/elasticity/symmetric/symmetric_matrix.hpp"
#include "common/log/progress.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {
namespace {

// Maximum aggregates of the coarse space of rigid motions: more hardly help, and their factors grow.
constexpr int most_aggregates = 200;
// Cells per aggregate for its rigid motions to be smooth on the scale of cells, and the fewest ones.
constexpr GlobalIndex cells_of_aggregate = 32;
constexpr int fewest_aggregates = 8;
constexpr GlobalIndex fewest_cells = 4;
// Length over thickness 2 V/S above which bending needs the coarse space; a cube has 3.
constexpr double slender = 12;
// Slenderness without which it takes this many cells, too.
constexpr double very_slender = 60;
constexpr GlobalIndex many_cells = 4000;
// Inertia over the stiffness of a cell's faces above which no motion is slow.
constexpr double heavy = 0.03;
// Smallest relative residual attainable in double precision.
constexpr double finest_tolerance = 1e-15;
// For time steps with factors, which take one or two iterations; saves one product in three.
constexpr int steps_carried = 3;

}  // namespace

double slenderness(const mesh::Mesh& mesh, const mesh::Geometry& geometry) {
  double volume = 0, surface = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) volume += geometry.volume[c];
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f) surface += geometry.face_area[f].norm();
  double longest = 0;
  for (int a = 0; a < mesh.dim; ++a) {
    double lower = 1e300, upper = -1e300;
    for (const Vec3& x : geometry.points) {
      lower = std::min(lower, x[a]);
      upper = std::max(upper, x[a]);
    }
    longest = std::max(longest, parallel::max(mesh.comm, upper) - parallel::min(mesh.comm, lower));
  }
  return longest * parallel::sum(mesh.comm, surface) / (2 * parallel::sum(mesh.comm, volume));
}

double heaviness(const SolidProblem& problem) {
  const mesh::Geometry& geometry = problem.geometry();
  if (problem.is_static()) return 0;
  const mesh::Mesh& mesh = problem.mesh;
  double inertia = 0, stiffness = 0;
  for (const double m : problem.inertia) inertia += m;
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const elastic::LameConstants lame = problem.elastic.lame(mesh.owner[f]);
    const fv::FaceLine line = fv::face_line(mesh, geometry, f);
    stiffness += 2 * (2 * lame.mu + lame.lambda) * line.area * line.inverse_dn;
  }
  return parallel::sum(mesh.comm, inertia) / parallel::sum(mesh.comm, stiffness);
}

std::vector<double> node_inertia(const SolidProblem& problem) {
  if (problem.mass_factor == 0) return {};
  const std::size_t n = problem.elastic.n_unknowns(), dim = problem.mesh.dim;
  std::vector<double> ones(n, 1), row(n), result(n / dim, 0);
  problem.kernel.apply_with_mass(ones, {}, problem.mass_factor, false, row);
  for (std::size_t i = 0; i < n; ++i) result[i / dim] = std::max(result[i / dim], row[i]);
  return result;
}

elastic::DeformedBody at_rest(const mesh::Mesh& mesh) {
  elastic::DeformedBody body;
  body.gradient.assign(std::size_t(mesh.n_flux_faces()), Tensor3::Identity());
  body.displacement.assign(std::size_t(mesh.cells.n_local()) + std::size_t(mesh.boundary.n_local()),
                           Vec3::Zero());
  return body;
}

ConjugateGradients::ConjugateGradients(const SolidProblem& problem, const MethodParameters& parameters)
    : problem_(problem), options_{parameters.relative_tolerance, parameters.max_iterations, true} {
  using Preconditioner = MethodParameters::Preconditioner;
  // In a small step the right-hand side is mostly inertia, rho V u 4/dt^2, and its residual would act as a force. The energy of free
  // vibration drifted by 4e-3 in 1e5 steps at an elastic Courant number of 0.01. The tolerance therefore refers to the elastic part.
  options_.relative_tolerance =
      std::max(finest_tolerance, options_.relative_tolerance / std::max(1., heaviness(problem)));
  if (!problem.is_static()) options_.carried = steps_carried;
  if (parameters.preconditioner == Preconditioner::factors)
    choose_factors();
  else
    choose_multigrid();
  const std::size_t n = problem.elastic.n_unknowns();
  const linalg::LinearMap apply = [this](std::span<const double> x, std::span<double> y) {
    const log::ScopedTimer timer(log::timers(), "solid: products");
    problem_.apply(x, y);
    project(y);
  };
  krylov_ = std::make_unique<linalg::KrylovSolver>(
      "displacement", problem.mesh.comm, n, apply,
      [this](std::span<const double> r, std::span<double> z) { invert(r, z); });
  if (multigrid_ && !problem.is_static() && parameters.corrections_kept > 0)
    projection_ =
        std::make_unique<linalg::ResidualProjection>(problem.mesh.comm, parameters.corrections_kept);
}

bool ConjugateGradients::invert(std::span<const double> r, std::span<double> z) {
  if (multigrid_)
    multigrid_->apply(r, z);
  else if (tied_)
    tied_->solve(r, z);
  else
    factors_->solve(r, z);
  if (modes_) modes_->add_correction(r, z);
  project(z);
  return !problem_.project;
}

void ConjugateGradients::choose_multigrid() {
  const mesh::Mesh& mesh = problem_.mesh;
  const std::vector<double> of_nodes = node_inertia(problem_);
  elastic::ElasticPreconditioner::Options options;
  options.node_inertia = of_nodes;
  multigrid_ = std::make_unique<elastic::ElasticPreconditioner>(mesh, problem_.elastic, options);
  if (heaviness(problem_) <= heavy) add_rigid_motions(of_nodes);
  name_ = fmt::format(
      "newton-krylov (conjugate gradients, multigrid{})",
      modes_ ? fmt::format(" and rigid-body modes of {} aggregates", modes_->n_aggregates()) : "");
}

/// Bending of a slender body varies too slowly for component-wise multigrid. A beam 10:1 of 80x8x8 cells
/// takes 53 iterations instead of 143, one of 160x16x16 89 instead of 169, one 100:1 of 400x4x4 cubes 515
/// instead of 1945 (to 1e-10). A plate of 4600 cells saves 6 of 46 iterations; 295 000 take 71, not 49.
void ConjugateGradients::add_rigid_motions(const std::vector<double>& inertia) {
  const mesh::Mesh& mesh = problem_.mesh;
  const double length = slenderness(mesh, problem_.geometry());
  if (!(length > very_slender || (length > slender && mesh.cells.n_global() > many_cells))) return;
  // Half as long as thick, if the cells are fine enough.
  const GlobalIndex cells = mesh.cells.n_global();
  const GlobalIndex aggregates = std::min<GlobalIndex>(
      most_aggregates,
      std::max(cells / cells_of_aggregate, std::min(static_cast<GlobalIndex>(length), cells / fewest_cells)));
  if (aggregates < fewest_aggregates) return;
  modes_ = std::make_unique<elastic::CurrentRigidModes>(mesh, problem_.elastic, static_cast<int>(aggregates),
                                                        inertia);
  modes_->update(at_rest(mesh));
}

void ConjugateGradients::choose_factors() {
  std::vector<double> inertia(problem_.inertia.begin(), problem_.inertia.end());  // of a unit of volume
  for (std::size_t c = 0; c < inertia.size(); ++c) inertia[c] /= problem_.geometry().volume[Index(c)];
  if (problem_.mesh.dim == 3 && elastic::TiedMatrix::suits(problem_.mesh)) {
    elastic::EnergyParts parts;
    if (!inertia.empty()) parts.mass = 1, parts.density = inertia;
    tied_ = std::make_unique<elastic::TiedMatrix>(problem_.mesh, problem_.elastic, parts);
    tied_->factorise();
    name_ = "newton-krylov (conjugate gradients, factors with the vertices)";
    return;
  }
  matrix_ = std::make_unique<linalg::SparseMatrix>(
      elastic::symmetric_matrix(problem_.mesh, problem_.elastic, inertia));
  linalg::LinearOptions of_factors;
  of_factors.as_preconditioner = true;
  of_factors.method =
      problem_.mesh.dim == 2 ? linalg::LinearMethod::direct_planar : linalg::LinearMethod::direct_symmetric;
  factors_ = std::make_unique<linalg::LinearSolver>("displacement", *matrix_, of_factors);
  name_ = "newton-krylov (conjugate gradients, Cholesky factors)";
}

void ConjugateGradients::project(std::span<double> unknowns) const {
  if (problem_.project) problem_.project(unknowns);
}

linalg::SolveStatistics ConjugateGradients::find(std::span<const double> b, std::span<double> u) {
  try {
    std::vector<double> rows;
    if (problem_.project) {
      rows.assign(b.begin(), b.end());
      project(rows);
      project(u);
      b = rows;
    }
    const linalg::SolveStatistics statistics = krylov_->solve(b, u, options_, projection_.get());
    if (problem_.inertia.empty()) krylov_->forget_vectors();  // static: what is written next needs room
    return statistics;
  } catch (const SolveFailure& e) {
    throw SolveFailure(
        "{} Is the solid fully supported, is nu below 0.5, and are the cells well shaped?{}", e.what(),
        multigrid_
            ? " If loads and supports are correct, try 'solution-method: {preconditioner: factors}', the most "
              "robust option, at the highest memory cost."
            : "");
  }
}

}  // namespace couplet::solid
