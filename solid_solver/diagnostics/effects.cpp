// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/diagnostics/effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/csv/csv_reader.hpp"
#include "common/diagnostics/effect_rows.hpp"
#include "solid_solver/effects/effect_cards.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {
namespace {

using P = SolidParameters;
using E = SolidEvidence;
using V = std::optional<diagnostics::EffectFinding>;

bool moves(const P& p) { return p.analysis == P::Analysis::dynamic; }
bool deforms(const P& p) { return p.analysis != P::Analysis::thermal; }

V finding(double number, double limit, std::string what, std::string advice,
          double share = std::numeric_limits<double>::quiet_NaN()) {
  if (std::isnan(number)) return {};
  return diagnostics::EffectFinding{
      .number = number, .limit = limit, .what = std::move(what), .advice = std::move(advice), .share = share};
}

/// Gives advice where an effect that is on does next to nothing.
V in_vain(double number, double threshold, std::string sentence, double saves) {
  if (std::isnan(number)) return {};
  return diagnostics::EffectFinding{
      .number = number, .limit = threshold, .what = std::move(sentence), .saves = saves};
}

// A static answer to a load of circular frequency w is too large by r = inertia / load = (w / w_1)^2 of itself where that is
// small, and all of it is wrong where it is not: a load that comes at once moves a body twice as far.
V judge_inertia(const P& p, const E& e) {
  if (!deforms(p) || has_finite_strain(p)) return {};  // whose static steps are load steps: t is no time
  return finding(e.inertia_over_load, 0.01, fmt::format("inertia / load = {:.2g}", e.inertia_over_load),
                 "use 'analysis: dynamic'", std::min(e.inertia_over_load, 1.));
}

// A body that moves slowly enough holds next to no kinetic energy beside its strain energy, (w / w_1)^2 of it.
V spare_inertia(const P& p, const E& e) {
  if (!moves(p) || !(e.dynamic_steps > 1)) return {};
  return in_vain(
      e.kinetic_over_strain, 1e-3,
      fmt::format("max kinetic / largest strain energy = {:.2g}; 'analysis: static' takes one step for "
                  "the final state",
                  e.kinetic_over_strain),
      1 - 1 / e.dynamic_steps);
}

// The stretch along a fibre that turns by an angle phi without straining is off by phi^2/2 in the linear
// theory; a gradient of 0.02 is a fiftieth of that in the strain itself.
// Its share of a displacement: 0.4 of the square of the rotation at the tip of a cantilever (elastica; the norm of the
// gradient is sqrt(2) times the rotation), about the strain of a bar, and 1/(f - 1) where a load of 1/f of the buckling load makes lateral motion
// grow.
double share_of_geometry(const E& e) {
  constexpr double all = 10;  // of a load beyond the buckling load nothing is left
  if (e.large_strain_estimated) return std::isnan(e.large_strain_change) ? all : e.large_strain_change;
  const double strain = std::isnan(e.largest_strain) ? 0 : e.largest_strain;
  const double share = std::min(1., 0.2 * e.largest_gradient * e.largest_gradient + 0.8 * strain);
  if (std::isnan(e.buckling_factor)) return share;
  return std::max(share, e.buckling_factor > 1 + 1 / all ? 1 / (e.buckling_factor - 1) : all);
}

V judge_geometry(const P& p, const E& e) {
  if (!deforms(p) || has_finite_strain(p)) return {};
  const double g = e.largest_gradient;
  const std::string parts = std::isnan(e.largest_strain)
                                ? ""
                                : fmt::format(" (last: strain {:.2g}, rotation {:.2g} degrees)",
                                              e.largest_strain, 57.29578 * e.largest_rotation);
  const std::string change = e.large_strain.empty() ? "" : "; " + e.large_strain;
  return finding(g, 0.02, fmt::format("max |grad u| = {:.2g}{}{}", g, parts, change),
                 !std::isnan(e.buckling_factor)
                     ? "lateral motion grows as the load nears the buckling load: use 'kinematics: "
                       "finite-strain'"
                 : g < 0.1 ? "expect errors of a few per cent"
                           : "the result holds for linear theory, not for the body: use 'kinematics: "
                             "finite-strain'",
                 share_of_geometry(e));
}

V judge_yield(const P& p, const E& e) {
  if (!deforms(p)) return {};
  return finding(e.share_of_yield, 1,
                 fmt::format("max equivalent stress / yield strength = {:.2g}", e.share_of_yield),
                 "the body would yield: the result is that of an elastic body; use a program with plasticity",
                 std::max(0., e.share_of_yield - 1));
}

V judge_incompressibility(const P& p, const E&) {
  if (!deforms(p) || has_volume_strain_of_cells(p)) return {};
  if (p.dimension == 2 && p.plane == P::Plane::stress) return {};  // its thickness is free: no locking
  const double nu = std::max(0.0, largest_poissons_ratio(p));
  return finding(
      nu, 0.45, fmt::format("max Poisson's ratio = {:g}", nu),
      has_orthotropic(p)
          ? "coarse meshes may be too stiff there, and an orthotropic material has no volume strain per "
            "cell: compare two meshes"
          : "coarse meshes are too stiff or worse there: use 'solution-method: {face-gradient: symmetric}' "
            "with one volume strain per cell");
}

/// The largest coefficient that the case gives as a number [1/K].
std::optional<double> largest_expansion(const P& p) {
  std::optional<double> largest;
  for (const SolidMaterial& m : materials_of(p))
    if (m.heat.expansion)
      if (const auto given = csv::number_of(m.heat.expansion->text))
        largest = std::max(largest.value_or(0), std::abs(*given));
  return largest;
}

// The strain of a free body beside the largest gradient of the displacement: with the material's own coefficient from the reference
// temperature that `thermal-expansion` would have by default, else with 1e-5 1/K over the range of temperatures, since nobody says then
// at which one the body is free of stress.
V judge_thermal_strain(const P& p, const E& e) {
  if (!deforms(p)) return {};
  const auto own = largest_expansion(p);
  const double coefficient = own.value_or(1e-5),
               change = own ? std::fmax(e.temperature_range, e.temperature_change) : e.temperature_range,
               strain = coefficient * change;
  return finding(
      strain / std::max(e.largest_gradient, 1e-300), 0.02,
      fmt::format(
          "a temperature {} of {:.3g} K would strain a free body with {:.3g} 1/K by {:.2g}; max |grad u| = {:.2g}",
          own ? "change" : "range", change, coefficient, strain, e.largest_gradient),
      "use 'thermal-expansion'", strain / std::max(e.largest_gradient, 1e-300));
}

V judge_thermoelastic(const P&, const E& e) {
  return finding(e.coupling_number, 0.05,
                 fmt::format("heat of deformation / stiffness = {:.1e}", e.coupling_number),
                 "use 'thermoelastic-coupling: true'", e.coupling_number);
}

V spare_thermoelastic(const P&, const E& e) {
  return in_vain(e.coupling_number, 0.005,
                 fmt::format("heat of deformation / stiffness = {:.1e}", e.coupling_number),
                 diagnostics::saved_share("solid_solver", "thermoelastic coupling"));
}

using Row = diagnostics::EffectRow<P, E>;
constexpr std::array rows{Row{"inertia", judge_inertia},
                          Row{"inertia", spare_inertia, true},
                          Row{"geometric non-linearity", judge_geometry},
                          Row{"yielding", judge_yield},
                          Row{"near incompressibility", judge_incompressibility},
                          Row{"thermal strain", judge_thermal_strain},
                          Row{"thermoelastic coupling", judge_thermoelastic},
                          Row{"thermoelastic coupling", spare_thermoelastic, true}};

}  // namespace

std::vector<diagnostics::Finding> effect_findings(const SolidParameters& parameters,
                                                  const SolidEvidence& evidence) {
  return diagnostics::effect_findings(std::span<const Row>(rows), solid_effect_cards(), parameters, evidence);
}

}  // namespace couplet::solid
