// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/parameter_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "common/fv/expression.hpp"

namespace couplet::solid {
namespace {

using Analysis = SolidParameters::Analysis;
using Method = MethodParameters;

/// Reports a setting at the key to change.
void refuse(config::Section& s, const std::string& key, bool is_wrong, const std::string& why) {
  s.check([&] { return is_wrong ? why : std::string(); }, key);
}

const char* material_key(const SolidParameters& p) { return p.materials.empty() ? "material" : "materials"; }

/// True if some condition holds a displacement.
bool is_held(const SolidParameters& p) {
  return any_condition(
      p, [](const SolidCondition& c) { return (!is_load(c) || is_interface(c)) && !has_no_energy(c); });
}

/// True for the symmetric face gradient and Newton's method, chosen or left to `auto`.
bool allows_symmetric(const MethodParameters& m) {
  return (m.type == Method::Type::automatic || m.type == Method::Type::newton_krylov) &&
         (m.face_gradient == Method::FaceGradient::automatic ||
          m.face_gradient == Method::FaceGradient::symmetric);
}

/// Likewise with the volume strain of the faces.
bool allows_faces(const MethodParameters& m) {
  return allows_symmetric(m) && m.volume_strain != Method::VolumeStrain::cells &&
         m.volume_strain != Method::VolumeStrain::shared;
}

bool derives_from_energy(const SolidParameters& p) {
  return allows_symmetric(p.method) && p.method.preconditioner != Method::Preconditioner::mixed &&
         symmetric_suits(p);
}

bool has_modes(const SolidParameters& p) { return p.output.spectrum || p.output.modes > 0; }

/// All patches where a solid meets other participants exchange the same data: heat and motion, or one of them.
void refuse_unlike_interfaces(config::Section& s, const SolidParameters& p) {
  const auto conducts = [&](const std::string& patch) {
    const auto found = p.heat->boundaries.find(patch);
    return found != p.heat->boundaries.end() && found->second.type == HeatBoundary::Type::interface;
  };
  if (!p.heat || p.analysis == SolidParameters::Analysis::thermal || !any_condition(p, is_interface) ||
      std::ranges::none_of(p.heat->boundaries, [&](const auto& b) { return conducts(b.first); }))
    return;
  for (const auto& [patch, condition] : p.boundaries)
    refuse(
        s, "boundaries." + patch, is_interface(condition) != conducts(patch),
        "all patches where a solid meets other participants exchange the same data; give it 'type: interface' here and in "
        "`heat.boundaries`, or in neither");
}

}  // namespace

bool has_rigid_patch(const SolidParameters& p) { return any_condition(p, is_rigid); }

void check_together(config::Section& s, SolidParameters& p) {
  const bool is_static = p.analysis == Analysis::static_;
  refuse(s, "gravity", !p.gravity.empty() && std::ssize(p.gravity) != p.dimension,
         fmt::format("{} components are given, but the {}-dimensional case needs {}", p.gravity.size(),
                     p.dimension, p.dimension));
  refuse(s, "damping", p.damping && is_static, "damping has no effect in a static analysis; remove it");
  refuse(s, "time-scheme",
         scheme_of(p).type != time::TimeScheme::trapezoidal &&
             p.time_scheme.type != time::TimeScheme::automatic && is_static,
         "a static analysis has no inertia to integrate in time; remove it");
  refuse(s, "initial-velocity", !p.initial_velocity.empty() && p.analysis != Analysis::dynamic,
         "it requires 'analysis: dynamic'; remove it");
  refuse(s, "interface",
         p.interface_data && p.analysis != Analysis::thermal && !any_condition(p, is_interface),
         "no patch is an interface: set 'type: interface' for one, or remove this section");
  refuse(s, "boundaries", p.boundaries.empty() && p.analysis != Analysis::thermal,
         "each patch of the mesh needs an entry");
  refuse(s, "boundaries", is_static && !is_held(p),
         "no patch supports the solid in this static analysis: at least one must be fixed, supported, sprung "
         "or a plane of symmetry");
  refuse(s, "time-step-control", p.step_control && p.analysis != Analysis::dynamic,
         "a static analysis has no time error to control; remove it");
}

void check_heat(config::Section& s, SolidParameters& p) {
  const bool is_transient = p.heat && p.heat->analysis == HeatParameters::Analysis::transient;
  const bool is_received = p.interface_data && p.interface_data->temperature;
  refuse(s, "thermoelastic-coupling", p.thermoelastic_coupling && !(p.expansion && is_transient),
         "it requires a transient 'heat' and 'thermal-expansion'");
  refuse(s, "interface", is_received && (p.heat || p.temperature),
         "the temperature is received at the interface; remove 'heat' or 'temperature'");
  refuse(s, "temperature", p.heat && p.temperature, "'heat' computes the temperature; remove one of the two");
  refuse(s, "thermal-expansion", p.expansion && !p.heat && !p.temperature && !is_received,
         "thermal strain needs a temperature; add 'heat' or 'temperature'");
  refuse(s, "analysis", p.analysis == Analysis::thermal && !p.heat, "a thermal analysis needs 'heat'");
  refuse_unlike_interfaces(s, p);
  for (const SolidMaterial& m : materials_of(p))
    for (const auto& [property, is_needed, key, by] :
         {std::tuple{&m.heat.conductivity, p.heat.has_value(), "conductivity", "'heat'"},
          std::tuple{&m.heat.specific_heat, is_transient, "specific-heat", "a transient 'heat'"},
          std::tuple{&m.heat.expansion, p.expansion.has_value(), "expansion", "'thermal-expansion'"}})
      refuse(s, material_key(p), is_needed && !*property,
             fmt::format("'{}' of the material is missing; {} needs it", key, by));
}

void check_buckling(config::Section& s, SolidParameters& p) {
  if (p.output.buckling == 0) return;
  const Method::FaceGradient chosen = p.method.face_gradient;
  refuse(s, "output", p.analysis != Analysis::static_,
         "'buckling' requires a static analysis: 'analysis: buckling' or 'static'");
  refuse(
      s, "output", chosen != Method::FaceGradient::automatic && chosen != Method::FaceGradient::symmetric,
      "'buckling' requires 'solution-method: {face-gradient: symmetric}' (or 'auto'): the stiffness of the "
      "other face gradients is not symmetric");
}

void check_rigid_patches(config::Section& s, SolidParameters& p) {
  if (!has_rigid_patch(p)) return;
  refuse(
      s, "kinematics", has_finite_strain(p),
      "a remote-load with 'coupling: rigid' is limited to small rotations; use 'coupling: distributing' at "
      "finite strain");
  refuse(s, "solution-method", !derives_from_energy(p),
         "a remote-load with 'coupling: rigid' requires 'face-gradient: symmetric' and 'type: newton-krylov' "
         "(or 'auto') without 'preconditioner: mixed' and 'zero-normal-gradient'");
  refuse(s, "output", has_modes(p),
         "'spectrum' and 'modes' do not support a remote-load with 'coupling: rigid'");
}

void check_quantities(config::Section& s, SolidParameters& p) {
  s.check(
      [&p]() -> std::string {
        if (p.quantities.empty()) return "";
        const auto is_of_heat = [](const auto& q) {
          return q.second.field == "heat" || q.second.field == "temperature";
        };
        if (p.analysis == Analysis::thermal) {
          if (!std::ranges::all_of(p.quantities, is_of_heat))
            return "heat conduction alone has the quantities temperature (at a 'point') and heat (through a 'patch')";
          return p.heat && p.heat->analysis == HeatParameters::Analysis::steady
                     ? ""
                     : "the errors of 'quantities' are estimated with 'heat: {analysis: steady}'; 'couplet study --quantities' "
                       "estimates those of any run from differences between coarser runs";
        }
        if (std::ranges::any_of(p.quantities, is_of_heat))
          return "temperature and heat are quantities of 'analysis: thermal'; 'couplet study --quantities' estimates those of "
                 "any run from differences between coarser runs";
        if (p.analysis != Analysis::static_ || has_finite_strain(p))
          return "the errors of 'quantities' are estimated in a linear static analysis; 'couplet study --quantities' estimates "
                 "those of any run from differences between coarser runs";
        if (is_axisymmetric(p) || has_rigid_patch(p) || p.contact)
          return "'quantities' support neither a body of revolution, nor a patch that moves as a rigid body, nor 'contact'";
        return symmetric_suits(p) ? "" : "'quantities' require 'face-gradient: symmetric', the default";
      },
      "quantities");
}

void check_contact(config::Section& s, SolidParameters& p) {
  if (!p.contact) return;
  const auto& d = p.contact->direction;
  refuse(s, "contact", p.analysis == Analysis::thermal, "a thermal analysis computes no motion; remove it");
  refuse(s, "contact", p.dimension == 2 && d.size() == 3 && d[2] != 0,
         "its 'direction' must lie in the plane of a 2-dimensional case: [x, y, 0]");
  refuse(
      s, "contact",
      p.analysis == Analysis::dynamic && p.contact->rule == contact::ContactRule::conserving &&
          scheme_of(p).type != time::TimeScheme::trapezoidal,
      "'rule: conserving' conserves the energy only with 'time-scheme: {type: trapezoidal}' (at finite strain with "
      "'energy-momentum: true'); use that or 'rule: midpoint'");
  refuse(s, "plane", is_axisymmetric(p),
         "a body of revolution does not support contact with a seat; model it in 3-D, or remove 'contact'");
  refuse(
      s, "boundaries", has_rigid_patch(p),
      "a remote-load with 'coupling: rigid' cannot be combined with 'contact'; use 'coupling: distributing'");
  refuse(s, "load-stepping", p.load_stepping.type == LoadStepping::Type::arc_length,
         "arc length cannot be combined with 'contact', whose path has corners; use 'type: load'");
  refuse(s, "solution-method", !derives_from_energy(p),
         "'contact' requires 'face-gradient: symmetric' and 'type: newton-krylov' (or 'auto') without "
         "'preconditioner: mixed' and 'zero-normal-gradient'");
  refuse(s, "output", p.output.buckling > 0, "'buckling' does not support a seat; remove it, or 'contact'");
}

namespace {

using Texts = std::vector<config::ExpressionText>;

/// First text that depends on t; empty if none does, or it is invalid, which is reported elsewhere.
std::string first_in_time(const Texts& texts) {
  for (const config::ExpressionText& e : texts)
    if (fv::problem_of(e).empty() && fv::Expression(e).uses_time()) return e.text;
  return {};
}

Texts texts_of(const TotalLoad& load) {
  Texts all = load.force;
  all.insert(all.end(), load.moment.begin(), load.moment.end());
  all.push_back(load.level);
  return all;
}

Texts texts_of(const SolidCondition& c) {
  Texts all = texts_of(c.load);
  for (const Texts* more : {&c.value, &c.traction}) all.insert(all.end(), more->begin(), more->end());
  for (const auto& component : c.components)
    if (component) all.push_back(*component);
  all.push_back(c.pressure);
  all.push_back(c.along);
  return all;
}

std::string wrong_boundary(const SolidParameters& p, const std::string& why) {
  for (const auto& [name, b] : p.boundaries) {
    std::vector<SolidCondition> all(b.parts.begin(), b.parts.end());
    all.push_back(b);
    for (const SolidCondition& c : all) {
      if (is_interface(c))
        return fmt::format(
            "patch '{}' takes its load from the coupler, and 'load-stepping: {{type: arc-length}}' cannot scale it; "
            "use 'type: load'",
            name);
      if (const std::string text = first_in_time(texts_of(c)); !text.empty())
        return fmt::format("'{}' of patch '{}' {}", text, name, why);
    }
  }
  return {};
}

}  // namespace

void check_load_stepping(config::Section& s, SolidParameters& p) {
  if (p.load_stepping.type != LoadStepping::Type::arc_length) return;
  const std::string why =
      "depends on t; 'load-stepping: {type: arc-length}' multiplies all loads and prescribed displacements by one load "
      "factor, so they must be constant in time: give those of load factor 1";
  refuse(s, "load-stepping",
         p.analysis != Analysis::static_ || !has_finite_strain(p) || is_updated_lagrangian(p),
         "'type: arc-length' requires 'analysis: static', 'kinematics: finite-strain' and Newton's method "
         "('solution-method: {type: auto}')");
  const std::string wrong = wrong_boundary(p, why);
  refuse(s, "boundaries", !wrong.empty(), wrong);
  for (const auto& [name, load] : p.point_loads) {
    const std::string text = first_in_time(texts_of(load));
    refuse(s, "point-loads", !text.empty(), fmt::format("'{}' of '{}' {}", text, name, why));
  }
  const std::string text = first_in_time(p.body_force);
  refuse(s, "body-force", !text.empty(), fmt::format("'{}' {}", text, why));
  refuse(s, "thermal-expansion", p.expansion.has_value(),
         "thermal strain cannot be multiplied by the load factor of 'load-stepping: {type: arc-length}'; use "
         "'type: load'");
  refuse(s, "output", p.output.energies,
         "'energies' is not available with 'load-stepping: {type: arc-length}'");
}

void check_orthotropic(config::Section& s, SolidParameters& p) {
  if (!has_orthotropic(p)) return;
  refuse(s, "kinematics", has_finite_strain(p),
         "an orthotropic material is linear; finite strain supports only the laws of docs/large-strain.md");
  refuse(s, "thermal-expansion", p.expansion.has_value(),
         "an orthotropic material does not support thermal strain");
  refuse(s, "solution-method", !allows_faces(p.method),
         "an orthotropic material requires 'face-gradient: symmetric' (or 'auto'), 'type: newton-krylov' (or "
         "'auto') and the volume strain of the faces");
  const auto problem_of = [&](const SolidMaterial& m) -> std::string {
    if (!m.orthotropic) return "";
    const auto &first = m.orthotropic->first_axis, &second = m.orthotropic->second_axis;
    if (m.heat.youngs_modulus || m.heat.poissons_ratio)
      return "an orthotropic material does not support tables of the elastic constants over temperature";
    if (!first.empty() && std::ssize(first) != p.dimension)
      return fmt::format("'orthotropic.first-axis' has {} components, but the case has {} dimensions",
                         first.size(), p.dimension);
    if (p.dimension == 2 && !second.empty())
      return "in two dimensions 'orthotropic.second-axis' follows from the first (rotated by 90 degrees); "
             "remove it";
    if (p.dimension == 3 && !second.empty() && second.size() != 3)
      return "'orthotropic.second-axis' needs three components";
    return "";
  };
  for (const SolidMaterial& m : materials_of(p))
    refuse(s, material_key(p), !problem_of(m).empty(), problem_of(m));
}

void check_axisymmetric(config::Section& s, SolidParameters& p) {
  if (!is_axisymmetric(p)) return;
  refuse(s, "kinematics", p.kinematics == SolidParameters::Kinematics::finite_strain,
         "'plane: axisymmetric' supports small strain only; model a wedge in 3-D");
  refuse(
      s, "boundaries",
      !p.point_loads.empty() || any_condition(p, [](const auto& c) { return !can_be_revolved(c); }),
      "'plane: axisymmetric' supports 'fixed-displacement', 'traction', 'pressure', 'hydrostatic-pressure', "
      "'symmetry', 'frictionless', 'roller' and 'free', without point loads; model a wedge in 3-D for others");
  refuse(s, "solution-method",
         !allows_faces(p.method) || (p.method.preconditioner != Method::Preconditioner::automatic &&
                                     p.method.preconditioner != Method::Preconditioner::factors),
         "'plane: axisymmetric' is solved with 'face-gradient: symmetric', 'volume-strain: faces', 'type: "
         "newton-krylov' and 'preconditioner: factors' (or 'auto' each)");
  refuse(s, "heat", p.heat.has_value(),
         "'plane: axisymmetric' does not conduct heat; give 'temperature' as an expression, or model a wedge "
         "in 3-D");
  refuse(s, "interface", p.interface_data.has_value(),
         "'plane: axisymmetric' does not support coupling; model a wedge in 3-D");
  refuse(s, "output", has_modes(p) || p.output.buckling > 0,
         "'plane: axisymmetric' supports none of 'spectrum', 'modes' and 'buckling'; model the body in 3-D");
  refuse(s, material_key(p), has_orthotropic(p),
         "'plane: axisymmetric' supports isotropic materials only; model a wedge in 3-D");
}

namespace {

/// The thesis's own method at finite strain.
void check_updated_lagrangian(config::Section& s, SolidParameters& p) {
  if (!is_updated_lagrangian(p)) return;
  refuse(
      s, "solution-method", p.method.face_gradient == Method::FaceGradient::symmetric,
      "'type: segregated' at finite strain is the updated-Lagrangian method on 'face-gradient: thesis' with "
      "the volume strain of the faces; the symmetric gradient requires 'type: newton-krylov' (or 'auto')");
  refuse(s, "materials", p.materials.size() > 1,
         "'solution-method: {type: segregated}' at finite strain supports one material only; use 'type: "
         "newton-krylov' (or 'auto')");
  refuse(s, "thermal-expansion", p.expansion.has_value(),
         "'solution-method: {type: segregated}' at finite strain has no thermal strain; use 'type: "
         "newton-krylov' (or 'auto')");
  refuse(s, "energy-momentum", p.energy_momentum,
         "'solution-method: {type: segregated}' at finite strain has no energy-momentum stress; use 'type: "
         "newton-krylov'");
  refuse(
      s, "output", p.output.energies,
      "'solution-method: {type: segregated}' at finite strain writes no energies; use 'type: newton-krylov' "
      "(or 'auto')");
}

/// A sheet in plane stress at finite strain.
void check_finite_sheet(config::Section& s, SolidParameters& p) {
  if (!is_plane_stress(p)) return;
  refuse(s, "plane", is_updated_lagrangian(p),
         "'solution-method: {type: segregated}' at finite strain supports plane strain only; use 'type: "
         "newton-krylov' (or 'auto')");
  refuse(
      s, "solution-method", p.method.volume_strain == Method::VolumeStrain::cells,
      "plane stress at finite strain requires the volume strain of the faces, which does not lock there; use 'volume-strain: "
      "faces' (or 'auto')");
  refuse(s, "energy-momentum", p.energy_momentum,
         "its stress supports plane strain only; model the sheet in 3-D, or remove it");
  refuse(
      s, "boundaries", any_condition(p, is_pressure),
      "a pressure on the edge of a sheet in plane stress at finite strain would act on its present "
      "thickness, which is not supported; use 'traction' (per undeformed area), or model the sheet in 3-D");
}

}  // namespace

void check_finite_strain(config::Section& s, SolidParameters& p) {
  const bool is_large = has_finite_strain(p), is_dynamic = p.analysis == Analysis::dynamic;
  refuse(s, material_key(p),
         !is_large && std::ranges::any_of(materials_of(p),
                                          [](const SolidMaterial& m) {
                                            return !m.law.empty() || !m.law_coefficients.empty();
                                          }),
         "a law requires 'kinematics: finite-strain'");
  refuse(
      s, "energy-momentum",
      p.energy_momentum && !(is_large && is_dynamic && scheme_of(p).type == time::TimeScheme::trapezoidal),
      "it requires 'kinematics: finite-strain', 'analysis: dynamic' and 'time-scheme: {type: trapezoidal}'");
  if (!is_large) return;
  refuse(s, "solution-method", p.method.volume_strain == Method::VolumeStrain::shared,
         "finite strain supports 'volume-strain: faces' or 'cells', but not 'shared'");
  refuse(s, "solution-method", p.method.preconditioner == Method::Preconditioner::mixed,
         "'preconditioner: mixed' is for small strain; at finite strain Newton's method uses cell pressures "
         "by itself from nu = 0.48");
  check_finite_sheet(s, p);
  const bool expands = p.expansion.has_value();
  refuse(
      s, "thermoelastic-coupling", p.thermoelastic_coupling,
      "finite strain supports thermal strain, but not the heat of deformation; use small-strain, or remove it");
  refuse(s, "energy-momentum", expands && p.energy_momentum,
         "its stress conserves energy at constant temperature only; remove it, or 'thermal-expansion'");
  refuse(s, "output", expands && p.output.energies,
         "'energies' at finite strain does not count the work of thermal strain; remove it");
  refuse(s, "damping", is_dynamic && p.damping && p.damping->stiffness > 0,
         "'stiffness' damps rigid rotations at finite strain; use 'mass', or the dissipation of "
         "'time-scheme'");
  refuse(s, "interface", p.interface_data && p.interface_data->load == InterfaceData::Load::pressure,
         "finite strain requires forces; 'load: pressure' would not follow the surface");
  refuse(s, "time-step-control", p.step_control.has_value(),
         "it estimates the error of the linear solid only");
  refuse(s, "solution-method",
         p.method.type == Method::Type::block_coupled ||
             (p.method.type != Method::Type::segregated &&
              p.method.face_gradient == Method::FaceGradient::thesis),
         "finite strain is solved by Newton's method on 'face-gradient: symmetric' ('type: newton-krylov' or "
         "'auto'), or by 'type: segregated' on 'face-gradient: thesis'");
  check_updated_lagrangian(s, p);
  refuse(s, "material",
         std::ranges::any_of(
             materials_of(p),
             [](const SolidMaterial& m) { return m.heat.youngs_modulus || m.heat.poissons_ratio; }),
         "finite strain does not support tables of the elastic constants over temperature");
  refuse(s, "output", has_modes(p) || p.output.buckling > 0,
         "'spectrum', 'modes' and 'buckling' require the linear solid; use small-strain");
}

}  // namespace couplet::solid
