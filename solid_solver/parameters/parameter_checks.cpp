// SPDX-License-Identifier: Apache-2.0

#include "solid_solver/parameters/parameter_checks.hpp"

#include <fmt/format.h>
#include <algorithm>

namespace couplet::solid {
namespace {

/// Tests all conditions, including those of parts of patches.
template <class Test>
bool any_condition(const SolidParameters& p, const Test& test) {
  return std::any_of(p.boundaries.begin(), p.boundaries.end(), [&](const auto& entry) {
    const auto& parts = entry.second.parts;
    return test(entry.second) || std::any_of(parts.begin(), parts.end(), test);
  });
}

bool has_interface(const SolidParameters& p) { return any_condition(p, is_interface); }

/// True if some condition holds a displacement.
bool is_held(const SolidParameters& p) {
  return any_condition(
      p, [](const SolidCondition& c) { return (!is_load(c) || is_interface(c)) && !has_no_energy(c); });
}

/// Settings incompatible with an analysis without inertia or initial state.
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
        return scheme_of(p).type != time::TimeScheme::trapezoidal &&
                       p.time_scheme.type != time::TimeScheme::automatic &&
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

/// Settings incompatible with a patch that moves as a rigid body, reported at the key to change.
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
  refuse("output", p.output.spectrum || p.output.modes > 0,
         "'spectrum' and 'modes' do not support a remote-load with 'coupling: rigid'");
}

void check_quantities(config::Section& s, SolidParameters& p) {
  s.check(
      [&p]() -> std::string {
        if (p.quantities.empty()) return "";
        const auto is_of_heat = [](const auto& q) {
          return q.second.field == "heat" || q.second.field == "temperature";
        };
        if (p.analysis == SolidParameters::Analysis::thermal) {
          if (!std::ranges::all_of(p.quantities, is_of_heat))
            return "heat conduction alone has the quantities temperature (at a 'point') and heat (through a 'patch')";
          return p.heat && p.heat->analysis == HeatParameters::Analysis::steady
                     ? ""
                     : "the errors of 'quantities' are estimated with 'heat: {analysis: steady}'; 'couplet study --quantities' estimates "
                       "those of any run, by differences of coarser ones";
        }
        if (std::ranges::any_of(p.quantities, is_of_heat))
          return "temperature and heat are quantities of 'analysis: thermal'; 'couplet study --quantities' estimates those of any run, by "
                 "differences of coarser ones";
        if (p.analysis != SolidParameters::Analysis::static_ || has_finite_strain(p))
          return "the errors of 'quantities' are estimated in a linear static analysis; 'couplet study --quantities' estimates those of "
                 "any run, by differences of coarser ones";
        if (is_axisymmetric(p) || has_rigid_patch(p) || p.contact)
          return "'quantities' support neither a body of revolution, nor a patch that moves as a rigid body, nor 'contact'";
        return symmetric_suits(p) ? "" : "'quantities' require 'face-gradient: symmetric', the default";
      },
      "quantities");
}

/// Settings incompatible with contact at a seat, reported at the key to change.
void check_contact(config::Section& s, SolidParameters& p) {
  using Method = MethodParameters;
  using Analysis = SolidParameters::Analysis;
  const auto refuse = [&](const char* key, bool is_wrong, const char* why) {
    s.check([&p, is_wrong, why] { return p.contact && is_wrong ? std::string(why) : std::string(); }, key);
  };
  if (!p.contact) return;
  const auto& d = p.contact->direction;
  refuse("contact", p.analysis == Analysis::thermal, "a thermal analysis moves nothing; remove it");
  refuse("contact", p.dimension == 2 && d.size() == 3 && d[2] != 0,
         "its 'direction' must lie in the plane of a 2-dimensional scene: [x, y, 0]");
  refuse(
      "contact",
      p.analysis == Analysis::dynamic && p.contact->rule == contact::ContactRule::conserving &&
          scheme_of(p).type != time::TimeScheme::trapezoidal,
      "'rule: conserving' keeps the energy with 'time-scheme: {type: trapezoidal}' only (at finite strain with "
      "'energy-momentum: true'); use that or 'rule: midpoint'");
  refuse("plane", is_axisymmetric(p),
         "a body of revolution cannot meet a seat; model it in 3-D, or remove 'contact'");
  refuse("boundaries", has_rigid_patch(p),
         "a remote-load with 'coupling: rigid' does not go with 'contact'; use 'coupling: distributing'");
  refuse("load-stepping", p.load_stepping.type == LoadStepping::Type::arc_length,
         "arc length does not go with 'contact', whose path has corners; use steps of the load");
  const bool is_gradient = p.method.face_gradient == Method::FaceGradient::symmetric ||
                           p.method.face_gradient == Method::FaceGradient::automatic;
  const bool is_method =
      p.method.type == Method::Type::newton_krylov || p.method.type == Method::Type::automatic;
  refuse("solution-method",
         !is_gradient || !is_method || p.method.preconditioner == Method::Preconditioner::mixed ||
             !symmetric_suits(p),
         "'contact' requires 'face-gradient: symmetric' and 'type: newton-krylov' (or 'auto') without "
         "'preconditioner: mixed' and 'zero-normal-gradient'");
  refuse("output", p.output.buckling > 0, "'buckling' does not include a seat; remove it, or 'contact'");
}

/// Settings incompatible with an elastic matrix, reported at the key to change.
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

namespace {

using Method = MethodParameters;

bool has_supported_conditions(const SolidParameters& p) {
  return p.point_loads.empty() && std::ranges::all_of(p.boundaries, [](const auto& entry) {
           return can_be_revolved(entry.second) && std::ranges::all_of(entry.second.parts, can_be_revolved);
         });
}

bool has_supported_method(const SolidParameters& p) {
  return (p.method.type == Method::Type::automatic || p.method.type == Method::Type::newton_krylov) &&
         p.method.volume_strain != Method::VolumeStrain::cells &&
         p.method.volume_strain != Method::VolumeStrain::shared &&
         (p.method.face_gradient == Method::FaceGradient::automatic ||
          p.method.face_gradient == Method::FaceGradient::symmetric) &&
         (p.method.preconditioner == Method::Preconditioner::automatic ||
          p.method.preconditioner == Method::Preconditioner::factors);
}

}  // namespace

void check_axisymmetric(config::Section& s, SolidParameters& p) {
  const auto refuse = [&](const char* key, const auto& is_wrong, const char* why) {
    s.check(
        [&p, is_wrong, why] { return is_axisymmetric(p) && is_wrong(p) ? std::string(why) : std::string(); },
        key);
  };
  refuse(
      "kinematics",
      [](const SolidParameters& q) { return q.kinematics == SolidParameters::Kinematics::finite_strain; },
      "'plane: axisymmetric' supports small strain only; model a wedge in 3-D");
  refuse(
      "boundaries", [](const SolidParameters& q) { return !has_supported_conditions(q); },
      "'plane: axisymmetric' supports 'fixed-displacement', 'traction', 'pressure', 'hydrostatic-pressure', "
      "'symmetry', 'frictionless', 'roller' and 'free', without point loads; model a wedge in 3-D for others");
  refuse(
      "solution-method", [](const SolidParameters& q) { return !has_supported_method(q); },
      "'plane: axisymmetric' is solved with 'face-gradient: symmetric', 'volume-strain: faces', 'type: "
      "newton-krylov' and 'preconditioner: factors' (or 'auto' each)");
  refuse(
      "heat", [](const SolidParameters& q) { return q.heat.has_value(); },
      "'plane: axisymmetric' does not conduct heat; give 'temperature' as an expression, or model a wedge in "
      "3-D");
  refuse(
      "interface", [](const SolidParameters& q) { return q.interface_data.has_value(); },
      "'plane: axisymmetric' does not couple; model a wedge in 3-D");
  refuse(
      "output",
      [](const SolidParameters& q) {
        return q.output.spectrum || q.output.modes > 0 || q.output.buckling > 0;
      },
      "'plane: axisymmetric' supports none of 'spectrum', 'modes' and 'buckling'; "
      "model the body in 3-D");
  s.check(
      [&p]() -> std::string {
        const bool is_orthotropic = std::ranges::any_of(
            materials_of(p), [](const SolidMaterial& m) { return m.orthotropic.has_value(); });
        return is_axisymmetric(p) && is_orthotropic
                   ? "'plane: axisymmetric' supports isotropic materials only; model a wedge in 3-D"
                   : "";
      },
      p.materials.empty() ? "material" : "materials");
}

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
