// SPDX-License-Identifier: Apache-2.0
// Parts of FiniteStrain: the next equilibrium along a load path, and the stability of an equilibrium.
//
// Finds the next equilibrium by Newton's method for (u, lambda), A(u) = lambda b, on the plane normal to the
// path's tangent at a distance from the last one (pseudo arc length [riks1979]). Each iteration
// solves K d = r and K v = b and takes d + dlambda v, dlambda from the plane's equation (consistent tangent).

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "common/modes/pencil.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/equilibrium/finite_strain.hpp"
#include "solid_solver/method/conjugate_gradients.hpp"

namespace couplet::solid {

namespace {

constexpr int most_path_iterations = 15;
// As in ordinary load steps (finite_strain.cpp).
constexpr double path_growth = 30, path_first = 1e6, path_small = 1e-3, path_shortest = 1. / 64;
// Tolerance of the linear solves: near a limit point both solutions are large and almost cancel.
constexpr double path_linear = 1e-8;

// Tolerances of the solution that would show a negative curvature, and of a lowest stiffness near zero.
constexpr double looked_for = 1e-3;
constexpr int most_looks = 2000, most_refined = 12;
// A stiffness below this is refined by one more inverse iteration.
constexpr double nearly_lost = 0.5;
// A negative stiffness of this part of the stiffest motion's may be rounding.
constexpr double spectral_rounding = 1e-14;
// Tolerance of a solve of which only the size is used.
constexpr double roughly = 1e-4;
// Largest relative difference of x . K y and y . K x.
constexpr double symmetric_part = 1e-7;

}  // namespace

/// Loads at a load factor, and the state of the search for equilibrium.
struct FiniteStrain::PathSearch {
  const Load& whole;  // at load factor 1
  std::vector<double> rows, known, push, tangent, normal, start;
  double factor = 0, most = 0;
  Load load{};
  NewtonIterate now{};
};

/// Sets the kernel's pressures and the rows at a load factor.
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

/// d(lambda b - A)/d lambda at u; linearizes the kernel there. Known displacements act by the tangent.
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

/// (u, lambda) + s (du, dlambda) with the largest s of 1, 1/2, ... with det F > 0 and residual < `most`.
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

/// Step from the last equilibrium along the tangent, which is the normal of the plane to be met.
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

/// d + dlambda v on the path's plane n . (u + d + dlambda v - u_0) = l, n . n = 1/l^2 times its length.
void FiniteStrain::correct(PathSearch& path, TangentSolver& solver, std::span<double> u) {
  find_push(path, u);
  if (presses_) path.now.residual = residual(path.load, u, path.now.ratio);
  solver.follow(iterates_.size() % 2 == 0);
  std::vector<double> own(u.size(), 0);
  path.now.linear = solver.solve(r_, own, path_linear, most_linear_).iterations +
                    solver.solve(path.push, path.tangent, path_linear, most_linear_).iterations;
  std::vector<double> way(u.begin(), u.end());
  for (std::size_t i = 0; i < way.size(); ++i) way[i] += own[i] - path.start[i];
  // The normal is a vector of length l divided by l^2, so that n . way = 1 on the plane.
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

void FiniteStrain::visit(io::Archive& archive, std::span<const double>, std::span<const double>) {
  if (path_) path_->visit(archive, rows_);
  is_restored_ = is_restored_ || archive.reads();
}

// Stability of the equilibrium.

double FiniteStrain::lowest_stiffness(std::span<const double> unknowns, std::span<const double> known,
                                      const linalg::LinearMap& elastic, std::vector<double> start) {
  kernel_->forget_start();
  kernel_->set_own_pressures(false);
  kernel_->linearise(unknowns, known, 0, trial_);
  TangentSolver& solver = solver_for(0, {});
  solver.forget_factors();
  solver.follow(true);
  const modes::Pencil of{
      .comm = mesh_.comm,
      .n = unknowns.size(),
      .k = [&](std::span<const double> x, std::span<double> y) { kernel_->apply_tangent(x, {}, 0, y); },
      .m = elastic,
      .solve = [&](std::span<const double> r, std::span<double> z) { solver.precondition(r, z); }};
  std::vector<double> force = std::move(start), smooth(force.size());  // which soft motions answer to
  solver.precondition(force, smooth);
  if (parallel::any(mesh_.comm, kernel_->has_pressure()) && !is_symmetric(force, smooth)) {
    solver.forget_factors();
    return 1;
  }
  modes::LowestQuotient softest;
  double least = 1;
  for (int look = 0; look < 2; ++look) {
    modes::Curvature found =
        modes::find_negative_curvature(mesh_.comm, of.k, of.solve, force, looked_for, most_looks);
    if (!found.is_negative) elastic(found.x, force);
    softest = modes::lowest_quotient(of, found.x, found.is_negative ? most_refined : 1,
                                     [](const std::vector<double>&) { return false; });
    least = softest.value;
    if (found.is_negative || least > nearly_lost) break;
  }
  solver.forget_factors();
  if (least < 0 && -least <= spectral_rounding * stiffest_over(softest.x, elastic)) least = 0;
  return least;
}

/// K(u)^-1 times the change of load from the equilibrium `before` to `u`, which is the residual of `before` under the new load.
std::vector<double> FiniteStrain::backward_motion(const Load& load, std::span<const double> before,
                                                  std::span<const double> u) {
  TangentSolver& solver = solver_for(0, {});
  const std::span<const double> known_before = load.before.empty() ? load.known : load.before;
  std::vector<double> change(load.known.begin(), load.known.end()), motion(u.size());
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= known_before[i];
  double ratio = 1;
  residual({load.rows, known_before, {}, 0, false}, before, ratio);
  kernel_->linearise(u, load.known, 0, trial_);
  solver.forget_factors();
  solver.follow(true);
  const std::vector<double> still(u.size(), 0);
  kernel_->apply_tangent(still, change, 0, trial_);
  for (std::size_t i = 0; i < r_.size(); ++i) r_[i] -= trial_[i];
  solver.solve(r_, motion, roughly, most_linear_);
  return motion;
}

/// Ratio of x . x / x . K x of the stiffest motion, which alternates from row to row, to that of `x`.
double FiniteStrain::stiffest_over(std::span<const double> x, const linalg::LinearMap& elastic) const {
  std::vector<double> force(x.size()), rough(x.size());
  std::array<double, 4> sums{};
  elastic(x, force);
  for (std::size_t i = 0; i < x.size(); ++i) sums[0] += x[i] * x[i], sums[1] += x[i] * force[i];
  for (std::size_t i = 0; i < x.size(); ++i) rough[i] = i / std::size_t(mesh_.dim) % 2 == 0 ? 1 : -1;
  elastic(rough, force);
  for (std::size_t i = 0; i < x.size(); ++i) sums[2] += rough[i] * rough[i], sums[3] += rough[i] * force[i];
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE, MPI_SUM, mesh_.comm);
  return sums[1] > 0 && sums[2] > 0 ? sums[0] / sums[1] * sums[3] / sums[2] : 0;
}

bool FiniteStrain::is_symmetric(std::span<const double> x, std::span<const double> y) {
  std::vector<double> force(x.size());
  const auto work = [&](std::span<const double> a, std::span<const double> b) {
    kernel_->apply_tangent(a, {}, 0, force);
    double local = 0;
    for (std::size_t i = 0; i < b.size(); ++i) local += b[i] * force[i];
    return parallel::sum(mesh_.comm, local);
  };
  const double one = work(x, y), other = work(y, x);
  return std::abs(one - other) <= symmetric_part * (std::abs(one) + std::abs(other));
}

}  // namespace couplet::solid
