// SPDX-License-Identifier: Apache-2.0
// Whether the equilibrium that was found holds.
#include <array>
#include <cmath>
#include <utility>

#include "common/modes/pencil.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/large_strain/finite_strain.hpp"

namespace couplet::solid {
namespace {

// Of the solution in which a negative curvature would show, and of the least stiffness once there is one, or nearly.
constexpr double looked_for = 1e-3;
constexpr int most_looks = 2000, most_refined = 12;
// A stiffness below this is looked at more closely, by one more inverse iteration.
constexpr double nearly_lost = 0.5;
// A negative stiffness of this part of the stiffest motion's may be rounding.
constexpr double spectral_rounding = 1e-14;
// Linear solve of a motion whose size alone is used.
constexpr double roughly = 1e-4;
// Of x . K y against y . K x.
constexpr double symmetric_part = 1e-7;

}  // namespace

SoftMotion FiniteStrain::lowest_stiffness(std::span<const double> unknowns, std::span<const double> known,
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
    return {};
  }
  modes::LowestQuotient softest;
  double least = 1;
  for (int look = 0; look < 2; ++look) {
    modes::Curvature found =
        modes::look_for_negative_curvature(mesh_.comm, of.k, of.solve, force, looked_for, most_looks);
    if (!found.is_negative) elastic(found.x, force);
    softest = modes::lowest_quotient(of, found.x, found.is_negative ? most_refined : 1,
                                     [](const std::vector<double>&) { return false; });
    least = softest.value;
    if (found.is_negative || least > nearly_lost) break;
  }
  solver.forget_factors();
  if (least < 0 && -least <= spectral_rounding * stiffest_over(softest.x, elastic)) least = 0;
  return {least, std::move(softest.x)};
}

/// K(u)^-1 of the load that led from the equilibrium `before` to `u`: what `before` leaves of the new load, as it was in equilibrium with
/// the old one.
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

/// x . x of the stiffest motion there may be over that of `x`, each per x . K x, by a motion that turns round from row to row.
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
