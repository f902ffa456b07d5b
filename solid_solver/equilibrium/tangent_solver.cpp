// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/equilibrium/tangent_solver.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {

namespace {

// Minimum cells for rigid motions of aggregates to help, cells per aggregate, and maximum aggregates.
constexpr GlobalIndex small_body = 64, cells_of_tangent_aggregate = 32;
constexpr GlobalIndex most_tangent_aggregates = 160;
// New factors cost as much as dozens of iterations, but are required if the tangent has changed much.
constexpr int most_with_old_factors = 12, most_before_new_factors = 60;

// Factors require about 50 kB per cell in 3-D.
constexpr GlobalIndex most_to_factor = 20000;

/// Rotation of F = R U by Higham's iteration; I if F is inverted.
Tensor3 rotation_of(const Tensor3& f) {
  if (!(f.determinant() > 1e-6)) return Tensor3::Identity();
  Tensor3 r = f;
  for (int i = 0; i < 20; ++i) {
    const Tensor3 next = 0.5 * (r + r.inverse().transpose());
    const bool done = (next - r).squaredNorm() < 1e-24;
    r = next;
    if (done) break;
  }
  return r;
}

}  // namespace

TangentSolver::TangentSolver(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                             elastic::FiniteKernel& kernel, double mass_factor,
                             std::span<const double> node_inertia, By by)
    : mesh_(mesh),
      geometry_(rows.geometry()),
      rows_(rows),
      kernel_(kernel),
      mass_factor_(mass_factor),
      node_inertia_(node_inertia),
      by_(by) {
  const std::size_t n = rows.n_unknowns();
  if (by == By::frames) {
    elastic::ElasticPreconditioner::Options options;
    options.node_inertia = node_inertia;
    compact_ = std::make_unique<elastic::ElasticPreconditioner>(mesh, rows, options);
    const GlobalIndex cells = mesh.cells.n_global();
    if (cells >= small_body) {
      const GlobalIndex aggregates =
          std::clamp<GlobalIndex>(cells / cells_of_tangent_aggregate, 8, most_tangent_aggregates);
      modes_ = std::make_unique<elastic::CurrentRigidModes>(
          mesh, rows, static_cast<int>(aggregates),
          std::vector<double>(node_inertia.begin(), node_inertia.end()));
    }
    turned_.resize(n);
    correction_.resize(n);
  }
  krylov_ = std::make_unique<linalg::KrylovSolver>(
      "displacement", mesh.comm, n,
      [this](std::span<const double> x, std::span<double> y) {
        kernel_.apply_tangent(x, {}, mass_factor_, y);
        if (pressing_) pressing_->add_stiffness(x, y);
      },
      [this](std::span<const double> r, std::span<double> z) { precondition(r, z); });
}

/// Computes the rotation of each cell from the mean F of its faces. Boundary faces rotate with their cell, except supports.
void TangentSolver::find_frames(std::span<const Tensor3> gradient) {
  const Index n = mesh_.cells.n_owned();
  std::vector<Tensor3> mean(n, Tensor3::Zero());
  std::vector<double> weight(n, 0);
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    if (mesh_.owner[f] >= n) continue;  // another rank's, which knows its F
    const auto [here, there] = elastic::pyramids(mesh_, geometry_, f);
    mean[mesh_.owner[f]] += here * gradient[f];
    weight[mesh_.owner[f]] += here;
    if (f < mesh_.n_interior && mesh_.neighbour[f] < n) {
      mean[mesh_.neighbour[f]] += there * gradient[f];
      weight[mesh_.neighbour[f]] += there;
    }
  }
  frame_.clear();
  for (Index c = 0; c < n; ++c) frame_.push_back(rotation_of(mean[c] / weight[c]));
  for (const Index f : rows_.unknown_faces())
    frame_.push_back(rows_.at(f).is_free() ? frame_[mesh_.owner[f]] : Tensor3::Identity());
}

void TangentSolver::follow(bool with_modes) {
  is_unsymmetric_ = parallel::any(mesh_.comm, kernel_.has_pressure());
  if (by_ == By::factors) return make_factors();
  elastic::DeformedBody body;
  body.gradient.assign(mesh_.n_flux_faces(), Tensor3::Identity());
  kernel_.visit([&](Index f, const Tensor3& deformation, const Tensor3&) { body.gradient[f] = deformation; });
  find_frames(body.gradient);
  if (!modes_ || !with_modes) return;
  for (Index i = 0; i < mesh_.cells.n_local() + mesh_.boundary.n_local(); ++i)
    body.displacement.push_back(kernel_.displacement(i));
  modes_->update(body);
}

/// LU, because the tangent may be indefinite away from equilibrium or under follower pressure.
void TangentSolver::make_factors() {
  is_fresh_ = !(factors_ && iterations_ <= most_with_old_factors);
  if (!is_fresh_) return;
  linalg::LinearOptions options;
  options.method = linalg::LinearMethod::direct;
  factors_.reset();
  matrix_ =
      std::make_unique<linalg::SparseMatrix>(elastic::finite_matrix(mesh_, rows_, kernel_, node_inertia_));
  factors_ = std::make_unique<linalg::LinearSolver>("displacement", *matrix_, options);
}

void TangentSolver::turn(std::span<const double> from, bool back, std::span<double> to) const {
  const std::size_t dim = std::size_t(mesh_.dim);
  for (std::size_t i = 0; i < frame_.size(); ++i)
    for (std::size_t a = 0; a < dim; ++a) {
      double sum = 0;
      for (std::size_t b = 0; b < dim; ++b)
        sum += (back ? frame_[i](Index(b), Index(a)) : frame_[i](Index(a), Index(b))) * from[i * dim + b];
      to[i * dim + a] = sum;
    }
}

void TangentSolver::precondition(std::span<const double> r, std::span<double> z) {
  if (factors_) {
    factors_->solve(r, z);
    return;
  }
  turn(r, true, turned_);
  compact_->apply(turned_, correction_);
  turn(correction_, false, z);
  if (modes_) modes_->add_correction(r, z);
}

linalg::SolveStatistics TangentSolver::solve(std::span<const double> r, std::span<double> du,
                                             double relative_tolerance, int max_iterations) {
  std::ranges::fill(du, 0.0);
  linalg::KrylovOptions options{relative_tolerance, max_iterations, !is_unsymmetric_};
  if (factors_ && !is_fresh_) {
    // Uses factors of an earlier correction while they are cheap.
    linalg::KrylovOptions few = options;
    few.max_iterations = std::min(max_iterations, most_before_new_factors);
    try {
      return counted(r, du, few);
    } catch (const SolveFailure&) {
      factors_.reset();
      make_factors();
      std::ranges::fill(du, 0.0);
    }
  }
  try {
    return counted(r, du, options);
  } catch (const SolveFailure&) {
    if (!options.is_symmetric) throw;
    // The tangent may be indefinite away from equilibrium: uses a method that allows this.
    std::ranges::fill(du, 0.0);
    options.is_symmetric = false;
  }
  try {
    return counted(r, du, options);
  } catch (const SolveFailure&) {
    // A cycle for a positive operator may fail for negative eigenvalues: use factors of the tangent itself.
    if (factors_ || mesh_.cells.n_global() > most_to_factor) throw;
    return solve_by_own_factors(r, du, options);
  }
}

/// Uses factors of this tangent, which are discarded afterwards in any case.
linalg::SolveStatistics TangentSolver::solve_by_own_factors(std::span<const double> r, std::span<double> du,
                                                            const linalg::KrylovOptions& options) {
  const auto forget = [this] {
    factors_.reset();
    matrix_.reset();
  };
  std::ranges::fill(du, 0.0);
  try {
    make_factors();
    const linalg::SolveStatistics statistics = counted(r, du, options);
    forget();
    return statistics;
  } catch (...) {
    forget();
    throw;
  }
}

linalg::SolveStatistics TangentSolver::counted(std::span<const double> r, std::span<double> du,
                                               const linalg::KrylovOptions& options) {
  const linalg::SolveStatistics statistics = krylov_->solve(r, du, options);
  iterations_ = statistics.iterations;
  return statistics;
}

}  // namespace couplet::solid
