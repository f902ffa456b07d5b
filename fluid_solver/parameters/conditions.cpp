// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <tuple>
#include <utility>

#include "common/base/text.hpp"
#include "common/fv/table.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {

void declare_rotation(config::Section& r, RotationParameters& rotation) {
  r.value("speed", rotation.speed)
      .unit("rad/s", 1e-6, 1e6)
      .required()
      .doc("angular speed [rad/s], an expression of t [s]; a ramp applies to it as well");
  r.value("centre", rotation.centre).unit("m", 1e-9, 1e4).doc("a point on the axis");
  r.value("axis", rotation.axis).size(3).doc("axis of rotation in 3-D; a 2-D case rotates about z");
  r.check([&rotation] { return rotation.axis.norm() > 0 ? std::string() : "'axis' must not be zero"; },
          "axis");
}

namespace {

void declare_velocity(config::Section& s, BoundaryParameters& b) {
  s.value("velocity", b.velocity)
      .unit("m/s", 1e-9, 1e4)
      .doc("one expression of x, y, z [m] and t [s] per component");
}

void declare_ramp(config::Section& s, BoundaryParameters& b) {
  s.value("ramp", b.ramp)
      .unit("s", 1e-12, 1e10)
      .positive()
      .doc("the velocity grows from 0 as (1 - cos(pi t/ramp))/2 until t = ramp; default: no ramp");
}

void declare_table_and_rotation(config::Section& s, BoundaryParameters& b) {
  s.optional_section<VelocityTableParameters>(
      "table", b.table,
      [](config::Section& t, VelocityTableParameters& table) {
        t.value("file", table.file)
            .required()
            .doc(
                "CSV file next to the case; its first line names the columns: some of x, y, z [m], t [s], and u, v, w [m/s]; "
                "its lines must form a full grid, on which the values are interpolated linearly");
        t.choice("outside", table.outside,
                 {{"error", fv::GridTable::Outside::error}, {"clamp", fv::GridTable::Outside::clamp}})
            .doc(
                "for points or times outside the grid: error, or clamp (use the value at the nearest edge of the grid)");
        t.value("repeat", table.repeat)
            .unit("s", 1e-9, 1e6)
            .positive()
            .doc(
                "period with which the table repeats in time; its last time has the values of the first one, or the values "
                "between the last time and the end of the period are linear; default: it does not repeat");
      },
      "velocity from a file, instead of 'velocity'");
  s.optional_section<RotationParameters>(
      "rotation", b.rotation, declare_rotation,
      "adds omega x (r - centre) to the velocity otherwise prescribed on this patch, for a rotating inlet or wall; default: none");
}

void declare_absorbing(config::Section& s, BoundaryParameters& b) {
  s.value("absorbing", b.absorbing)
      .doc(
          "with `compressibility`: pressure waves leave without reflection (characteristic boundary); the prescribed value is "
          "then that of the mean over the time `mean-time`");
}

void declare_inlet(config::Section& s, BoundaryParameters& b) {
  declare_velocity(s, b);
  s.value("mean-speed", b.mean_speed)
      .unit("m/s", 1e-9, 1e4)
      .doc("instead of 'velocity': mean normal speed into the domain, an expression of t [s]");
  s.value("flow-rate", b.flow_rate)
      .unit("m^3/s", 1e-15, 1e6)
      .doc(
          "instead of 'velocity': flow rate into the domain, an expression of t [s], over the area of the patch at that time; in "
          "2-D per meter of depth, in the same unit");
  s.choice("profile", b.profile, {{"uniform", InletProfile::uniform}, {"parabolic", InletProfile::parabolic}})
      .doc(
          "velocity profile for mean-speed and flow-rate. parabolic: zero at the rim of the patch, which must be a straight line in 2-D or a "
          "disk in 3-D; symmetry planes at the rim continue the profile");
  declare_ramp(s, b);
  declare_table_and_rotation(s, b);
  declare_absorbing(s, b);
  s.check(
      [&b] {
        const int given =
            !b.velocity.empty() + b.mean_speed.has_value() + b.flow_rate.has_value() + b.table.has_value();
        if (given != 1) return std::string("give either 'velocity', 'mean-speed', 'flow-rate' or 'table'");
        if (b.profile == InletProfile::parabolic && !b.mean_speed && !b.flow_rate)
          return std::string(
              "'profile: parabolic' requires 'mean-speed' or 'flow-rate'; use one of them, or remove 'profile'");
        if (b.flow_rate && b.rotation)
          return std::string("a 'rotation' would change the given 'flow-rate'; remove one of the two");
        return std::string();
      },
      "type");
}

void declare_moving_wall(config::Section& s, BoundaryParameters& b) {
  declare_velocity(s, b);
  declare_ramp(s, b);
  declare_table_and_rotation(s, b);
  s.check(
      [&b] {
        if (!b.velocity.empty() && b.table) return std::string("give either 'velocity' or 'table'");
        if (b.velocity.empty() && !b.table && !b.rotation)
          return std::string("give 'velocity', 'table' or 'rotation'");
        return std::string();
      },
      "type");
}

/// Problem of a pressure drop; empty if it is a table that never falls, because another one has several flow rates or none.
std::string problem_of_drop(const config::ExpressionText& text) {
  if (std::string problem = fv::problem_of_property(text, "q"); !problem.empty()) return problem;
  const fv::Property drop(text, "", "q");
  if (drop.is_constant()) return "a table of the flow rate is expected: {of: q, at: [...], values: [...]}";
  if (!std::ranges::is_sorted(drop.table()->values()))
    return "its values must not decrease with the flow rate, because several flow rates could then have the same pressure";
  return "";
}

/// Declares what lies between an outlet and its pressure.
void declare_circuit(config::Section& s, CircuitParameters& c) {
  constexpr double least = 1e-6, most = 1e15;  // [Pa s/m^3]
  s.value("resistance", c.resistance)
      .unit("Pa s/m^3", least, most)
      .not_negative()
      .doc(
          "of what lies behind the outlet: the pressure in it exceeds 'pressure' by this times the flow rate out of the "
          "fluid; in 2-D per meter of depth, in the same unit");
  s.optional_section<WindkesselParameters>(
      "windkessel", c.windkessel,
      [](config::Section& w, WindkesselParameters& p) {
        w.value("proximal", p.proximal)
            .unit("Pa s/m^3", least, most)
            .not_negative()
            .required()
            .doc("resistance between the outlet and the compliance, 0 of a two-element Windkessel");
        w.value("compliance", p.compliance)
            .unit("m^3/Pa", 1e-18, 1e3)
            .positive()
            .required()
            .doc("volume that the vessels behind the outlet take up per pressure");
        w.value("distal", p.distal)
            .unit("Pa s/m^3", least, most)
            .positive()
            .required()
            .doc("resistance between the compliance and 'pressure'");
        w.value("initial-pressure", p.initial_pressure)
            .unit("Pa", 1e-9, 1e9)
            .doc("of the compliance at the start, above 'pressure'");
      },
      "three-element Windkessel between the outlet and 'pressure': a resistance, then a compliance beside a second resistance; "
      "in 2-D per meter of depth");
  s.value("pressure-drop", c.pressure_drop)
      .unit("Pa", 1e-9, 1e11)
      .doc(
          "table of the flow rate out of the fluid, {of: q, at: [...], values: [...]}: what the pressure in the outlet exceeds "
          "'pressure' by. It must not decrease, and q below 0 is flow into the fluid");
  s.check([&c] { return c.pressure_drop ? problem_of_drop(*c.pressure_drop) : std::string(); },
          "pressure-drop");
  s.check(
      [&c] { return c.count() > 1 ? "give only one of 'resistance', 'windkessel' and 'pressure-drop'" : ""; },
      c.resistance ? "resistance" : "windkessel");
}

void declare_outlet(config::Section& s, BoundaryParameters& b) {
  s.value("pressure", b.pressure).unit("Pa", 1e-9, 1e11).doc("expression of x, y, z [m] and t [s]");
  declare_circuit(s, b.circuit);
  s.value("backflow-stabilisation", b.backflow_stabilisation)
      .doc(
          "true: fluid that enters here comes from rest, so that 'pressure' is its total pressure and the pressure in the "
          "opening is lower by rho U^2/2. false: 'pressure' is the pressure of the moving fluid, and strong backflow may grow");
  declare_absorbing(s, b);
}

void declare_periodic(config::Section& s, BoundaryParameters& b) {
  s.value("partner", b.partner).required().doc("the patch that is a translated copy of this one");
}

void declare_interface(config::Section& s, BoundaryParameters& b) {
  s.value("surface-density", b.surface_density)
      .unit("kg/m^2", 1e-6, 1e6)
      .positive()
      .doc(
          "mass per area of the structure behind the wall, with which the pressure equation anticipates its response (Robin "
          "condition); requires `coupling.order: structure-first`. Use the density of the solid times its thickness, or less: too "
          "small a value costs iterations, and too large a value may diverge; default: the wall moves as the coupling prescribes");
}

using Entry = std::pair<BoundaryType, FlowCondition>;

/// All conditions, in the order of the documentation.
const auto& condition_table() {
  const auto without_friction = [](const BoundaryParameters&) { return FaceRow{.friction = 0}; };
  static const std::array table{
      // Inflow with a prescribed velocity. For a compressible fluid it may let pressure waves out
      // or have a volume upstream (pressure/lumped_ends).
      Entry{BoundaryType::inlet,
            {.name = "inlet",
             .about = "inlet: prescribed velocity",
             .declare = declare_inlet,
             .velocity = GivenBy::keys,
             .passage = Passage::in}},
      // Outflow at a prescribed pressure. Backflow carries half its velocity, so that phi (u_b - u_P/2).u_P =
      // 0.
      Entry{BoundaryType::outlet,
            {.name = "outlet",
             .about = "outlet: prescribed pressure",
             .declare = declare_outlet,
             .row =
                 [](const BoundaryParameters& b) {
                   return FaceRow{1, 0, b.backflow_stabilisation ? 0.5 : 1.0};
                 },
             .velocity = GivenBy::nobody,
             .passage = Passage::out}},
      // Outflow with the velocity convected to the patch by the mean outflow: Boundary::convect().
      Entry{BoundaryType::convective_outlet,
            {.name = "convective-outlet",
             .about =
                 "convective-outlet: the flow leaves at the mean outflow speed and with zero mean pressure",
             .velocity = GivenBy::flow,
             .passage = Passage::out}},
      Entry{BoundaryType::no_slip, {.name = "no-slip", .about = "no-slip: wall at rest", .wall = true}},
      // Wall with tangential motion.
      Entry{BoundaryType::moving_wall,
            {.name = "moving-wall",
             .about = "moving-wall: wall with a prescribed velocity",
             .declare = declare_moving_wall,
             .velocity = GivenBy::keys,
             .wall = true}},
      // Impermeable surface without friction that moves with the mesh. A symmetry plane is the same.
      Entry{BoundaryType::slip,
            {.name = "slip",
             .about = "slip, symmetry: no flow through the patch and no shear stress",
             .row = without_friction,
             .velocity = GivenBy::mesh}},
      Entry{BoundaryType::symmetry,
            {.name = "symmetry", .about = "", .row = without_friction, .velocity = GivenBy::mesh}},
      // Outflow enters at the partner: the mesh is joined there, without boundary faces.
      Entry{BoundaryType::periodic,
            {.name = "periodic",
             .about = "periodic: outflow re-enters at the partner",
             .declare = declare_periodic,
             .velocity = GivenBy::nobody,
             .joined = true}},
      // Wall that moves with the structure. If its mass is known, the pressure equation includes its response
      // as a Robin condition: pressure/wall_terms.
      Entry{BoundaryType::interface,
            {.name = "interface",
             .about = "interface: wall that moves with the structure",
             .declare = declare_interface,
             .velocity = GivenBy::structure,
             .wall = true}},
      // Wall with prescribed motion, also in normal direction.
      Entry{
          BoundaryType::body,
          {.name = "body",
           .about =
               "body: wall that moves as 'motion' prescribes, or by its own motion in the mesh mover (type: moving there)",
           .velocity = GivenBy::motion,
           .wall = true}},
  };
  return table;
}

}  // namespace

const FlowCondition& condition_of(const BoundaryParameters& boundary) {
  return std::ranges::find(condition_table(), boundary.type, &Entry::first)->second;
}

std::string condition_names(const std::string& last) {
  std::vector<std::string> names;
  for (const auto& [type, condition] : condition_table()) names.push_back(condition.name);
  const std::string end = names.back();
  names.pop_back();
  return base::join(names) + last + end;
}

void declare_boundary(config::Section& s, BoundaryParameters& b) {
  std::vector<std::tuple<std::string, BoundaryType, config::Section::Declare>> cases;
  std::vector<std::string> about;
  for (const auto& [type, condition] : condition_table()) {
    cases.emplace_back(condition.name, type, [&b, declare = condition.declare](config::Section& v) {
      if (declare) declare(v, b);
    });
    if (!condition.about.empty()) about.push_back(condition.about);
  }
  s.variant("type", b.type, cases, base::join(about, "; "), true);
  declare_heat_boundary(s, b);
}

void declare_levels(config::Section& s, const FluidParameters& p) {
  const bool waves = p.is_compressible(), upstream = waves && p.compressibility->upstream_volume > 0,
             held = p.volume_level == VolumeLevelBy::structure;
  const auto refuse = [&s](bool applies, const std::string& key, const std::string& message) {
    s.check([told = applies ? message : ""] { return told; }, key);
  };
  bool given = false, convective = false, inlet = false, moves = false, walled = false, yields = false;
  for (const auto& [patch, b] : p.boundaries) {
    const FlowCondition& condition = condition_of(b);
    const bool enters = condition.passage == Passage::in, flows = condition.velocity == GivenBy::flow;
    given = given || gives_pressure(b), convective = convective || flows, inlet = inlet || enters;
    moves = moves || condition.velocity == GivenBy::motion, yields = yields || b.surface_density;
    walled = walled || condition.velocity == GivenBy::structure;
    const std::string where = "boundaries." + patch;
    refuse(
        b.absorbing && !waves, where + ".absorbing",
        "an incompressible fluid has no pressure waves to let out; add 'compressibility', or remove the key");
    refuse(b.absorbing && enters && upstream, where + ".absorbing",
           "the 'upstream-volume' behind this inlet already responds to the waves; remove one of the two");
    refuse(b.absorbing && b.circuit.count() > 0, where + ".absorbing",
           "what lies behind this outlet already responds to the waves; remove one of the two");
    refuse(b.circuit.count() > 0 && p.rotating_frame, where + ".type",
           "a rotating frame does not support what lies behind an outlet; give its 'pressure' only");
    refuse(
        waves && flows, where + ".type",
        "a convective outlet sets no pressure level, which a compressible fluid needs; use 'type: outlet' with 'absorbing: true'");
  }
  refuse(upstream && !inlet, "compressibility.upstream-volume", "this fluid has no inlet; remove the key");
  refuse(!p.gaps.empty() && !given && !waves, "gaps",
         "a fluid with closing gaps needs an outlet, because its blocked cells retain their fluid");
  refuse(held && waves, "volume-level",
         "a compressible fluid has a pressure level of its own; remove the key");
  refuse(
      held && yields, "volume-level",
      "walls with a surface-density get their level from the pressure equation; remove one of the two keys");
  refuse(held && (given || convective), "volume-level",
         "this fluid has an outlet, so a structure cannot set its pressure level; remove the key");
  refuse(
      held && moves, "volume-level",
      "this fluid has bodies that move as prescribed, so a structure cannot set its pressure level; remove the key");
  refuse(
      held && !walled, "volume-level",
      "this fluid has no wall of type interface, so a structure cannot set its pressure level; remove the key");
}

}  // namespace couplet::fluid
