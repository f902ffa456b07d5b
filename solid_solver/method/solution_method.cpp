// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/method/solution_method.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/method/block_coupled.hpp"
#include "solid_solver/method/mixed_form.hpp"
#include "solid_solver/method/newton_krylov.hpp"
#include "solid_solver/method/segregated.hpp"

namespace couplet::solid {

namespace {

using MethodType = MethodParameters::Type;
using Preconditioner = MethodParameters::Preconditioner;

// Smaller bodies have no coarser mesh.
constexpr GlobalIndex fewest_for_multigrid = 64;
// Set-up time of factors for a hard system, at any number of solves [s]: 60 000 cells in 2-D, 1500 hexahedra
// in 3-D.
constexpr double set_up_of_hard = 4.5;
// K/mu above which CG takes longer than the mixed form or does not converge: nu = 0.49.
constexpr double bulk_of_mixed_form = 49;

bool wants_mixed_form(const SolidProblem& problem) {
  if (!problem.elastic.volume_by_cells() || problem.project) return false;
  double ratio = 0;
  for (Index c = 0; c < problem.mesh.cells.n_owned(); ++c) {
    const elastic::LameConstants lame = problem.elastic.lame(c);
    ratio = std::max(ratio, elastic::bulk_modulus(lame) / lame.mu);
  }
  return parallel::max(problem.mesh.comm, ratio) >= bulk_of_mixed_form;
}

/// The mixed form has pressures only if the volume strain is that of cells.
void check_mixed_form(const SolidProblem& problem, const MethodParameters& parameters) {
  if (parameters.preconditioner != Preconditioner::mixed) return;
  if (!problem.is_symmetric())
    throw Error("solution-method: 'preconditioner: mixed' requires 'face-gradient: symmetric'.");
  if (!problem.elastic.volume_by_cells())
    throw Error(
        "solution-method: 'preconditioner: mixed' requires 'volume-strain: cells' or 'shared' ('auto' "
        "selects cells from nu = 0.4): with the volume strain of faces there is no mean stress per cell.");
}

/// True if factorizing the symmetric gradient's matrix is cheaper; all solves of the run share the set-up.
bool factors_pay(const SolidProblem& problem, const MethodParameters& parameters, bool is_hard) {
  if (is_axisymmetric(problem.elastic) || problem.mesh.cells.n_global() <= fewest_for_multigrid) return true;
  const FactorCost cost = factor_cost(problem.mesh, problem.geometry(), heaviness(problem));
  return cost.fits() && (is_hard ? cost.set_up <= set_up_of_hard : parameters.solves >= cost.pays_after());
}

/// Resolves `automatic` settings. Returns the reason.
std::string decide(const SolidProblem& problem, MethodParameters& parameters) {
  const std::string why =
      parameters.type == MethodType::automatic
          ? fmt::format("{} cells in {}-D", problem.mesh.cells.n_global(), problem.mesh.dim)
          : "";
  if (!problem.is_symmetric()) {
    if (parameters.type == MethodType::newton_krylov)
      throw Error(
          "solution-method: 'type: newton-krylov' requires 'face-gradient: symmetric'; 'thesis' is solved by 'block-coupled' or "
          "'segregated'.");
    if (parameters.type == MethodType::automatic) parameters.type = MethodType::block_coupled;
    return why;
  }
  if (parameters.type != MethodType::automatic && parameters.type != MethodType::newton_krylov)
    throw Error(
        "solution-method: 'face-gradient: symmetric' is solved by conjugate gradients ('type: newton-krylov' or 'auto'); "
        "'segregated' and 'block-coupled' require 'face-gradient: thesis'.");
  if (parameters.preconditioner == Preconditioner::automatic) {
    const bool mixed = wants_mixed_form(problem);
    // Stiffnesses of several materials may differ strongly.
    const bool is_hard = mixed || parallel::any(problem.mesh.comm, !problem.mesh.cell_material.empty());
    const bool direct = factors_pay(problem, parameters, is_hard);
    parameters.preconditioner = direct  ? Preconditioner::factors
                                : mixed ? Preconditioner::mixed
                                        : Preconditioner::multigrid;
  }
  parameters.type = MethodType::newton_krylov;
  return why;
}

/// Factors in the place of an iteration that the program chose; nullptr if they do not fit or cannot help. Collective.
std::unique_ptr<SolutionMethod> by_factors(const SolidProblem& problem, MethodParameters parameters,
                                           std::span<const double> b) {
  if (parallel::any(problem.mesh.comm, std::ranges::any_of(b, [](double x) { return !std::isfinite(x); })))
    return {};
  if (!factor_cost(problem.mesh, problem.geometry(), heaviness(problem)).fits()) return {};
  parameters.preconditioner = Preconditioner::factors;
  return std::make_unique<NewtonKrylov>(problem, parameters);
}

}  // namespace

linalg::SolveStatistics SolutionMethod::solve(std::span<const double> b, std::span<double> u) {
  if (instead_) return instead_->find(b, u);
  if (!cure_) return find(b, u);
  const std::vector<double> guess(u.begin(), u.end());
  try {
    return find(b, u);
  } catch (const SolveFailure& failure) {
    if (!cure(b)) throw;
    log::info("{} Factors of the matrix solve it from here on; 'preconditioner: factors' omits the attempt.",
              failure.what());
    std::ranges::copy(guess, u.begin());
    return instead_->find(b, u);
  }
}

bool SolutionMethod::cure(std::span<const double> b) {
  if (cure_ && !instead_) instead_ = cure_(b);
  if (instead_) projection_.reset();
  return is_cured();
}

void SolidProblem::apply(std::span<const double> x, std::span<double> y) const {
  if (is_symmetric()) {
    if (mass_factor > 0) return kernel.apply_with_mass(x, {}, mass_factor, true, y);
    return kernel.apply(x, {}, y);
  }
  kernel.apply(x, {}, y);
  const std::size_t dim = mesh.dim;
  for (std::size_t c = 0; c < inertia.size(); ++c)
    for (std::size_t a = 0; a < dim; ++a) y[c * dim + a] += inertia[c] * x[c * dim + a];
}

void SolidProblem::residual(std::span<const double> b, std::span<const double> u, std::span<double> r) const {
  apply(u, r);
  for (std::size_t i = 0; i < b.size(); ++i) r[i] = b[i] - r[i];
}

std::unique_ptr<SolutionMethod> make_solution_method(const SolidProblem& problem,
                                                     const MethodParameters& asked) {
  MethodParameters parameters = asked;
  check_mixed_form(problem, parameters);
  const std::string why = decide(problem, parameters);
  std::unique_ptr<SolutionMethod> method;
  switch (parameters.type) {
    case MethodType::segregated:
      method = std::make_unique<Segregated>(problem, parameters);
      break;
    case MethodType::newton_krylov:
      if (parameters.preconditioner == Preconditioner::mixed)
        method = std::make_unique<MixedForm>(problem, parameters);
      else
        method = std::make_unique<NewtonKrylov>(problem, parameters);
      break;
    default:
      method = std::make_unique<BlockCoupled>(problem, parameters);
  }
  const bool is_iteration = parameters.type == MethodType::newton_krylov && !problem.project &&
                            parameters.preconditioner != Preconditioner::factors;
  const bool was_left = asked.preconditioner == Preconditioner::automatic;
  if (is_iteration && was_left) method->cure_ = [=](auto b) { return by_factors(problem, parameters, b); };
  if (!why.empty()) method->name_ += fmt::format(" (auto: {})", why);
  method->name_ += problem.is_symmetric() ? ", symmetric face gradient" : ", least-squares face gradient";
  if (asked.face_gradient == MethodParameters::FaceGradient::automatic)
    method->name_ += problem.elastic.is_anisotropic() ? " (auto: orthotropic)"
                     : problem.is_symmetric()
                         ? " (auto)"
                         : " (auto: the symmetric one does not support these boundaries or this solver)";
  return method;
}

double norm(MPI_Comm comm, std::span<const double> values) {
  double square = 0;
  for (const double x : values) square += x * x;
  return std::sqrt(parallel::sum(comm, square));
}

namespace {

// Measured by benchmarks/linalg/factors.py. Loading of libraries [s]; reading an entry twice [s].
constexpr double loading = 0.1, entry_time = 4e-9;
// Entries per block of two or three rows and columns: CHOLMOD's of the nodes, MUMPS's including vertices.
constexpr double plane_entries = 25, space_entries = 75;
// Ratio of set-up to a solve: analysis and elimination.
constexpr double plane_set_up = 70, space_set_up = 120;
// Time of a face's term in a product and a multigrid cycle [s]; iterations, and those with good guesses.
constexpr double term_time = 11e-9, iterations = 30, iterations_of_simplices = 100;
// Exponent of the iterations in heaviness: 21, 14, 8 for 1, 10, 100.
constexpr double lightening = 0.25;

struct Counts {
  double cells, nodes, points, sides, terms;
};

Counts counts_of(const mesh::Mesh& mesh) {
  Counts n{double(mesh.cells.n_owned()), double(mesh.cells.n_owned()), 0, 0, 0};
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] >= mesh.cells.n_owned()) continue;
    const bool inner = f < mesh.n_interior;
    if (!inner) n.nodes += 1;
    n.sides += inner ? 2 : 1;
    n.terms += 2 + double(mesh.face_points[f].size());
  }
  for (double* value : {&n.cells, &n.nodes, &n.sides, &n.terms}) *value = parallel::sum(mesh.comm, *value);
  n.points = double(mesh.points.n_global());
  return n;
}

}  // namespace

double FactorCost::pays_after() const {
  if (by_cycle <= solve) return std::numeric_limits<double>::infinity();
  return set_up / (by_cycle - solve);
}

FactorCost factor_cost(const mesh::Mesh& mesh, const mesh::Geometry& geometry, double heaviness) {
  const Counts n = counts_of(mesh);
  const double length = std::max(1.0, slenderness(mesh, geometry) / 2);
  FactorCost cost{};
  double set_up = plane_set_up;
  if (mesh.dim == 2) {
    cost.entries = plane_entries * n.cells * std::max(1.0, std::log2(n.cells / length));
  } else {
    // Each vertex includes its multiplier.
    const double rows = n.nodes + 2 * n.points;
    cost.entries = space_entries * rows * std::max(std::cbrt(rows / length), std::log2(rows) / 2);
    set_up = space_set_up;
  }
  cost.solve = entry_time * cost.entries;
  cost.set_up = loading + set_up * cost.solve;
  const bool simplices = n.sides / n.cells < mesh.dim + 1.5;
  cost.by_cycle = (simplices ? iterations_of_simplices : iterations) * term_time * n.terms /
                  std::pow(1 + heaviness, lightening);
  return cost;
}

}  // namespace couplet::solid
