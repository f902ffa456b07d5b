// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/parameter_checks.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/fv/expression.hpp"

namespace couplet::solid {
namespace {

/// Of any condition, those of parts of patches too.
template <class Test>
bool any_condition(const SolidParameters& p, const Test& test) {
  return std::any_of(p.boundaries.begin(), p.boundaries.end(), [&](const auto& entry) {
    const auto& parts = entry.second.parts;
    return test(entry.second) || std::any_of(parts.begin(), parts.end(), test);
  });
}

bool has_interface(const SolidParameters& p) { return any_condition(p, is_interface); }

/// Whether a condition of any kind keeps some displacement from being free.
bool is_held(const SolidParameters& p) {
  return any_condition(
      p, [](const SolidCondition& c) { return (!is_load(c) || is_interface(c)) && !has_no_energy(c); });
}

/// What the thesis's own method at finite strain cannot have, each with the key to change.
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

/// What an analysis without inertia, or without a beginning, cannot have.
void check_motion(config::Section& s, SolidParameters& p) {
  s.check(
      [&] {
        return p.damping && p.analysis == SolidParameters::Analysis::static_
                   ? "damping has no effect in a static analysis; remove it"
                   : "";
      },
      "damping");
  s.check(
      [&] {
        return p.time_scheme.type != time::TimeScheme::trapezoidal &&
                       p.analysis == SolidParameters::Analysis::static_
                   ? "a static analysis has no inertia to integrate in time; remove it"
                   : "";
      },
      "time-scheme");
  s.check(
      [&] {
        return !p.initial_velocity.empty() && p.analysis != SolidParameters::Analysis::dynamic
                   ? "it requires 'analysis: dynamic'; remove it"
                   : "";
      },
      "initial-velocity");
}

}  // namespace

void check_together(config::Section& s, SolidParameters& p) {
  const auto check_components = [&](const char* key, const std::vector<config::ExpressionText>& texts) {
    s.check([&] { return texts.empty() ? std::string() : fv::problem_of(texts, p.dimension); }, key);
  };
  check_components("body-force", p.body_force);
  check_components("initial-velocity", p.initial_velocity);
  s.check(
      [&] {
        return p.gravity.empty() || std::ssize(p.gravity) == p.dimension
                   ? std::string()
                   : fmt::format("{} components are given, but the {}-dimensional scene needs {}",
                                 p.gravity.size(), p.dimension, p.dimension);
      },
      "gravity");
  check_motion(s, p);
  s.check(
      [&] {
        return p.interface_data && p.analysis != SolidParameters::Analysis::thermal && !has_interface(p)
                   ? "no patch is an interface: set 'type: interface' for one, or remove this section"
                   : "";
      },
      "interface");
  s.check(
      [&] {
        return p.boundaries.empty() && p.analysis != SolidParameters::Analysis::thermal
                   ? "each patch of the mesh needs an entry"
                   : "";
      },
      "boundaries");
  s.check(
      [&] {
        return p.analysis != SolidParameters::Analysis::static_ || is_held(p)
                   ? ""
                   : "no patch supports the solid in this static analysis: at least one must be fixed, "
                     "supported, sprung or a plane of symmetry";
      },
      "boundaries");
  s.check(
      [&] {
        return p.step_control && p.analysis != SolidParameters::Analysis::dynamic
                   ? "a static analysis has no time error to control; remove it"
                   : "";
      },
      "time-step-control");
}

/// What a sheet in plane stress cannot have at finite strain.
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
      "boundaries",
      [](const SolidParameters& q) {
        return any_condition(q, [](const SolidCondition& c) {
          return c.type == SolidCondition::Type::pressure ||
                 c.type == SolidCondition::Type::hydrostatic_pressure;
        });
      },
      "a pressure on the edge of a sheet in plane stress at finite strain would act on its present "
      "thickness, which is not supported; use 'traction' (per undeformed area), or model the sheet in 3-D");
}

/// What finite strain cannot have, each with the key to change.
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
  s.check(
      [&p]() -> std::string {
        const bool fits = has_finite_strain(p) && p.analysis == SolidParameters::Analysis::dynamic &&
                          p.time_scheme.type == time::TimeScheme::trapezoidal;
        return p.energy_momentum && !fits
                   ? "it requires 'kinematics: finite-strain', 'analysis: dynamic' and 'time-scheme: {type: "
                     "trapezoidal}'"
                   : "";
      },
      "energy-momentum");
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
  s.check(
      [&p]() -> std::string {
        for (const SolidMaterial& m : materials_of(p))
          if (!has_finite_strain(p) && (!m.law.empty() || !m.law_coefficients.empty()))
            return "a law requires 'kinematics: finite-strain'";
        return "";
      },
      p.materials.empty() ? "material" : "materials");
  refuse("material", has_tables,
         "finite strain does not support tables of the elastic constants over temperature");
  refuse("output", p.output.spectrum || p.output.modes > 0 || p.output.buckling > 0,
         "'spectrum', 'modes' and 'buckling' require the linear solid; use small-strain");
}

void check_buckling(config::Section& s, SolidParameters& p) {
  s.check(
      [&p]() -> std::string {
        if (p.output.buckling == 0) return "";
        if (p.analysis != SolidParameters::Analysis::static_)
          return "'buckling' requires a static analysis: 'analysis: buckling' or 'static'";
        using FaceGradient = MethodParameters::FaceGradient;
        const FaceGradient chosen = p.method.face_gradient;
        return chosen == FaceGradient::automatic || chosen == FaceGradient::symmetric
                   ? ""
                   : "'buckling' requires 'solution-method: {face-gradient: symmetric}' (or 'auto'): the "
                     "stiffness of the other face gradients is not symmetric";
      },
      "output");
}

bool has_rigid_patch(const SolidParameters& p) { return any_condition(p, is_rigid); }

/// What a patch that moves as a rigid body cannot have, each with the key to change.
void check_rigid_patches(config::Section& s, SolidParameters& p) {
  using Method = MethodParameters;
  const auto refuse = [&](const char* key, bool is_wrong, const char* why) {
    s.check([&p, is_wrong, why] { return has_rigid_patch(p) && is_wrong ? std::string(why) : std::string(); },
            key);
  };
  refuse(
      "kinematics", has_finite_strain(p),
      "a remote-load with 'coupling: rigid' is limited to small rotations; use 'coupling: distributing' at "
      "finite strain");
  const bool is_gradient = p.method.face_gradient == Method::FaceGradient::symmetric ||
                           p.method.face_gradient == Method::FaceGradient::automatic;
  const bool is_method =
      p.method.type == Method::Type::newton_krylov || p.method.type == Method::Type::automatic;
  refuse("solution-method",
         !is_gradient || !is_method || p.method.preconditioner == Method::Preconditioner::mixed ||
             !symmetric_suits(p),
         "a remote-load with 'coupling: rigid' requires 'face-gradient: symmetric' and 'type: newton-krylov' "
         "(or 'auto') without 'preconditioner: mixed' and 'zero-normal-gradient'");
  refuse("output", p.output.spectrum || p.output.modes > 0 || p.output.large_strain_estimate,
         "'spectrum', 'modes' and 'large-strain-estimate' do not support a remote-load with 'coupling: "
         "rigid'");
}

void check_large_strain_estimate(config::Section& s, SolidParameters& p) {
  s.check(
      [&p]() -> std::string {
        if (!p.output.large_strain_estimate) return "";
        if (p.analysis != SolidParameters::Analysis::static_ || has_finite_strain(p))
          return "'large-strain-estimate' requires a linear static analysis: 'analysis: static' without "
                 "'kinematics: finite-strain'";
        if (p.dimension == 2 && p.plane == SolidParameters::Plane::stress)
          return "'large-strain-estimate' supports plane strain only; model the sheet in 3-D";
        if (has_orthotropic(p) || p.expansion)
          return "'large-strain-estimate' supports neither orthotropic materials nor thermal strain";
        MethodParameters any = p.method;
        any.type = MethodParameters::Type::automatic;
        SolidParameters q = p;
        q.method = any;
        return symmetric_suits(q) ? "" : "'large-strain-estimate' does not support 'zero-normal-gradient'";
      },
      "output");
}

/// What an elastic matrix cannot have, each with the key to change.
void check_orthotropic(config::Section& s, SolidParameters& p) {
  using Method = MethodParameters;
  const auto refuse = [&](const char* key, bool is_wrong, const char* why) {
    s.check([&p, is_wrong, why] { return has_orthotropic(p) && is_wrong ? std::string(why) : std::string(); },
            key);
  };
  refuse("kinematics", has_finite_strain(p),
         "an orthotropic material is linear; finite strain supports only the laws of docs/large-strain.md");
  refuse("thermal-expansion", p.expansion.has_value(),
         "an orthotropic material does not support thermal "
         "strain");
  refuse("solution-method",
         p.method.type == Method::Type::segregated || p.method.type == Method::Type::block_coupled ||
             p.method.face_gradient == Method::FaceGradient::thesis ||
             p.method.face_gradient == Method::FaceGradient::corrected ||
             p.method.volume_strain == Method::VolumeStrain::cells ||
             p.method.volume_strain == Method::VolumeStrain::shared,
         "an orthotropic material requires 'face-gradient: symmetric' (or 'auto'), 'type: newton-krylov' (or "
         "'auto') and the volume strain of the faces");
  s.check(
      [&p]() -> std::string {
        for (const SolidMaterial& m : materials_of(p))
          if (m.orthotropic && (m.heat.youngs_modulus || m.heat.poissons_ratio))
            return "an orthotropic material does not support tables of the elastic constants over "
                   "temperature";
        return "";
      },
      p.materials.empty() ? "material" : "materials");
  s.check(
      [&p]() -> std::string {
        for (const SolidMaterial& m : materials_of(p)) {
          if (!m.orthotropic) continue;
          if (!m.orthotropic->first_axis.empty() && std::ssize(m.orthotropic->first_axis) != p.dimension)
            return fmt::format("'orthotropic.first-axis' has {} components, but the scene has {}",
                               m.orthotropic->first_axis.size(), p.dimension);
          if (p.dimension == 2 && !m.orthotropic->second_axis.empty())
            return "in two dimensions 'orthotropic.second-axis' follows from the first (rotated by 90 "
                   "degrees); remove it";
          if (p.dimension == 3 && !m.orthotropic->second_axis.empty() &&
              m.orthotropic->second_axis.size() != 3)
            return "'orthotropic.second-axis' needs three components";
        }
        return "";
      },
      p.materials.empty() ? "material" : "materials");
}

}  // namespace couplet::solid
