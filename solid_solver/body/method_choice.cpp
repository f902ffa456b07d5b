// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/method_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/method/conjugate_gradients.hpp"
#include "solid_solver/method/mixed_form.hpp"
#include "solid_solver/thesis/block_coupled.hpp"
#include "solid_solver/thesis/segregated.hpp"

namespace couplet::solid {
namespace {

using MethodType = MethodParameters::Type;
using Preconditioner = MethodParameters::Preconditioner;

// Smaller bodies have no coarser mesh.
constexpr GlobalIndex fewest_for_multigrid = 64;
// Set-up time of factors for a hard system, at any number of solves [s]: 60 000 cells in 2-D, 1500 hexahedra in 3-D.
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
  return std::make_unique<ConjugateGradients>(problem, parameters);
}

}  // namespace

std::unique_ptr<SolutionMethod> make_solution_method(const SolidProblem& problem,
                                                     const MethodParameters& asked) {
  MethodParameters parameters = asked;
  check_mixed_form(problem, parameters);
  const std::string why = decide(problem, parameters);
  std::unique_ptr<SolutionMethod> method;
  if (parameters.type == MethodType::segregated)
    method = std::make_unique<Segregated>(problem, parameters);
  else if (parameters.type != MethodType::newton_krylov)
    method = std::make_unique<BlockCoupled>(problem, parameters);
  else if (parameters.preconditioner == Preconditioner::mixed)
    method = std::make_unique<MixedForm>(problem, parameters);
  else
    method = std::make_unique<ConjugateGradients>(problem, parameters);
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

}  // namespace couplet::solid
