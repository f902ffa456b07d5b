// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/equilibrium/finite_strain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/elasticity/finite/finite_strain.hpp"
#include "common/log/log.hpp"
#include "common/mesh/mesh.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/equilibrium/large_strain.hpp"
#include "solid_solver/laws/laws.hpp"
#include "solid_solver/method/conjugate_gradients.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {

namespace {

// Iterations after which a shorter load step is cheaper.
constexpr int most_iterations = 20;
// Allowed growth of the residual in a step, if it is at least `small` relative to the load.
constexpr double growth = 30, small = 1e-3;
// Allowed growth in the first iteration, which passes through the prediction of linear theory.
constexpr double first = 1e6;
// Shortest step length; below it the direction is useless.
constexpr double shortest = 1. / 128;
// Forcing terms of the linear solves.
constexpr double loosest = 0.05, tightest = 1e-4, with_pressures = 1e-6;
// Tolerance if momenta must be conserved, because the residual of a linear solve adds momentum (2e-10
// relative in 40 steps with the looser ones, 2e-13 with this).
constexpr double conserving = 1e-6;
constexpr std::size_t solvers_kept = 2;
// Poisson's ratio from which pressures are separate unknowns, and the compact operator approximates the
// tangent poorly (inertia helps); bodies up to these sizes can use factors.
constexpr double factors_from_ratio = 0.48, factors_from_dynamic = 0.499;
constexpr GlobalIndex tangent_factors_up_to_2d = 60000, tangent_factors_up_to_3d = 4000;
// Slenderness from which static bodies of these sizes use factors, too. 120 quadrilaterals of a bar 100:1
// under follower pressure fail without, a beam 1:20 takes four times as long.
constexpr double slender_2d = 12, slender_3d = 60;
// Largest size in 3-D, where factors soon cost more than they save. For a beam 32:1 of 128, 432, 1024 and
// 2048 cells they took 1.4, 14, over 24 and over 25 s of CPU time instead of 5.9, 14, 7.0 and 3.7 s.
constexpr GlobalIndex slender_up_to_3d = 400;
// A correction of this relative size is round-off.
constexpr double rounding = 1e-14;
// Residual over the load by round-off from which it is reported.
constexpr double drowned = 0.01;

/// As accurate as the last step justifies, but no more than `wanted`.
double forcing(double ratio, double wanted) {
  return std::max(std::clamp(0.9 * ratio * ratio, tightest, loosest), std::min(wanted, loosest));
}

constexpr int most_multipliers = 100;
// Relative change of a rigid seat's pressure at convergence; the relative penetration is similar.
constexpr double settled = 1e-9;

}  // namespace

FiniteStrain::FiniteStrain(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                           const SolidParameters& parameters)
    : LargeStrain(mesh, rows),
      tolerance_(parameters.method.relative_tolerance),
      most_linear_(parameters.method.max_iterations) {
  const mesh::Geometry& geometry = rows.geometry();
  std::vector<elastic::FiniteLaw> all;
  for (const SolidMaterial& material : materials_of(parameters)) {
    const laws::Entry& law = *laws::of(material.law);
    all.push_back(law.make(lame_constants(material.youngs_modulus, material.poissons_ratio),
                           material.law_coefficients));
    if (rows.volume_by_cells() && !all.back().has_bulk)
      throw Error(
          "solution-method.volume-strain: cells: the law '{}' has no purely volumetric part to evaluate per "
          "cell; use 'volume-strain: faces' or another law.",
          law.name);
  }
  kernel_ = std::make_unique<elastic::FiniteKernel>(mesh, rows, std::move(all),
                                                    parameters.plane == SolidParameters::Plane::stress);
  using Preconditioner = MethodParameters::Preconditioner;
  const GlobalIndex cells = mesh.cells.n_global();
  const bool is_small = cells <= (mesh.dim == 2 ? tangent_factors_up_to_2d : tangent_factors_up_to_3d);
  const double ratio = largest_poissons_ratio(parameters);
  const bool is_dynamic = parameters.analysis == SolidParameters::Analysis::dynamic;
  const bool is_slender = !is_dynamic && (mesh.dim == 2 || cells <= slender_up_to_3d) &&
                          slenderness(mesh, geometry) > (mesh.dim == 2 ? slender_2d : slender_3d);
  const bool follows_path = parameters.load_stepping.type == LoadStepping::Type::arc_length;
  const bool wants_factors =  // past a limit point the tangent is indefinite
      is_slender || follows_path ||
      (rows.volume_by_cells() && ratio >= (is_dynamic ? factors_from_dynamic : factors_from_ratio));
  if (parameters.method.preconditioner == Preconditioner::factors ||
      (parameters.method.preconditioner == Preconditioner::automatic && is_small && wants_factors))
    by_ = TangentSolver::By::factors;
  mixed_ = rows.volume_by_cells() && ratio >= factors_from_ratio;
  r_.resize(rows.n_unknowns());
  trial_ = du_ = r_;
  noise_ = rounding_of_forces(mesh, rows);
  noise_of_motion_ = rounding_of_motion(mesh, rows);
  if (follows_path) path_.emplace(mesh, geometry, parameters.load_stepping);
}

std::string FiniteStrain::name() const {
  return fmt::format("Newton's method at large strain{}, symmetric face gradient",
                     by_ == TangentSolver::By::factors ? " (factors of the tangent)" : "");
}

TangentSolver& FiniteStrain::solver_for(double mass_factor, std::span<const double> node_inertia,
                                        const Pressing* pressing) {
  const auto same = [&](const std::unique_ptr<TangentSolver>& s) {
    return std::abs(s->mass_factor() - mass_factor) <= 1e-10 * mass_factor;
  };
  const auto found = std::ranges::find_if(solvers_, same);
  if (found != solvers_.end()) {
    std::rotate(solvers_.begin(), found, found + 1);
  } else {
    if (solvers_.size() == solvers_kept) solvers_.pop_back();
    solvers_.insert(solvers_.begin(),
                    std::make_unique<TangentSolver>(mesh_, rows_, *kernel_, mass_factor, node_inertia, by_));
  }
  solvers_.front()->meet(pressing);
  return *solvers_.front();
}

/// r = b - A(u) and its norm; infinite if a face is inverted.
double FiniteStrain::residual(const Load& load, std::span<const double> u, double& ratio) {
  kernel_->linearise(u, load.known, load.mass_factor, r_);
  ratio = parallel::min(mesh_.comm, kernel_->worst().ratio);
  if (!(ratio > 0)) return std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < r_.size(); ++i) r_[i] = load.rows[i] - r_[i];
  if (load.pressing) load.pressing->push_off(u, load.known, r_);
  double size = norm(mesh_.comm, r_);
  whole_ = size;
  if (is_carried_) {
    // Right-hand side of the linear system after eliminating the pressures.
    std::vector<double> defect(r_.size(), 0);
    kernel_->add_pressure_defect(defect);
    for (std::size_t i = 0; i < r_.size(); ++i) r_[i] -= defect[i];
    whole_ = norm(mesh_.comm, r_);
  }
  return std::isfinite(size) && std::isfinite(whole_) ? size : std::numeric_limits<double>::infinity();
}

/// p of the accepted state, updated by the linear change to the first guess.
void FiniteStrain::start_pressures(const Load& load, std::span<const double> u) {
  is_carried_ = false;
  kernel_->set_own_pressures(false);
  if (!mixed_ || load.is_conserving) return;
  is_carried_ = true;
  if (load.accepted.empty()) {
    kernel_->linearise(u, load.known, load.mass_factor, r_);
    return kernel_->set_own_pressures(true);
  }
  kernel_->linearise(load.accepted, load.accepted_known, load.mass_factor, r_);
  kernel_->set_own_pressures(true);
  std::vector<double> change(u.begin(), u.end()), known_change(load.known.begin(), load.known.end());
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= load.accepted[i];
  for (std::size_t i = 0; i < known_change.size(); ++i)
    known_change[i] -= (load.before.empty() ? load.accepted_known : load.known)[i];
  predict_pressures(change, known_change);
}

void FiniteStrain::predict_pressures(std::span<const double> change, std::span<const double> known_change) {
  if (!is_carried_) return;
  kernel_->predict_pressures(change, known_change);
  kernel_->set_pressure_fraction(1);
  kernel_->accept_pressures();
}

/// Moves the body with its known columns by one linear step, because the first guess would make a jump in adjacent cells.
void FiniteStrain::follow_known(const Load& load, TangentSolver& solver, std::span<double> u) {
  std::vector<double> change(load.known.begin(), load.known.end());
  double size = 0;
  for (std::size_t i = 0; i < change.size(); ++i) {
    change[i] -= load.before[i];
    size = std::max(size, std::abs(change[i]));
  }
  if (!(parallel::max(mesh_.comm, size) > 0)) return;
  double ratio = 1;
  Load at_start = load;
  at_start.known = load.before;
  if (!std::isfinite(residual(at_start, u, ratio))) return;
  solver.follow(true);
  const std::vector<double> still(u.size(), 0);
  kernel_->apply_tangent(still, change, load.mass_factor, trial_);
  for (std::size_t i = 0; i < r_.size(); ++i) r_[i] -= trial_[i];
  solver.solve(r_, du_, tightest, most_linear_);
  predict_pressures(du_, change);
  for (std::size_t i = 0; i < u.size(); ++i) u[i] += du_[i];
}

/// u + s du with the largest s of 1, 1/2, ... that keeps det F positive and the residual below `most`.
bool FiniteStrain::search(const Load& load, std::span<double> u, NewtonIterate& now, double most) {
  if (load.mass_factor == 0 && !load.pressing && iterates_.size() == 1) jump_.predict(u, du_);
  for (double s = 1; s >= shortest; s *= 0.5) {
    for (std::size_t i = 0; i < u.size(); ++i) trial_[i] = u[i] + s * du_[i];
    kernel_->set_pressure_fraction(is_carried_ ? s : 0);
    const double size = residual(load, trial_, now.ratio);
    now.length = s;
    now.residual = size;
    if (!(size <= most)) continue;
    std::ranges::copy(trial_, u.begin());
    if (is_carried_) kernel_->accept_pressures();
    return true;
  }
  return false;
}

/// Scale of the residual: the loads, or in motion the internal forces, because b contains the inertia of the
/// position itself, which far exceeds the accelerating force.
double FiniteStrain::scale_of(const Load& load, std::span<const double> u, double residual) {
  if (load.pressing) {
    std::vector<double> push(u.size(), 0);
    load.pressing->seat().add_to_rows(load.pressing->forces(), push);
    residual = std::max(residual, norm(mesh_.comm, push));
  }
  if (load.mass_factor == 0) return std::max(norm(mesh_.comm, load.rows), residual);
  kernel_->linearise(u, load.known, 0, trial_);
  const double inner = norm(mesh_.comm, trial_);
  kernel_->linearise(u, load.known, load.mass_factor, trial_);
  return std::max(inner, residual);
}

linalg::SolveStatistics FiniteStrain::iterate(const Load& load, std::span<double> u) {
  TangentSolver& solver = solver_for(load.mass_factor, load.node_inertia, load.pressing);
  solver.forget_factors();
  linalg::SolveStatistics statistics;
  iterates_.clear();
  start_pressures(load, u);
  if (parallel::any(mesh_.comm, !load.before.empty())) follow_known(load, solver, u);
  NewtonIterate now;
  now.residual = residual(load, u, now.ratio);
  if (!std::isfinite(now.residual))
    throw SolveFailure("The initial guess of the step inverts a cell. {}", where_worst());
  const double scale = scale_of(load, u, now.residual);
  // Its difference quotients divide round-off by the change over the step.
  const auto floor = [&] {
    double largest = 0;
    for (const double v : u) largest = std::max(largest, std::abs(v));
    const double noise = noise_ + noise_of_motion_ * parallel::max(mesh_.comm, largest);
    return load.is_conserving ? 0.5 / elastic::finite::smallest_change * noise : noise;
  };
  double before = now.residual;
  for (;;) {
    iterates_.push_back(now);
    iterates_.back().residual = std::max(now.residual, whole_) / (scale > 0 ? scale : 1);
    if (std::max(now.residual, whole_) <= std::max(tolerance_ * scale, floor())) break;
    if (statistics.iterations == most_iterations)
      throw SolveFailure(
          "Newton's method did not converge: after {} iterations the residual is {:.2g} of the load (tolerance {:.0e}). {}",
          statistics.iterations, std::max(now.residual, whole_) / scale, tolerance_, where_worst());
    const double ratio = statistics.iterations == 0 ? 1 : now.residual / before;
    const double eta =
        load.is_conserving ? conserving : forcing(ratio, 0.5 * tolerance_ * scale / now.residual);
    solver.follow(statistics.iterations % 2 == 0);
    now.linear = solver.solve(r_, du_, is_carried_ ? with_pressures : eta, most_linear_).iterations;
    if (is_carried_) kernel_->predict_pressures(du_, {});
    ++statistics.iterations;
    statistics.inner_iterations += now.linear;
    before = now.residual;
    const double correction = norm(mesh_.comm, du_), size = norm(mesh_.comm, u);
    if (!search(load, u, now,
                (statistics.iterations == 1 ? first : growth) * std::max(before, small * scale)))
      throw SolveFailure(
          "Newton's line search failed: even {:.3f} of the step inverts a cell or increases the residual "
          "more than {:g}-fold. {}",
          now.length, growth, where_worst());
    if (correction <= rounding * size && now.residual < small * scale) {
      iterates_.push_back(now);
      iterates_.back().residual = std::max(now.residual, whole_) / scale;
      break;
    }
  }
  kernel_->set_own_pressures(false);
  is_carried_ = false;
  statistics.residual = iterates_.back().residual;
  const double left = std::max(now.residual, whole_);
  if (load.mass_factor == 0 && left > tolerance_ * scale)
    statistics.residual = judge_rounding(load, scale, left);
  log::debug("{}", text());
  return statistics;
}

double FiniteStrain::judge_rounding(const Load& load, double scale, double left) {
  const double loads = presses_ ? scale : norm(mesh_.comm, load.rows);
  if (loads == 0) return 0;
  if (left > drowned * loads && !is_drowned_told_)
    log::warn(
        "The load ({:.2g} N) is close to the rounding error of the internal forces of this stiff, displaced "
        "body ({:.2g} N): its effect is not resolved.",
        loads, left);
  is_drowned_told_ = is_drowned_told_ || left > drowned * loads;
  return left / loads;
}

// Response of the body in a state: forces, energy, sensitivity; description of the last solve.

linalg::SolveStatistics FiniteStrain::find(const Load& load, SolidSystem&, std::span<double> u) {
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
    // Features of the accepted state may prevent finding another one.
    kernel_->set_own_pressures(false);
    kernel_->linearise(load.accepted, load.accepted_known, 0, trial_);
    const std::string fold =
        folded_support(mesh_, rows_, [this](Index node) { return kernel_->displacement(node); });
    if (fold.empty()) throw;
    throw SolveFailure("{} {}", failure.what(), fold);
  }
}

/// With a rigid seat, iterates until its multipliers converge.
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
          "The contact pressure on the rigid seat did not converge in {} corrections (last relative change {:.1e}).",
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
  const elastic::FiniteKernel::WorstFace worst = kernel_->worst();
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

/// theta = 1 + the integral of alpha dT: lengths refer to the body at the reference temperature.
void FiniteStrain::set_expansion(std::vector<double> strains) {
  if (strains.empty()) return;
  double least = 1;
  for (double& strain : strains) least = std::min(least, strain += 1);
  if (!(parallel::min(mesh_.comm, least) > 0))
    throw Error(
        "thermal-expansion: a thermal strain of -1 or less would shrink the body to nothing; check 'material.expansion' and "
        "the temperatures.");
  kernel_->set_stretch(strains);
  jump_.set_stretch(std::move(strains));
  if (std::exchange(is_restored_, false)) jump_.settle();
}

}  // namespace couplet::solid
