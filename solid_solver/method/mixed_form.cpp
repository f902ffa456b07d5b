// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/method/mixed_form.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/base/error.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/method/newton_krylov.hpp"

namespace couplet::solid {
namespace {

// What the rows of volumes may leave of forces in K u = b, over b: errors of the mean stress are as large.
constexpr double finest_forces_left = 1e-6;
// By so much more, and the answer is none.
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
  options.scheme = elastic::FaceGradientScheme::symmetric;
  options.node_inertia = inertia;
  options.without_cells_bulk = true;
  multigrid_ = std::make_unique<elastic::ElasticPreconditioner>(problem.mesh, problem.elastic,
                                                                problem.inertia, options);
  find_scales();
  krylov_ = std::make_unique<linalg::KrylovSolver>(
      "displacement and mean stress", problem.mesh.comm, n_u_ + n_p_,
      [this](std::span<const double> x, std::span<double> y) { apply(x, y); },
      [this](std::span<const double> r, std::span<double> z) { precondition(r, z); });
  name_ = "newton-krylov (mixed form: mean stresses of the cells as additional unknowns)";
}

/// mu / h, by which both kinds of unknowns and rows are of one size; larger where the tolerance leaves so much of the
/// volumes that K_P / mu of it would be forces.
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

/// K_P theta of the guess, unless it leaves more of b than none: errors of its volumes count K_P / mu times there.
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

linalg::SolveStatistics MixedForm::solve(std::span<const double> b, std::span<double> u) {
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
        "{} Is the solid held everywhere, is nu below 0.5, are the cells well shaped? If so, try "
        "'solution-method: {{preconditioner: factors}}', the most robust option, at the highest memory cost.",
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
