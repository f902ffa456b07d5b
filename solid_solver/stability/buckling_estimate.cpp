// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/stability/buckling_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/log/finding.hpp"
#include "common/modes/lowest_quotient.hpp"
#include "common/modes/negative_curvature.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/method/newton_krylov.hpp"

namespace couplet::solid {
namespace {

// Compressive strain times (L/t)^2: a clamped column reaches three times less than Euler's load at 0.07 (thickness by slenderness(): of a
// square column half its own, hence a fourth), a plate or an arch far above.
constexpr double least_strain = 0.015;
// Of the solution in which a negative curvature of K + 3 K_sigma would show.
constexpr double shown_at = 1e-3;
constexpr int most_searches = 2000, most_refinements = 40, settled = 6;
// More compression than at the last look that makes another one worth while.
constexpr double more_compression = 1.1;
// A factor that has changed by less than this part over the last refinements is told.
constexpr double settled_part = 0.01;

}  // namespace

void tell_dynamic_buckling(MPI_Comm comm, double factor) {
  if (!(factor < BucklingEstimate::low)) return;
  log::finding(parallel::comm_rank(comm),
               {.id = "buckling",
                .number = factor,
                .limit = BucklingEstimate::low,
                .sentence = fmt::format(
                    "buckling: load factor at most {:.3g} (limit {:g}) of the last state: {}", factor,
                    BucklingEstimate::low,
                    factor < 1 ? "if these loads last, the body buckles; linear theory does not show it"
                               : "linear theory neglects the softening by these loads"),
                .advice = "use 'kinematics: finite-strain'"});
}

void tell_buckling(MPI_Comm comm, double factor, const char* how) {
  if (!(factor < BucklingEstimate::low)) return;
  const bool holds = factor >= 1;
  log::finding(
      parallel::comm_rank(comm),
      {.id = "buckling",
       .severity = holds ? base::Severity::warning : base::Severity::wrong,
       .number = factor,
       .limit = holds ? BucklingEstimate::low : 1,
       .sentence = fmt::format("buckling: load factor {}{:.3g} (limit {:g}): {}", how, factor,
                               holds ? BucklingEstimate::low : 1,
                               holds ? "linear theory neglects the softening by these loads"
                                     : "the computed equilibrium is unstable"),
       .advice =
           holds
               ? "use 'kinematics: finite-strain'; 'analysis: buckling' gives factors and shapes"
               : "reduce the loads, stiffen the body or add supports; 'analysis: buckling' gives factors "
                 "and shapes, 'kinematics: finite-strain' with a small lateral load the post-buckling state"});
}

BucklingEstimate estimate_buckling(const SolidBody& body, const SolidFields& fields, double time,
                                   SolutionMethod& method, double& compression_seen) {
  const mesh::Geometry& geometry = body.geometry();
  const mesh::Mesh& mesh = body.mesh();
  elastic::Prestress prestress = prestress_of(body, fields, time);
  double softest = 1e300;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const elastic::LameConstants lame = body.elastic().lame(c);
    softest = std::min(softest, lame.mu * (3 * lame.lambda + 2 * lame.mu) / (lame.lambda + lame.mu));
  }
  const double here = compression(mesh, prestress), ratio = slenderness(mesh, geometry);
  if (!(here > more_compression * compression_seen)) return {};
  if (!(here / parallel::min(mesh.comm, softest) * ratio * ratio >= least_strain)) return {};
  // As forces, which soft motions answer to: what stiff ones leave would end the iteration before.
  const std::vector<double> force = any_start(body);
  std::vector<double> of_stress(force.size());
  if (!method.approximate_inverse(force, of_stress)) return {};
  compression_seen = here;
  const auto stress = elastic::make_stress_stiffness(mesh, body.elastic(), std::move(prestress));
  const modes::QuotientOperators of{
      .a = [&](std::span<const double> x, std::span<double> y) { stress->apply(x, y); },
      .b = [&](std::span<const double> x, std::span<double> y) { body.kernel().apply(x, {}, y); },
      .precondition = [&](std::span<const double> r,
                          std::span<double> z) { method.approximate_inverse(r, z); }};
  const linalg::LinearMap loaded = [&](std::span<const double> x, std::span<double> y) {
    of.b(x, y);
    of.a(x, of_stress);
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += BucklingEstimate::low * of_stress[i];
  };
  modes::Curvature found =
      modes::look_for_negative_curvature(mesh.comm, loaded, of.precondition, force, shown_at, most_searches);
  if (!found.is_negative) return {.factor = 0, .iterations = found.iterations};
  const auto enough = [](const std::vector<double>& rho) {
    return rho.size() > settled && rho[rho.size() - 1 - settled] - rho.back() < settled_part * -rho.back();
  };
  const modes::LowestQuotient least =
      modes::lowest_quotient(mesh.comm, of, std::move(found.x), most_refinements, enough);  // -1 / lambda
  return {-1 / least.value, found.iterations + least.iterations};
}

}  // namespace couplet::solid
