// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/method/solution_method.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/method/block_coupled.hpp"
#include "solid_solver/method/mixed_form.hpp"
#include "solid_solver/method/newton_krylov.hpp"
#include "solid_solver/method/segregated.hpp"

namespace couplet::solid {
namespace {

using MethodType = MethodParameters::Type;
using Preconditioner = MethodParameters::Preconditioner;

// Cells up to which factors kept for all steps win: in the plane they stay thin, in space they fill quickly.
constexpr GlobalIndex factors_up_to_2d = 60000, factors_up_to_3d = 1500;
// The symmetric gradient's matrix is several times as wide. A beam of 10:1, processor seconds of one solve and of 100
// steps, factors for multigrid: 2-D 160 cells .05 for .06 and .10 for .20, 2560 .17 for .06 and .93 for 1.09, 16000 1.5
// for .2 and 8.0 for 7.9; in space 80 hexahedra .11 for .04 and .36 for .25, 640 1.6 for .07 and 4.7 for 1.0, 480
// tetrahedra 1.2 for .09 and 16 for 1.5: there factors never pay, in the plane for a motion alone. Bodies of few cells
// have no coarser mesh.
constexpr GlobalIndex wide_factors_in_motion = 20000, wide_factors_2d = 200, wide_factors_3d = 64;
// In the plane, from so many cells up, steps in which a wave crosses less than a cell (heaviness 1) need so few iterations
// that the factors cost more than they save: 9216 cells, 100 steps: 2.6 s of factors against 0.6, 1.0, 1.4 s at Courant
// numbers of 0.1, 0.3, 1, in pairs; with 4096 cells factors still win. From about 3 up they win again, with any mesh.
constexpr GlobalIndex factors_beside_inertia = 5000;

// K / mu from which conjugate gradients need more time than the mixed form, or never end: nu = 0.49.
constexpr double bulk_of_mixed_form = 49;

bool wants_mixed_form(const SolidProblem& problem) {
  if (!problem.elastic.volume_by_cells() || problem.rigid) return false;
  double ratio = 0;
  for (Index c = 0; c < problem.mesh.cells.n_owned(); ++c) {
    const elastic::LameConstants lame = problem.elastic.lame(c);
    ratio = std::max(ratio, elastic::bulk_modulus(lame) / lame.mu);
  }
  return parallel::max(problem.mesh.comm, ratio) >= bulk_of_mixed_form;
}

/// The mixed form has pressures where the volume strain is that of cells.
void check_mixed_form(const SolidProblem& problem, const MethodParameters& parameters) {
  if (parameters.preconditioner != Preconditioner::mixed) return;
  if (!problem.is_symmetric())
    throw Error("solution-method: 'preconditioner: mixed' requires 'face-gradient: symmetric'.");
  if (!problem.elastic.volume_by_cells())
    throw Error(
        "solution-method: 'preconditioner: mixed' requires 'volume-strain: cells' or 'shared' ('auto' "
        "selects cells from nu = 0.4): with the volume strain of faces there is no mean stress per cell.");
}

/// Steps so short that inertia makes the system easy. Collective.
bool is_easy(const SolidProblem& problem) {
  return problem.mesh.dim == 2 && problem.mesh.cells.n_global() > factors_beside_inertia &&
         heaviness(problem) >= 1 && !wants_mixed_form(problem);
}

/// Of the symmetric gradient's matrix.
bool factors_pay(const SolidProblem& problem, bool easy, bool small) {
  if (parallel::any(problem.mesh.comm, !problem.mesh.cell_material.empty()))
    return small;  // stiffnesses may be far apart
  const GlobalIndex cells = problem.mesh.cells.n_global();
  if (problem.mesh.dim == 3) return cells <= wide_factors_3d;
  return cells <= (problem.is_static() || easy ? wide_factors_2d : wide_factors_in_motion);
}

/// Fills in what is left to the program; gives the reason.
std::string decide(const SolidProblem& problem, MethodParameters& parameters) {
  const GlobalIndex cells = problem.mesh.cells.n_global();
  const bool easy = is_easy(problem);
  const bool small = cells <= (problem.mesh.dim == 2 ? factors_up_to_2d : factors_up_to_3d) && !easy;
  const bool asked_automatic = parameters.type == MethodType::automatic;
  std::string why = asked_automatic ? fmt::format("{} cells in {}-D{}", cells, problem.mesh.dim,
                                                  easy ? ", short steps" : "")
                                    : "";
  if (problem.is_symmetric()) {
    if (parameters.type != MethodType::automatic && parameters.type != MethodType::newton_krylov)
      throw Error(
          "solution-method: 'face-gradient: symmetric' is solved by conjugate gradients ('type: "
          "newton-krylov' or 'auto'); 'segregated' and 'block-coupled' require 'face-gradient: thesis' or "
          "'corrected'.");
    if (parameters.preconditioner == Preconditioner::automatic) {
      const bool mixed = wants_mixed_form(problem);
      const bool direct =
          is_axisymmetric(problem.elastic) || (mixed ? small : factors_pay(problem, easy, small));
      parameters.preconditioner = direct  ? Preconditioner::factors
                                  : mixed ? Preconditioner::mixed
                                          : Preconditioner::multigrid;
    }
    parameters.type = MethodType::newton_krylov;
    return why;
  }
  // As in NewtonKrylov for the symmetric pair: the tolerance is meant of the elastic part, or energies drift (2e-6 in 1000
  // steps at a Courant number of 0.01, 1e-10 so).
  if (easy)
    parameters.relative_tolerance = std::min(
        parameters.relative_tolerance, std::max(1e-13, parameters.relative_tolerance / heaviness(problem)));
  if (parameters.type == MethodType::automatic) {
    const bool direct = small && !problem.is_corrected();
    parameters.type = direct ? MethodType::block_coupled : MethodType::newton_krylov;
    if (direct) parameters.linear_solver = MethodParameters::LinearSolver::direct;
  }
  if (parameters.preconditioner == Preconditioner::automatic)
    parameters.preconditioner = small ? Preconditioner::factors : Preconditioner::multigrid;
  return why;
}

}  // namespace

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
  if (!why.empty()) method->name_ += fmt::format(" (auto: {})", why);
  method->name_ += problem.is_symmetric()   ? ", symmetric face gradient"
                   : problem.is_corrected() ? ", corrected face gradient"
                                            : ", least-squares face gradient";
  if (asked.face_gradient == MethodParameters::FaceGradient::automatic)
    method->name_ += problem.elastic.is_anisotropic() ? " (auto: orthotropic)"
                     : problem.is_symmetric()
                         ? " (auto)"
                         : " (auto: the symmetric one does not support these boundaries or this solver)";
  return method;
}

elastic::FaceGradientScheme face_gradient_scheme(const SolidParameters& parameters) {
  using FaceGradient = MethodParameters::FaceGradient;
  if (is_updated_lagrangian(parameters)) return elastic::FaceGradientScheme::thesis;
  if (has_finite_strain(parameters) || has_orthotropic(parameters))
    return elastic::FaceGradientScheme::symmetric;
  switch (parameters.method.face_gradient) {
    case FaceGradient::symmetric:
      return elastic::FaceGradientScheme::symmetric;
    case FaceGradient::corrected:
      return elastic::FaceGradientScheme::corrected;
    case FaceGradient::thesis:
      return elastic::FaceGradientScheme::thesis;
    default:
      break;
  }
  return symmetric_suits(parameters) ? elastic::FaceGradientScheme::symmetric
                                     : elastic::FaceGradientScheme::thesis;
}

double norm(MPI_Comm comm, std::span<const double> values) {
  double square = 0;
  for (const double x : values) square += x * x;
  return std::sqrt(parallel::sum(comm, square));
}

}  // namespace couplet::solid
