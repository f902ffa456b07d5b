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

}  // namespace couplet::solid
