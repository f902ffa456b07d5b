// SPDX-License-Identifier: Apache-2.0
// Settings incompatible with large strain, reported at the key to change.
#include <algorithm>

#include "solid_solver/parameters/parameter_checks.hpp"

namespace couplet::solid {
namespace {

bool presses(const SolidParameters& p) {
  return std::ranges::any_of(p.boundaries, [&](const auto& entry) {
    return is_pressure(entry.second) || std::ranges::any_of(entry.second.parts, is_pressure);
  });
}

/// Settings incompatible with the thesis's own method at finite strain, reported at the key to change.
void check_updated_lagrangian(config::Section& s, SolidParameters& p) {
  using Method = MethodParameters;
  const auto refuse = [&](const char* key, bool is_wrong, const char* why) {
    s.check([&p, is_wrong,
             why] { return is_updated_lagrangian(p) && is_wrong ? std::string(why) : std::string(); },
            key);
  };
  refuse(
      "solution-method", p.method.face_gradient == Method::FaceGradient::symmetric,
      "'type: segregated' at finite strain is the updated-Lagrangian method on 'face-gradient: thesis' with "
      "the volume strain of the faces; the symmetric gradient requires 'type: newton-krylov' (or 'auto')");
  refuse("materials", p.materials.size() > 1,
         "'solution-method: {type: segregated}' at finite strain supports one material only; use 'type: "
         "newton-krylov' (or 'auto')");
  refuse("thermal-expansion", p.expansion.has_value(),
         "'solution-method: {type: segregated}' at finite strain has no thermal strain; use 'type: "
         "newton-krylov' (or 'auto')");
  refuse("energy-momentum", p.energy_momentum,
         "'solution-method: {type: segregated}' at finite strain has no energy-momentum stress; use 'type: "
         "newton-krylov'");
  refuse(
      "output", p.output.energies,
      "'solution-method: {type: segregated}' at finite strain writes no energies; use 'type: newton-krylov' "
      "(or 'auto')");
}

/// Settings incompatible with a sheet in plane stress at finite strain.
void check_finite_sheet(config::Section& s, SolidParameters& p) {
  const auto refuse = [&](const char* key, const auto& is_wrong, const char* why) {
    s.check(
        [&p, is_wrong, why] {
          const bool is_sheet =
              has_finite_strain(p) && p.dimension == 2 && p.plane == SolidParameters::Plane::stress;
          return is_sheet && is_wrong(p) ? std::string(why) : std::string();
        },
        key);
  };
  refuse("plane", is_updated_lagrangian,
         "'solution-method: {type: segregated}' at finite strain supports plane strain only; use 'type: "
         "newton-krylov' (or 'auto')");
  refuse(
      "solution-method",
      [](const SolidParameters& q) {
        return q.method.volume_strain == MethodParameters::VolumeStrain::cells;
      },
      "plane stress at finite strain has the volume strain of the faces, which does not lock there; use "
      "'volume-strain: faces' (or 'auto')");
  refuse(
      "energy-momentum", [](const SolidParameters& q) { return q.energy_momentum; },
      "its stress supports plane strain only; model the sheet in 3-D, or remove it");
  refuse(
      "boundaries", [](const SolidParameters& q) { return presses(q); },
      "a pressure on the edge of a sheet in plane stress at finite strain would act on its present "
      "thickness, which is not supported; use 'traction' (per undeformed area), or model the sheet in 3-D");
}

/// A law requires large strain; the energy-momentum stress requires one time scheme.
void check_law(config::Section& s, SolidParameters& p) {
  s.check(
      [&p]() -> std::string {
        for (const SolidMaterial& m : materials_of(p))
          if (!has_finite_strain(p) && (!m.law.empty() || !m.law_coefficients.empty()))
            return "a law requires 'kinematics: finite-strain'";
        return "";
      },
      p.materials.empty() ? "material" : "materials");
  s.check(
      [&p]() -> std::string {
        const bool fits = has_finite_strain(p) && p.analysis == SolidParameters::Analysis::dynamic &&
                          scheme_of(p).type == time::TimeScheme::trapezoidal;
        return p.energy_momentum && !fits
                   ? "it requires 'kinematics: finite-strain', 'analysis: dynamic' and 'time-scheme: {type: "
                     "trapezoidal}'"
                   : "";
      },
      "energy-momentum");
}

}  // namespace

/// Settings incompatible with finite strain, reported at the key to change.
void check_finite_strain(config::Section& s, SolidParameters& p) {
  using Method = MethodParameters;
  const auto refuse = [&](const char* key, bool is_wrong, const char* why) {
    s.check(
        [&p, is_wrong, why] { return has_finite_strain(p) && is_wrong ? std::string(why) : std::string(); },
        key);
  };
  const bool is_dynamic = p.analysis == SolidParameters::Analysis::dynamic;
  refuse("solution-method", p.method.volume_strain == MethodParameters::VolumeStrain::shared,
         "finite strain supports 'volume-strain: faces' or 'cells', but not 'shared'");
  refuse(
      "solution-method", p.method.preconditioner == MethodParameters::Preconditioner::mixed,
      "'preconditioner: mixed' is for small strain; at finite strain Newton's method uses cell pressures by "
      "itself from nu = 0.48");
  check_finite_sheet(s, p);
  const bool expands = p.expansion.has_value();
  refuse("thermoelastic-coupling", p.thermoelastic_coupling,
         "finite strain has thermal strain, but not the heat of deformation; use small-strain, or remove it");
  refuse("energy-momentum", expands && p.energy_momentum,
         "its stress conserves energy at constant temperature only; remove it, or 'thermal-expansion'");
  refuse("output", expands && p.output.energies,
         "'energies' at finite strain does not count the work of thermal strain; remove it");
  refuse("damping", is_dynamic && p.damping && p.damping->stiffness > 0,
         "'stiffness' damps rigid rotations at finite strain; use 'mass', or the dissipation of "
         "'time-scheme'");
  refuse("interface", p.interface_data && p.interface_data->load == InterfaceData::Load::pressure,
         "finite strain requires forces; 'load: pressure' would not follow the surface");
  refuse("time-step-control", p.step_control.has_value(), "it estimates the error of the linear solid only");
  const bool is_segregated = p.method.type == Method::Type::segregated;
  refuse("solution-method",
         p.method.type == Method::Type::block_coupled ||
             p.method.face_gradient == Method::FaceGradient::corrected ||
             (!is_segregated && p.method.face_gradient == Method::FaceGradient::thesis),
         "finite strain is solved by Newton's method on 'face-gradient: symmetric' ('type: newton-krylov' or "
         "'auto'), or by 'type: segregated' on 'face-gradient: thesis'");
  check_updated_lagrangian(s, p);
  bool has_tables = false;
  for (const SolidMaterial& m : materials_of(p))
    has_tables = has_tables || m.heat.youngs_modulus || m.heat.poissons_ratio;
  check_law(s, p);
  refuse("material", has_tables,
         "finite strain does not support tables of the elastic constants over temperature");
  refuse("output", p.output.spectrum || p.output.modes > 0 || p.output.buckling > 0,
         "'spectrum', 'modes' and 'buckling' require the linear solid; use small-strain");
}

}  // namespace couplet::solid
