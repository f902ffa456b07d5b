// SPDX-License-Identifier: Apache-2.0
// The next equilibrium along the load path: Newton's method for (u, lambda), A(u) = lambda b, on the plane across the path's tangent at a
// distance from the last equilibrium (pseudo arc length [riks1979]). Each iteration solves K d = r and K v = b, and
// takes d + dlambda v with dlambda by the plane's equation, so that the whole is linearised consistently.
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/large_strain/finite_strain.hpp"
#include "solid_solver/method/newton_krylov.hpp"

namespace couplet::solid {
namespace {

constexpr int most_path_iterations = 15;
// As in plain load steps (finite_strain.cpp).
constexpr double path_growth = 30, path_first = 1e6, path_small = 1e-3, path_shortest = 1. / 64;
// Of the linear solves: near a limit point both solutions are large and nearly cancel.
constexpr double path_linear = 1e-8;

}  // namespace

/// Loads at a load factor, and where the search for the equilibrium stands.
struct FiniteStrain::PathSearch {
  const Load& whole;  // at load factor 1
  std::vector<double> rows, known, push, tangent, normal, start;
  double factor = 0, most = 0;
  Load load{};
  NewtonIterate now{};
};

/// The kernel's pressures and the rows at a load factor.
void FiniteStrain::scale_loads(PathSearch& path, double factor) {
  path.rows.assign(path.whole.rows.begin(), path.whole.rows.end());
  path.known.assign(path.whole.known.begin(), path.whole.known.end());
  for (double& v : path.rows) v *= factor;
  for (double& v : path.known) v *= factor;
  path.load = path.whole;
  path.load.rows = path.rows;
  path.load.known = path.known;
  path.load.before = {};
  if (!presses_) return;
  std::vector<double> pressure = whole_pressure_;
  for (double& p : pressure) p *= factor;
  kernel_->set_pressure(pressure);
}

/// d(lambda b - A)/d lambda at u, where the kernel is linearised afterwards. Prescribed displacements push by the tangent's columns.
void FiniteStrain::find_push(PathSearch& path, std::span<const double> u) {
  path.push.assign(path.whole.rows.begin(), path.whole.rows.end());
  if (presses_) {
    kernel_->set_pressure_fraction(0);
    std::vector<double> without(u.size()), with(u.size());
    kernel_->set_pressure(std::vector<double>(whole_pressure_.size(), 0));
    kernel_->linearise(u, path.known, 0, without);
    kernel_->set_pressure(whole_pressure_);
    kernel_->linearise(u, path.known, 0, with);
    for (std::size_t i = 0; i < u.size(); ++i) path.push[i] += without[i] - with[i];
    scale_loads(path, path.factor);
    kernel_->linearise(u, path.known, 0, with);
  }
  if (!parallel::any(mesh_.comm, !path.whole.known.empty())) return;
  const std::vector<double> still(u.size(), 0);
  std::vector<double> pulled(u.size());
  kernel_->apply_tangent(still, path.whole.known, 0, pulled);
  for (std::size_t i = 0; i < u.size(); ++i) path.push[i] -= pulled[i];
}

/// (u, lambda) + s (du, dlambda) with the largest s of 1, 1/2, ... that leaves det F positive and the residual below `most`.
void FiniteStrain::search_path(PathSearch& path, std::span<double> u, double change, double most) {
  const double from = path.factor;
  std::vector<double> known_change(path.whole.known.begin(), path.whole.known.end());
  for (double& v : known_change) v *= change;
  if (is_carried_) kernel_->predict_pressures(du_, known_change);
  for (double s = 1; s >= path_shortest; s *= 0.5) {
    path.factor = from + s * change;
    scale_loads(path, path.factor);
    for (std::size_t i = 0; i < u.size(); ++i) trial_[i] = u[i] + s * du_[i];
    kernel_->set_pressure_fraction(is_carried_ ? s : 0);
    path.now.length = s;
    path.now.residual = residual(path.load, trial_, path.now.ratio);
    if (!(path.now.residual <= most)) continue;
    std::ranges::copy(trial_, u.begin());
    if (is_carried_) kernel_->accept_pressures();
    iterates_.push_back(path.now);
    return;
  }
  throw SolveFailure(
      "The line search along the load path failed at load factor {:.6g}: even {:.3f} of the step inverts a cell or "
      "increases the residual more than {:g}-fold. {}",
      from, path.now.length, path_growth, where_worst());
}

/// From the last equilibrium along the tangent, which is the normal of the plane to be met.
void FiniteStrain::leave(PathSearch& path, TangentSolver& solver, std::span<double> u) {
  scale_loads(path, path.factor);
  start_pressures(path.load, u);
  find_push(path, u);
  path.now.residual = residual(path.load, u, path.now.ratio);
  solver.follow(true);
  path.tangent.assign(u.size(), 0);
  path.now.linear = solver.solve(path.push, path.tangent, path_linear, most_linear_).iterations;
  const double change = path_->predict(path.tangent, path.whole.dt);
  path.normal = path.tangent;
  for (double& v : path.normal) v *= change / (path_->step_length() * path_->step_length());
  for (std::size_t i = 0; i < u.size(); ++i) du_[i] = change * path.tangent[i];
  path.most = norm(mesh_.comm, path.push) *
              std::max({path_->largest_factor(), std::abs(path.factor), std::abs(change)});
  search_path(path, u, change, path_first * std::max(path.now.residual, path_small * path.most));
}

/// d + dlambda v on the plane n . (u + d + dlambda v - u_0) = l of the path, n . n = 1 / l^2 times its own length.
void FiniteStrain::correct(PathSearch& path, TangentSolver& solver, std::span<double> u) {
  find_push(path, u);
  if (presses_) path.now.residual = residual(path.load, u, path.now.ratio);
  solver.follow(iterates_.size() % 2 == 0);
  std::vector<double> own(u.size(), 0);
  path.now.linear = solver.solve(r_, own, path_linear, most_linear_).iterations +
                    solver.solve(path.push, path.tangent, path_linear, most_linear_).iterations;
  std::vector<double> way(u.begin(), u.end());
  for (std::size_t i = 0; i < way.size(); ++i) way[i] += own[i] - path.start[i];
  // The normal is that of length l over l^2: n . way = 1 on the plane.
  const double change = (1 - path_->product(path.normal, way)) / path_->product(path.normal, path.tangent);
  for (std::size_t i = 0; i < u.size(); ++i) du_[i] = own[i] + change * path.tangent[i];
  search_path(path, u, change, path_growth * std::max(path.now.residual, path_small * path.most));
}

linalg::SolveStatistics FiniteStrain::follow_path(const Load& load, std::span<double> u) {
  TangentSolver& solver = solver_for(0, load.node_inertia);
  solver.forget_factors();
  iterates_.clear();
  PathSearch path{load, {}, {}, {}, {}, {}, {u.begin(), u.end()}};
  path.factor = path_->factor();
  leave(path, solver, u);
  linalg::SolveStatistics statistics;
  statistics.iterations = 1;
  statistics.inner_iterations = path.now.linear;
  const auto left = [&] { return std::max(path.now.residual, whole_); };
  double floor = noise_;
  for (;; ++statistics.iterations, statistics.inner_iterations += path.now.linear) {
    double largest = 0;
    for (const double v : u) largest = std::max(largest, std::abs(v));
    floor = noise_ + noise_of_motion_ * parallel::max(mesh_.comm, largest);
    if (left() <= std::max(tolerance_ * path.most, floor)) break;
    if (statistics.iterations == most_path_iterations)
      throw SolveFailure(
          "Newton's method along the load path did not converge: at load factor {:.6g} after {} iterations the residual "
          "is {:.2g} of the load (tolerance {:.0e}). {}",
          path.factor, statistics.iterations, left() / path.most, tolerance_, where_worst());
    correct(path, solver, u);
  }
  kernel_->set_own_pressures(false);
  is_carried_ = false;
  std::vector<double> change(u.begin(), u.end());
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= path.start[i];
  path_->propose(path.factor, std::move(change), statistics.iterations);
  statistics.residual = left() <= floor ? 0 : left() / path.most;
  for (NewtonIterate& i : iterates_) i.residual /= path.most;
  log::debug("load factor {:.6g}; {}", path.factor, text());
  return statistics;
}

void FiniteStrain::save(io::CheckpointWriter& file) const {
  if (path_) path_->save(file, rows_);
}

void FiniteStrain::load(io::CheckpointReader& file, std::span<const double>, std::span<const double>) {
  if (path_) path_->load(file, rows_);
  is_restored_ = true;
}

}  // namespace couplet::solid
