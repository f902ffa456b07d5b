// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/diagnostics/neglected.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/csv/csv_reader.hpp"
#include "solid_solver/effects.hpp"

namespace couplet::solid {
namespace {

using P = SolidParameters;

bool deforms(const P& p) { return p.analysis != P::Analysis::thermal; }

/// Largest constant expansion coefficient in the case [1/K].
std::optional<double> largest_expansion(const P& p) {
  std::optional<double> largest;
  for (const SolidMaterial& m : materials_of(p))
    if (m.heat.expansion)
      if (const auto given = csv::number_of(m.heat.expansion->text))
        largest = std::max(largest.value_or(0), std::abs(*given));
  return largest;
}

/// Relative change of a displacement: 0.4 times the squared tip rotation of a cantilever (elastica; the norm
/// of the gradient is sqrt(2) times the rotation), about the strain of a bar, and 1/(f - 1) for lateral
/// motion under 1/f of the buckling load.
double share_of_geometry(const Deformation& d, const std::optional<LargeStrainEstimate>& large_strain,
                         double buckling_factor) {
  constexpr double all = 10;  // of a load beyond the buckling load nothing is left
  if (large_strain) return large_strain->is_known() ? large_strain->change : all;
  const double strain = std::isnan(d.strain) ? 0 : d.strain;
  const double share = std::min(1., 0.2 * d.gradient * d.gradient + 0.8 * strain);
  if (std::isnan(buckling_factor)) return share;
  return std::max(share, buckling_factor > 1 + 1 / all ? 1 / (buckling_factor - 1) : all);
}

}  // namespace

// The static response to a load of angular frequency w has a relative error r = inertia/load = (w/w_1)^2 if
// that is small, and is useless otherwise: a sudden load moves a body twice as far.
Opinion neglected_inertia(const P& p, double inertia_over_load) {
  // Static steps at large strain are load steps, so t is not a time.
  if (p.analysis != P::Analysis::static_ || has_finite_strain(p)) return {};
  return diagnostics::finding_of({.effect = "inertia",
                                  .number = inertia_over_load,
                                  .limit = 0.01,
                                  .what = fmt::format("inertia / load = {:.2g}", inertia_over_load),
                                  .advice = "use 'analysis: dynamic'",
                                  .share = std::min(inertia_over_load, 1.)});
}

// In slow motion, the kinetic energy is (w/w_1)^2 of the strain energy.
Opinion spare_inertia(double kinetic_over_strain, double steps) {
  if (!(steps > 1) || kinetic_over_strain > 1e-3) return {};
  return diagnostics::finding_of(
      {.effect = "inertia",
       .number = kinetic_over_strain,
       .limit = 1e-3,
       .what =
           fmt::format("max kinetic / largest strain energy = {:.2g}; 'analysis: static' takes one step for "
                       "the final state",
                       kinetic_over_strain),
       .left_out = false,
       .is_spare = true,
       .saves = 1 - 1 / steps});
}

// In linear theory the stretch of a fiber that rotates by phi without strain has the error phi^2/2. For a
// gradient of 0.02 that is a fiftieth of the strain itself.
Opinion neglected_geometry(const P& p, const Deformation& d,
                           const std::optional<LargeStrainEstimate>& large_strain, double buckling_factor) {
  if (!deforms(p) || has_finite_strain(p)) return {};
  const std::string parts =
      std::isnan(d.strain)
          ? ""
          : fmt::format(" (last: strain {:.2g}, rotation {:.2g} degrees)", d.strain, 57.29578 * d.rotation);
  const double share = share_of_geometry(d, large_strain, buckling_factor);
  const bool is_estimated = large_strain || !std::isnan(buckling_factor);
  return diagnostics::finding_of(
      {.effect = "geometric non-linearity",
       .number = is_estimated ? share : d.gradient,
       .limit = is_estimated ? 0.05 : 0.02,
       .what = fmt::format("max |grad u| = {:.2g}{}{}", d.gradient, parts,
                           large_strain   ? "; " + large_strain->text()
                           : is_estimated ? fmt::format("; the buckling shape would grow by {:.2g}", share)
                                          : ""),
       .advice = !std::isnan(buckling_factor)
                     ? "lateral motion grows as the load nears the buckling load: use "
                       "'kinematics: finite-strain'"
                 : large_strain     ? "use 'kinematics: finite-strain'"
                 : d.gradient < 0.1 ? "expect errors of a few per cent"
                                    : "the result holds for linear theory, not for the body: use "
                                      "'kinematics: finite-strain'",
       .share = share});
}

Opinion neglected_yielding(double share_of_yield) {
  return diagnostics::finding_of(
      {.effect = "yielding",
       .number = share_of_yield,
       .limit = 1,
       .what = fmt::format("max equivalent stress / yield strength = {:.2g}", share_of_yield),
       .advice = "the body would yield: the result is that of an elastic body; use a program with plasticity",
       .share = std::max(0., share_of_yield - 1)});
}

Opinion near_incompressibility(const P& p) {
  if (!deforms(p) || has_volume_strain_of_cells(p)) return {};
  if (p.dimension == 2 && p.plane == P::Plane::stress) return {};  // its thickness is free: no locking
  const double nu = std::max(0.0, largest_poissons_ratio(p));
  return diagnostics::finding_of(
      {.effect = "near incompressibility",
       .number = nu,
       .limit = 0.45,
       .what = fmt::format("max Poisson's ratio = {:g}", nu),
       .advice = has_orthotropic(p)
                     ? "coarse meshes may be too stiff there, and an orthotropic material has no "
                       "volume strain per cell: compare two meshes"
                     : "coarse meshes are too stiff or worse there: use 'solution-method: "
                       "{face-gradient: symmetric}' with one volume strain per cell"});
}

// Free thermal strain relative to the largest displacement gradient. Uses the material's coefficient and the
// default reference temperature of `thermal-expansion`, otherwise 1e-5 1/K over the range of temperatures,
// because the stress-free temperature is unknown.
Opinion neglected_thermal_strain(const P& p, double gradient, double range, double change) {
  if (!deforms(p) || p.expansion) return {};
  const auto own = largest_expansion(p);
  const double coefficient = own.value_or(1e-5), kelvins = own ? std::fmax(range, change) : range,
               strain = coefficient * kelvins, share = strain / std::max(gradient, 1e-300);
  return diagnostics::finding_of(
      {.effect = "thermal strain",
       .number = share,
       .limit = 0.02,
       .what = fmt::format(
           "a temperature {} of {:.3g} K would strain a free body with {:.3g} 1/K by {:.2g}; max |grad u| = {:.2g}",
           own ? "change" : "range", kelvins, coefficient, strain, gradient),
       .advice = "use 'thermal-expansion'",
       .share = share});
}

Opinion thermoelastic_coupling(const P& p, double coupling_number) {
  diagnostics::EffectFinding found{
      .effect = "thermoelastic coupling",
      .number = coupling_number,
      .limit = 0.05,
      .what = fmt::format("heat of deformation / stiffness = {:.1e}", coupling_number),
      .advice = "use 'thermoelastic-coupling: true'",
      .share = coupling_number};
  if (p.thermoelastic_coupling)
    found = {.effect = found.effect,
             .number = coupling_number,
             .limit = 0.005,
             .what = found.what,
             .left_out = false,
             .is_spare = true};
  return diagnostics::finding_of(found);
}

}  // namespace couplet::solid
