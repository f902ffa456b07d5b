// SPDX-License-Identifier: Apache-2.0
// What the body answers in a given state: forces, energy, softness; the last solve in words.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/mesh/extent.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/large_strain/finite_strain.hpp"
#include "solid_solver/large_strain/folded_support.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {
namespace {

constexpr int most_multipliers = 100;
// Change of the pressure of a rigid seat over the largest: as much is left of the penetration over that of its springs.
constexpr double settled = 1e-9;

}  // namespace

linalg::SolveStatistics FiniteStrain::solve(const Load& load, std::span<double> u) {
  if (path_) return follow_path(load, u);
  if (load.is_conserving) kernel_->set_start(load.accepted, load.accepted_known);
  const bool is_static = load.mass_factor == 0 && !load.pressing;  // whose path has corners
  if (is_static) jump_.start(u, mesh_.dim);
  try {
    const linalg::SolveStatistics statistics = press(load, u);
    if (is_static && statistics.iterations > 0)
      jump_.end(mesh_.comm, u, mesh::extent_of(mesh_, geometry_).diagonal(),
                [&](std::span<const double> before) { return backward_motion(load, before, u); });
    if (is_static) jump_.settle();
    kernel_->forget_start();
    return statistics;
  } catch (const SolveFailure& failure) {
    kernel_->forget_start();
    if (!parallel::any(mesh_.comm, !load.accepted.empty())) throw;
    // What of the accepted state may be why no other is found.
    kernel_->set_own_pressures(false);
    kernel_->linearise(load.accepted, load.accepted_known, 0, trial_);
    const std::string fold =
        folded_support(mesh_, rows_, [this](Index node) { return kernel_->displacement(node); });
    if (fold.empty()) throw;
    throw SolveFailure("{} {}", failure.what(), fold);
  }
}

/// With a rigid seat until a change of its multipliers leaves nothing to correct.
linalg::SolveStatistics FiniteStrain::press(const Load& load, std::span<double> u) {
  linalg::SolveStatistics all = iterate(load, u);
  if (!load.pressing || !load.pressing->seat().is_rigid()) return all;
  for (int i = 0;; ++i) {
    const double change = load.pressing->take_multipliers(mesh_.comm);
    if (change <= settled) return all;
    const linalg::SolveStatistics one = iterate(load, u);
    all.iterations += one.iterations;
    all.inner_iterations += one.inner_iterations;
    all.residual = one.residual;
    if (one.iterations == 0) return all;
    if (i == most_multipliers)
      throw SolveFailure(
          "The pressure of the rigid seat did not settle in {} corrections (last change {:.1e} of it).",
          most_multipliers, change);
  }
}

std::vector<double> FiniteStrain::forces(std::span<const double> unknowns, std::span<const double> known) {
  std::vector<double> rows(rows_.n_unknowns());
  kernel_->linearise(unknowns, known, 0, rows);
  return rows;
}

double FiniteStrain::energy(std::span<const double> unknowns, std::span<const double> known) {
  kernel_->forget_start();
  kernel_->set_own_pressures(false);
  forces(unknowns, known);
  return parallel::sum(mesh_.comm, kernel_->energy());
}

double FiniteStrain::softness(std::span<const double> unknowns, std::span<const double> known) {
  const double strain = energy(unknowns, known);
  std::vector<double> inner = forces(unknowns, known);
  double work = 0;
  for (std::size_t i = 0; i < inner.size(); ++i) work += unknowns[i] * inner[i];
  work = parallel::sum(mesh_.comm, work);
  const double size = norm(mesh_.comm, unknowns);
  if (!(strain > 0) || !(size > 0)) return 1;
  TangentSolver& solver = solver_for(0, {});
  solver.forget_factors();
  solver.follow(true);
  std::vector<double> change(inner.size());
  constexpr double tolerance = 1e-2;
  solver.solve(inner, change, tolerance, most_linear_);
  const double loaded = std::min(1.0, std::abs(work) / (2 * strain));
  return loaded * norm(mesh_.comm, change) / size + 1 - loaded;
}

void FiniteStrain::visit(std::span<const double> unknowns, std::span<const double> known, const Take& take) {
  kernel_->forget_start();
  forces(unknowns, known);
  kernel_->visit(take);
}

std::string FiniteStrain::where_worst() const {
  const elastic::FiniteKernel::Worst worst = kernel_->worst();
  return worst_cell(mesh_, geometry_, worst.ratio, worst.face);
}

std::string FiniteStrain::text() const {
  std::string residuals;
  int linear = 0;
  for (const NewtonIterate& i : iterates_) {
    residuals += fmt::format("{}{:.1e}", residuals.empty() ? "" : " ", i.residual);
    linear += i.linear;
  }
  return fmt::format("Newton: residuals {}, {} linear iterations, smallest det F {:.3g}", residuals, linear,
                     iterates_.empty() ? 1.0 : iterates_.back().ratio);
}

void FiniteStrain::set_pressure(std::vector<double> of_faces) {
  presses_ = parallel::any(mesh_.comm, std::ranges::any_of(of_faces, [](double p) { return p != 0; }));
  kernel_->set_pressure(of_faces);
  if (path_) whole_pressure_ = std::move(of_faces);
}

/// theta = 1 + the integral of alpha dT: lengths of the body as it was at the reference temperature.
void FiniteStrain::set_expansion(const std::function<std::vector<double>()>& of_faces) {
  std::vector<double> strains = of_faces();
  if (strains.empty()) return;
  double least = 1;
  for (double& strain : strains) least = std::min(least, strain += 1);
  if (!(parallel::min(mesh_.comm, least) > 0))
    throw Error(
        "thermal-expansion: a thermal strain of -1 or less leaves nothing of the body; check "
        "'material.expansion' and the temperatures.");
  kernel_->set_stretch(strains);
  jump_.set_stretch(std::move(strains));
  if (std::exchange(is_restored_, false)) jump_.settle();
}

}  // namespace couplet::solid
