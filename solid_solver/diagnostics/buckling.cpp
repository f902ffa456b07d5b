// SPDX-License-Identifier: Apache-2.0

#include "solid_solver/diagnostics/buckling.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "common/base/text.hpp"
#include "common/elasticity/finite/finite_kernel.hpp"
#include "common/io/checkpoint.hpp"
#include "common/modes/pencil.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/boundary/checks.hpp"
#include "solid_solver/diagnostics/neglected.hpp"
#include "solid_solver/method/conjugate_gradients.hpp"

namespace couplet::solid {
namespace {

// Compressive strain times (L/t)^2. A clamped column buckles at 0.2; slenderness() uses half its thickness
// for a square column, hence a fourth, with a margin. Plates and arches are far above.
constexpr double least_strain = 0.9 * 0.2 / 4 / BucklingEstimate::low;
// Tolerance of the solution in which a negative curvature of K + low K_sigma would appear.
constexpr double shown_at = 1e-3;
constexpr int most_searches = 2000, most_refinements = 40, few_refinements = 4, refinements_compared = 6;
// Factor over `low` of a load that needs no search, and changes in the refinements that show it: part of what is missing to
// such a load, and of the value.
constexpr double far_load = 4, part_of_missing = 0.1, roughly_settled = 0.5;
// Increase of compression since the last search that justifies another one.
constexpr double more_compression = 1.1;
// Largest relative change in the last refinements for a factor to be reported.
constexpr double settled_part = 0.01;

bool has_settled(const std::vector<double>& rho, double part) {
  return rho.size() > refinements_compared &&
         rho[rho.size() - 1 - refinements_compared] - rho.back() < part * std::abs(rho.back());
}

double limit_of(const BucklingEstimate& found) {
  return found.factor < BucklingEstimate::imperfect ? BucklingEstimate::imperfect : BucklingEstimate::low;
}

std::string neglected(const BucklingEstimate& found) {
  return "linear theory neglects the softening by these loads" +
         (found.growth > BucklingEstimate::most_growth
              ? fmt::format(", which increases the displacement by a fraction of {:.2g}", found.growth)
              : std::string());
}

/// Components below this part of the displacement are not judged by themselves.
constexpr double least_part = 0.1;

/// |a x| / |u| / (factor - 1), RMS over cells, of the component where it is largest: a frame under its load moves sideways less
/// than it shortens. The part a of u along x is by the K-orthogonality of modes.
double growth_of(const SolidBody& body, const std::vector<double>& u, const std::vector<double>& x,
                 double factor) {
  const mesh::Mesh& mesh = body.mesh();
  if (!(factor > 1)) return std::numeric_limits<double>::infinity();
  std::vector<double> force(x.size());
  body.kernel().apply(x, {}, force);
  std::array<double, 8> sums{};  // u.Kx, x.Kx, then u^2 and x^2 of each component
  for (std::size_t i = 0; i < x.size(); ++i) sums[0] += u[i] * force[i], sums[1] += x[i] * force[i];
  const std::size_t dim = mesh.dim;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    for (std::size_t a = 0; a < dim; ++a) {
      const std::size_t i = std::size_t(c) * dim + a;
      sums[2 + a] += body.geometry().volume[c] * u[i] * u[i];
      sums[5 + a] += body.geometry().volume[c] * x[i] * x[i];
    }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);
  if (!(sums[1] > 0)) return 0;
  double largest = 0;
  for (std::size_t a = 0; a < dim; ++a)
    if (sums[2 + a] > least_part * least_part * (sums[2] + sums[3] + sums[4]))
      largest = std::max(largest, std::sqrt(sums[5 + a] / sums[2 + a]));
  return std::abs(sums[0] / sums[1]) * largest / (factor - 1);
}

}  // namespace

// A load factor that no design has; a unit is wrong.
constexpr double absurd = 0.05;

std::optional<diagnostics::Finding> dynamic_buckling_finding(const BucklingEstimate& found) {
  if (!found.matters()) return {};
  return diagnostics::Finding{
      .id = "buckling",
      .number = found.factor,
      .limit = limit_of(found),
      .sentence = fmt::format(
          "buckling: the last loads are at least {:.3g} times the buckling load (limit {:.2g}): {}",
          1 / found.factor, 1 / limit_of(found),
          found.factor < 1 ? "if these loads last, the body buckles, which linear theory does not show"
                           : neglected(found)),
      .advice = "use 'kinematics: finite-strain'"};
}

std::optional<diagnostics::Finding> buckling_finding(const BucklingEstimate& found, const char* how) {
  if (!found.matters()) return {};
  const bool holds = found.factor >= 1;
  const double limit = holds ? limit_of(found) : 1;
  return diagnostics::Finding{
      .id = "buckling",
      .severity = holds ? base::Severity::warning : base::Severity::wrong,
      .number = found.factor,
      .limit = limit,
      .sentence =
          holds ? fmt::format("buckling: load factor {}{:.3g} (limit {:g}): {}", how, found.factor, limit,
                              neglected(found))
                : fmt::format(
                      "buckling: the loads are {}{:.3g} times the buckling load (limit 1): the computed "
                      "equilibrium is unstable",
                      *how == '\0' ? "" : "at least ", 1 / found.factor),
      .advice =
          holds ? "use 'kinematics: finite-strain'; 'analysis: buckling' gives load factors and mode shapes"
          : found.factor < absurd
              ? "check the units of 'youngs-modulus', of the loads and of the mesh"
              : "reduce the loads, stiffen the body or add supports; 'analysis: buckling' gives load factors and mode shapes, "
                "and 'kinematics: finite-strain' with a small lateral load gives the post-buckling state"};
}

BucklingEstimate estimate_buckling(const SolidBody& body, const SolidFields& fields,
                                   const SolidStepper& stepper, SolutionMethod& method,
                                   double& compression_seen, bool searches) {
  const mesh::Geometry& geometry = body.geometry();
  const mesh::Mesh& mesh = body.mesh();
  const SolidState& state = stepper.state();
  elastic::Prestress prestress = prestress_of(body, fields, state.time, stepper.last_solve().interface);
  double softest = 1e300;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const elastic::LameConstants lame = body.elastic().lame(c);
    softest = std::min(softest, lame.mu * (3 * lame.lambda + 2 * lame.mu) / (lame.lambda + lame.mu));
  }
  const double here = compression(mesh, prestress), ratio = slenderness(mesh, geometry);
  if (!(here > more_compression * compression_seen)) return {};
  if (!(here / parallel::min(mesh.comm, softest) * ratio * ratio >= least_strain)) return {};
  // Given as forces, to excite soft motions: errors in stiff ones would stop the iteration earlier.
  const std::vector<double> force = body.any_start();
  std::vector<double> of_stress(force.size());
  if (!method.approximate_inverse(force, of_stress)) return {};
  compression_seen = here;
  elastic::StressStiffness stress(mesh, body.elastic(), std::move(prestress));
  const modes::Pencil of{
      .comm = mesh.comm,
      .n = force.size(),
      .k = [&](std::span<const double> x, std::span<double> y) { stress.apply(x, y); },
      .m = [&](std::span<const double> x, std::span<double> y) { body.kernel().apply(x, {}, y); },
      .solve = [&](std::span<const double> r, std::span<double> z) { method.approximate_inverse(r, z); }};
  const auto look = [&](double load) {
    const linalg::LinearMap loaded = [&, load](std::span<const double> x, std::span<double> y) {
      of.m(x, y);
      of.k(x, of_stress);
      for (std::size_t i = 0; i < y.size(); ++i) y[i] += load * of_stress[i];
    };
    return modes::find_negative_curvature(mesh.comm, loaded, of.solve, force, shown_at, most_searches);
  };
  // Only a solve shows that no motion at all is soft, but refinements that settle tell that none is anywhere near.
  const double near = -1 / (far_load * BucklingEstimate::low);
  const auto told = [&](const std::vector<double>& rho) {
    if (rho.back() < near) return has_settled(rho, settled_part);
    const double missing = part_of_missing * (rho.back() - near) / std::abs(rho.back());
    return has_settled(rho, std::min(missing, roughly_settled));
  };
  // -1 / lambda
  modes::LowestQuotient least =
      modes::lowest_quotient(of, of_stress, searches ? most_refinements : few_refinements, told);
  if (!searches && least.value > -1 / BucklingEstimate::low)
    return {.factor = 0, .iterations = least.iterations};
  if (searches && least.value > near && least.iterations < most_refinements)
    return {.factor = 0, .iterations = least.iterations};
  if (searches && (least.value > -1 / BucklingEstimate::low || least.iterations == most_refinements)) {
    modes::Curvature found = look(BucklingEstimate::low);
    if (!found.is_negative) return {.factor = 0, .iterations = found.iterations};
    // Fewer motions are soft under less load, so this one is closer to the softest.
    if (modes::Curvature closer = look(BucklingEstimate::imperfect); closer.is_negative) {
      closer.iterations += found.iterations;
      found = std::move(closer);
    }
    least = modes::lowest_quotient(of, found.x, most_refinements, told);
    least.iterations += found.iterations;
  }
  const double factor = -1 / least.value;
  return {.factor = factor,
          .growth = growth_of(body, body.unknowns_of(state.cell_u, state.face_u), least.x, factor),
          .iterations = least.iterations};
}

void LinearBuckling::observe(diagnostics::Report& report) {
  if (!view_.body.is_dynamic()) see(report);
}

void LinearBuckling::conclude(diagnostics::Report& report) {
  if (view_.body.is_dynamic()) see(report);
  const auto factor = view_.output.buckling_factor();
  if (factor && !view_.body.parameters().seeks_buckling)
    add(report, buckling_finding({.factor = *factor}, ""));
}

void LinearBuckling::visit(io::Archive& archive) { archive.common("buckling", factor_, compression_seen_); }

double LinearBuckling::factor() const {
  return factor_ < BucklingEstimate::low ? factor_ : std::numeric_limits<double>::quiet_NaN();
}

void LinearBuckling::see(diagnostics::Report& report) {
  const SolidBody& body = view_.body;
  SolutionMethod* method = view_.stepper.method();
  if (!method || !body.kernel().is_symmetric() || is_axisymmetric(body.elastic()) ||
      body.parameters().output.buckling > 0 || body.parameters().output.modes > 0)
    return;
  for (const FreeMotion& free : free_motions(body.mesh(), body.elastic()))
    if (!free.modes.empty())
      return report.sentences.push_back(fmt::format(
          "the solid is not fully supported: {}; a body that can move freely has no buckling load.",
          base::join(free.modes)));
  const BucklingEstimate found =
      estimate_buckling(body, view_.fields, view_.stepper, *method, compression_seen_, searches_);
  if (!found.matters()) return;
  factor_ = std::min(factor_, found.factor);
  add(report, body.is_dynamic() ? dynamic_buckling_finding(found) : buckling_finding(found, "at most "));
}

}  // namespace couplet::solid
