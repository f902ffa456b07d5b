// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/parameters/parameters.hpp"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "common/base/text.hpp"
#include "common/config/values.hpp"
#include "common/fv/expression.hpp"
#include "common/io/fields/surface_series.hpp"
#include "common/mesh/periodic_points.hpp"

namespace couplet::fluid {

namespace {

constexpr GradientField fields[] = {
    {"vorticity", "1/s", "field of the curl of the velocity [1/s]", true,
     [](const Tensor3& g) { return Vec3(g(2, 1) - g(1, 2), g(0, 2) - g(2, 0), g(1, 0) - g(0, 1)); }},
    // -g:g^T/2 for a field free of divergence
    {"q-criterion", "1/s^2", "field of Q = (|W|^2 - |S|^2)/2 [1/s^2]: positive in vortices", false,
     [](const Tensor3& g) { return Vec3(-0.5 * (g * g).trace(), 0, 0); }},
    {"shear-rate", "1/s",
     "field of the shear rate (2 S:S)^(1/2), S the strain rate [1/s]: |du/dy| in a shear flow", false,
     [](const Tensor3& g) { return Vec3((g + g.transpose()).norm() / std::sqrt(2.0), 0, 0); }}};

void declare_coefficients(config::Section& s, CoefficientParameters& c) {
  s.value("patches", c.patches).required().doc("walls whose forces are summed");
  s.value("speed", c.speed)
      .unit("m/s", 1e-9, 1e4)
      .positive()
      .required()
      .doc("U of the dynamic pressure q = rho U^2 / 2");
  s.value("area", c.area)
      .unit("m^2", 1e-14, 1e7)
      .positive()
      .required()
      .doc("A: force over q A; in 2-D a length times 1 m");
  s.value("length", c.length).unit("m", 1e-9, 1e4).positive().doc("L: moment over q A L");
  s.value("pressure", c.pressure)
      .unit("Pa", 1e-9, 1e9)
      .doc(
          "reference pressure p_ref of Cp = (p - p_ref) / q, which is written for those of these walls that 'surfaces' names");
  s.value("drag", c.drag).doc("direction of the first coefficient, a vector of any length");
  s.value("lift", c.lift).doc("direction of the second coefficient, a vector of any length");
  s.value("centre", c.centre).unit("m", 1e-9, 1e4).doc("fixed reference point of the moment");
  s.value("axis", c.axis).size(3).doc("axis of the moment; in 2-D z");
  const auto needs_direction = [&s](const char* key, const auto& value) {
    s.check([&value] { return value.norm() > 0 ? "" : "a direction must not be zero"; }, key);
  };
  needs_direction("drag", c.drag);
  needs_direction("lift", c.lift);
  needs_direction("axis", c.axis);
  s.check(
      [&c] {
        return c.drag.normalized().cross(c.lift.normalized()).norm() > 1e-6
                   ? ""
                   : "it is parallel to 'drag', so that both coefficients would measure the same force";
      },
      "lift");
}

void declare_sample(config::Section& s, SampleParameters& p) {
  using Type = SampleParameters::Type;
  const auto line = [&p](config::Section& v) {
    v.value("from", p.from).unit("m", 1e-9, 1e4).required().doc("first end, in the reference configuration");
    v.value("to", p.to).unit("m", 1e-9, 1e4).required().doc("other end");
    v.value("points", p.points).range(2, 100000).doc("number of points, ends included");
    v.check([&p] { return p.from == p.to ? "'from' and 'to' coincide" : ""; }, "to");
  };
  const auto plane = [&p, line](config::Section& v) {
    line(v);
    v.value("up", p.up).unit("m", 1e-9, 1e4).required().doc("third corner: the plane is from-to by from-up");
    v.value("rows", p.rows).range(2, 10000).doc("number of points along from-up");
    v.check(
        [&p] { return (p.to - p.from).cross(p.up - p.from).norm() > 0 ? "" : "the corners lie on one line"; },
        "up");
  };
  s.variant("type", p.type, {{"line", Type::line, line}, {"plane", Type::plane, plane}},
            "line: points from one end to the other; plane: a grid of points", true);
}

void declare_gap(config::Section& s, GapParameters& gap) {
  s.value("between", gap.between).required().doc("the two walls (patches), a valve and its seat");
  s.value("opening", gap.opening)
      .unit("m", 1e-8, 10)
      .positive()
      .required()
      .doc("cells where the walls are closer than this are blocked");
  s.value("height", gap.height)
      .unit("m", 1e-9, 1e4)
      .doc(
          "height of the seat (the second wall) along 'direction', an expression of x, y, z at rest. The mesh is refused if "
          "its wall is elsewhere, and the 'contact' of a structure may refer to this gap; default: read from the mesh");
  s.value("direction", gap.direction).doc("direction from the seat to the valve; default: z (y in 2-D)");
  s.check(
      [&gap] {
        const auto& d = gap.direction;
        const bool fits = d.empty() || ((d.size() == 2 || d.size() == 3) &&
                                        std::hypot(d[0], d[1], d.size() > 2 ? d[2] : 0) > 0);
        return fits ? std::string() : "two or three numbers are needed, not all 0";
      },
      "direction");
  s.check(
      [&gap] {
        const bool two = gap.between.size() == 2 && gap.between[0] != gap.between[1];
        return two ? std::string() : "requires two different patches";
      },
      "between");
}

/// Gap whose walls never move, so that its blocked cells stay blocked; empty if there is none.
std::string gap_at_rest(const FluidParameters& p) {
  const auto rests = [&p](const std::string& patch) {
    const auto wall = p.boundaries.find(patch);
    if (wall == p.boundaries.end()) return false;
    const GivenBy by = condition_of(wall->second).velocity;
    return by != GivenBy::structure && by != GivenBy::motion && by != GivenBy::mesh;
  };
  for (const auto& [name, gap] : p.gaps)
    if (std::ranges::all_of(gap.between, rests))
      return fmt::format(
          "both walls of '{}' are at rest, so that it neither closes nor opens: one of them must be of `type: interface` or "
          "`body`",
          name);
  return "";
}

/// Call after declaring `boundaries`, which this uses.
void declare_gaps(config::Section& s, FluidParameters& p) {
  s.map<GapParameters>(
      "gaps", p.gaps, declare_gap, "gap",
      "gaps that nearly close as the mesh moves: their cells block the flow, do not limit the step size, and open again");
  s.doubt([&p] { return gap_at_rest(p); }, "gaps");
}

/// Declares mesh and fluid.
void declare_scene(config::Section& s, FluidParameters& p) {
  s.value("mesh", p.mesh)
      .required()
      .doc("mesh file, .msh, .geo or a cut mesh (.h5), relative to the case's folder");
  s.value("mesh-scale", p.mesh_scale)
      .positive()
      .doc(
          "scale factor for all lengths of the mesh file: 0.001 for a mesh in millimeters; positions in keys remain in meters");
  s.value("mesh-parameters", p.mesh_parameters)
      .doc("values for names that the .geo defines with DefineConstant: {n: 8}");
  s.value("dimension", p.dimension).required().range(2, 3).doc("2 or 3; a 2-D case has a depth of 1 m");
  s.value("density", p.density).unit("kg/m^3", 0.01, 25000).positive().required().doc("density");
  s.value("viscosity", p.viscosity)
      .unit("Pa s", 1e-6, 1e6)
      .not_negative()
      .required()
      .doc("dynamic viscosity");
  s.optional_section<ViscosityLaw>(
      "viscosity", p.viscosity_law, [](config::Section& v, ViscosityLaw& law) { declare(v, law); },
      "instead of the number: a law by which the viscosity depends on the shear rate");
  s.doubt(
      [&p] {
        return config::check_kinematic_viscosity(p.viscosity_law ? p.viscosity_law->largest() : p.viscosity,
                                                 p.density);
      },
      "viscosity");
  s.map<BoundaryParameters>("boundaries", p.boundaries, declare_boundary, "patch",
                            "boundary condition of each patch of the mesh; every patch needs an entry");
}

/// Declares step sizes and tolerances.
void declare_steps(config::Section& s, FluidParameters& p) {
  s.value("time-step", p.time_step)
      .unit("s", 1e-12, 1e10)
      .positive()
      .doc(
          "largest sub-step of the fluid; a coupling step is divided into equal sub-steps that do not exceed it; default: the "
          "stability limit");
  s.value("safety-factor", p.safety_factor)
      .range(0.05, 1)
      .doc("fraction of the stability limit to use when time-step is absent");
  s.choice("viscous", p.viscous,
           {{"auto", ViscousTreatment::automatic},
            {"explicit", ViscousTreatment::explicit_},
            {"implicit", ViscousTreatment::implicit}})
      .doc(
          "time scheme of the viscous term. auto: implicit where its explicit stability limit would require "
          "many more steps, as --explain and the log say");
  s.value("implicit-stretch", p.implicit_stretch)
      .range(1, 1e6)
      .doc(
          "largest step with an implicit viscous term, as a multiple of the explicit viscous limit. A smaller value "
          "is more accurate: second order needs nu dt / h^2 of about 1 or less, for which 4 is a good start; default: "
          "no such bound, which is cheaper");
  s.check(
      [&p] {
        return p.implicit_stretch && p.viscous == ViscousTreatment::explicit_
                   ? "it bounds steps with an implicit viscous term, but 'viscous' is explicit; remove it"
                   : "";
      },
      "implicit-stretch");
  s.value("pressure-tolerance", p.pressure_tolerance)
      .range(1e-14, 1e-1)
      .doc(
          "tolerance of the pressure equation, relative to the divergence of the predicted velocity; a "
          "coupled run needs about 1e-4 of the coupling tolerance");
}

/// Declares the initial state and body forces.
void declare_start(config::Section& s, FluidParameters& p) {
  s.value("initial-velocity", p.initial_velocity)
      .unit("m/s", 1e-9, 1e4)
      .doc(
          "one expression of x, y, z [m] per component; made divergence-free at the start; default: at rest");
  s.value("initial-pressure", p.initial_pressure)
      .unit("Pa", 1e-9, 1e11)
      .doc(
          "expression of x, y, z [m]. Without `compressibility` it is only an initial guess; with it, it is the initial state, "
          "and an initial velocity is then used as given. Default: zero; with `compressibility` and `initial-velocity`, the "
          "initial pressure of the outlets (of several, the one nearest to zero)");
  s.value("body-force", p.body_force)
      .unit("m/s^2", 1e-4, 1e6)
      .doc("force per mass, one expression of x, y, z [m] and t [s] per component; default: none");
}

/// Declares time schemes.
void declare_schemes(config::Section& s, FluidParameters& p) {
  s.choice("face-values", p.face_values,
           {{"second-order", FaceValues::second_order},
            {"fourth-order", FaceValues::fourth_order},
            {"auto", FaceValues::automatic}})
      .doc(
          "order in space of convection, explicit viscous term, fluxes and pressure gradient. fourth-order: along lines of "
          "hexahedra or quadrilaterals whose faces are perpendicular to the line, away from walls, second order elsewhere; "
          "requires a mesh at rest. auto: fourth-order where that is possible on at least half of the mesh");
  s.value("courant", p.courant)
      .range(1, 1000)
      .doc(
          "largest Courant number of a sub-step: convection becomes implicit in the cells whose explicit limit the sub-step "
          "exceeds. Use it if a few small cells, such as those at the edge of a gap, dictate many sub-steps; changes of the "
          "flow that are faster than a sub-step are not resolved there. Above about 20, solving the implicit equations may "
          "cost more than the sub-steps saved; default: explicit convection limits the sub-steps everywhere");
  s.check(
      [&p] {
        const bool is_explicit = p.viscous == ViscousTreatment::explicit_ || !p.bodies.empty();
        if (p.courant && is_explicit)
          return "it makes convection implicit together with the viscous term, which 'viscous: explicit' and 'bodies' make "
                 "explicit; remove it";
        if (p.courant && p.time_step) return "'time-step' gives the sub-steps; remove one of the two";
        if (p.courant && p.face_values != FaceValues::second_order)
          return "convection of fourth order is explicit; remove it or 'face-values'";
        return "";
      },
      "courant");
  s.choice("volume-level", p.volume_level,
           {{"none", VolumeLevelBy::nobody}, {"structure", VolumeLevelBy::structure}})
      .doc(
          "for a fluid without an outlet whose interface is a wall of its cavity: what sets the pressure level that conserves "
          "its volume. none: such a fluid is rejected. structure: the coupler finds the level from the structure's response to "
          "a pressure (coupler/volume.csv); the fluid's own pressures keep zero mean");
}

/// Declares parts that move, close or rotate.
void declare_moving_parts(config::Section& s, FluidParameters& p) {
  s.map<BodyParameters>(
      "bodies", p.bodies,
      [](config::Section& b, BodyParameters& body) {
        b.value("level", body.level)
            .unit("m", 1e-9, 1e4)
            .required()
            .doc(
                "expression of x, y, z [m] and t [s] that is negative inside the body and approximately the distance to its "
                "surface nearby");
        b.value("velocity", body.velocity)
            .unit("m/s", 1e-9, 1e4)
            .doc(
                "velocity of the motion that 'level' describes, one expression of x, y, z [m] and t [s] per component; "
                "default: at rest");
        b.choice("surface", body.surface,
                 {{"auto", BodySurface::automatic}, {"steps", BodySurface::steps}, {"cut", BodySurface::cut}})
            .doc(
                "how the body closes cells. steps: a cell is closed if its center is inside, which disturbs the pressure when a "
                "moving body gains or loses a cell. cut: the part inside is closed, so that cells close and open gradually. "
                "auto: cut on a moving mesh, steps on one at rest");
      },
      "body",
      "rigid bodies in a mesh that does not conform to them and may move through them; requires an outlet");
  s.check(
      [&p] {
        const bool open = p.is_compressible() || std::ranges::any_of(p.boundaries, [](const auto& b) {
                            return gives_pressure(b.second);
                          });
        return p.bodies.empty() || open ? "" : "immersed bodies may displace fluid, which needs an outlet";
      },
      "bodies");
  declare_gaps(s, p);
  s.optional_section<fv::MotionParameters>(
      "motion", p.motion,
      [](config::Section& m, fv::MotionParameters& motion) { couplet::fv::declare(m, motion, true); },
      "prescribed motion of the whole mesh or around a body, without a mesh mover; it starts from the "
      "reference configuration; default: none");
  s.optional_section<RotationParameters>(
      "rotating-frame", p.rotating_frame, declare_rotation,
      "a rotating frame: the mesh is at rest in it, all velocities are relative to it, and Coriolis, "
      "centrifugal and Euler forces act; default: none");
}

/// Declares models of neglected effects.
void declare_models(config::Section& s, FluidParameters& p) {
  s.optional_section<TurbulenceParameters>(
      "turbulence", p.turbulence,
      [](config::Section& t, TurbulenceParameters& turbulence) {
        t.choice("model", turbulence.model,
                 {{"smagorinsky", TurbulenceModel::smagorinsky}, {"wale", TurbulenceModel::wale}})
            .doc("wale: no eddy viscosity in pure shear, correct at walls. smagorinsky: the classical model");
        t.value("constant", turbulence.constant)
            .positive()
            .doc("model constant, multiplied by the cell width; default: 0.325 (wale), 0.17 (smagorinsky)");
      },
      "eddy viscosity of the unresolved scales; default: none");
  s.optional_section<StatisticsParameters>(
      "statistics", p.statistics,
      [](config::Section& t, StatisticsParameters& statistics) {
        t.value("start", statistics.start)
            .unit("s", 1e-12, 1e10)
            .not_negative()
            .doc("start time of the averaging");
      },
      "time means of velocity and pressure, their fluctuations and Reynolds stresses in the field output");
  s.optional_section<CompressibilityParameters>(
      "compressibility", p.compressibility,
      [](config::Section& c, CompressibilityParameters& known) { declare(c, known); },
      "weakly compressible fluid: pressure waves travel at the speed of sound, and closed parts are compressed; default: "
      "incompressible, which the run assesses with the speed of sound of a gas at 1 atm or of a liquid, found from density and "
      "viscosity");
}

/// Describes an error in the patches of output.flow-areas; empty if there is none.
std::string wrong_flow_areas(const FluidParameters& p) {
  std::vector<std::string> patches;
  for (const auto& [patch, unused] : p.boundaries) patches.push_back(patch);
  for (const auto& [name, area] : p.output.flow_areas)
    for (const std::string& patch : {area.from, area.to})
      if (!p.boundaries.contains(patch))
        return fmt::format("'{}' of '{}' is not a patch of the boundary; these are: {}", patch, name,
                           base::join(patches));
  return "";
}

/// Declares the output.
void declare_written(config::Section& s, FluidParameters& p) {
  s.section(
      "output",
      [&p](config::Section& o) {
        declare_output(o, p.output);
        o.check([&p] { return io::wrong_surfaces(p.output.surfaces, p.boundaries); }, "surfaces");
        o.check([&p] { return wrong_flow_areas(p); }, "flow-areas");
      },
      "output in addition to velocity, pressure, forces and balance");
  s.map<ProbeParameters>(
      "probes", p.probes,
      [&p](config::Section& q, ProbeParameters& probe) {
        config::Key point = q.value("point", probe.point);
        point.unit("m", 1e-9, 1e4).required().doc("position in the reference configuration");
        if (p.dimension == 3) point.size(3);
      },
      "probe", "points whose velocity and pressure are written after each step");
}

}  // namespace

std::span<const GradientField> gradient_fields() { return fields; }

// Keys of the section `output`.

void declare_output(config::Section& s, FluidOutputParameters& p) {
  for (const GradientField& field : gradient_fields())
    s.value(field.name, p.gradient_fields[field.name]).doc(field.meaning);
  s.value("viscosity", p.viscosity).doc("field of the dynamic viscosity [Pa s], with a law of 'viscosity'");
  s.value("walls", p.walls)
      .doc(
          "write walls.csv with the shear and y+ of each wall; with a turbulence model it is always written");
  s.value("fluxes", p.fluxes)
      .doc(
          "write fluxes.csv with the fluxes of volume and momentum out of the fluid through each patch (a load is a flux of "
          "momentum) and the mean pressure");
  s.value("surfaces", p.surfaces)
      .doc(
          "patches, or [all], for which surface-<patch>.xdmf is written at each output with pressure, traction, wall shear, y+ "
          "at walls, and Cp at walls that 'coefficients' names");
  s.map<CoefficientParameters>(
      "coefficients", p.coefficients, declare_coefficients, "name",
      "write coefficients.csv with the force and moment coefficients of some walls as means over the step");
  s.map<FlowAreaParameters>(
      "flow-areas", p.flow_areas,
      [](config::Section& area, FlowAreaParameters& a) {
        area.value("from", a.from).required().doc("patch where the flow enters");
        area.value("to", a.to).required().doc("patch where it leaves");
        area.check([&a] { return a.from == a.to ? "'from' and 'to' are the same patch" : ""; }, "to");
      },
      "name",
      "write flow-areas.csv with the effective flow area between two patches, m/sqrt(2 rho (p_from - p_to)), from the mass "
      "flow m and the mean pressures");
  s.map<SampleParameters>(
      "samples", p.samples, declare_sample, "name",
      "write sample-<name>.csv with velocity and pressure (with 'statistics' their means and rms) on a line or plane at each "
      "output; the points move with the mesh, and points outside it are omitted");
  s.value("energy-budget", p.energy_budget)
      .doc(
          "write energy.csv with the kinetic energy and the power that viscosity, eddy viscosity and pressure take from it");
}

/// Rules for what no scheme combines.
void declare_conflicts(config::Section& s, const FluidParameters& p) {
  const bool law = p.viscosity_law.has_value();
  const bool bodies = !p.bodies.empty(), gaps = !p.gaps.empty(), frame = p.rotating_frame.has_value(),
             waves = p.is_compressible(), implicit = p.viscous == ViscousTreatment::implicit,
             motion = p.motion.has_value(), fourth = p.face_values == FaceValues::fourth_order;
  const bool coupled = std::ranges::any_of(
      p.boundaries, [](const auto& b) { return b.second.type == BoundaryType::interface; });
  const struct {
    const char* key;
    bool applies;
    const char* message;
  } refused[] = {
      {"rotating-frame", frame && bodies, "immersed bodies do not support it; remove 'bodies'"},
      {"rotating-frame", frame && motion,
       "the mesh is at rest in the frame; move the rotation to 'motion' (angle), or remove 'motion'"},
      {"rotating-frame", frame && coupled,
       "no structure supports it: boundaries of type interface are not allowed"},
      {"gaps", bodies && gaps, "not supported together with immersed bodies; remove 'gaps' or 'bodies'"},
      {"viscous", bodies && implicit, "immersed bodies act on the explicit step; use 'explicit'"},
      {"face-values", fourth && (bodies || gaps || motion),
       "fourth-order is not supported together with 'bodies', 'gaps' or 'motion'; use second-order"},
      {"viscosity", law && p.turbulence,
       "a law is not supported together with a turbulence model; remove 'turbulence', or give a number"},
      {"viscosity", law && bodies,
       "a law is not supported together with immersed bodies; remove 'bodies', or give a number"},
      {"viscosity", law && waves,
       "a law is not supported in a compressible fluid; remove 'compressibility', set 'scheme: none', or give a number"},
      {"output.viscosity", p.output.viscosity && !law,
       "it needs a law of 'viscosity', which is a number here"},
      {"compressibility", waves && bodies,
       "not supported together with immersed bodies; remove 'bodies', or set 'scheme: none'"},
      {"compressibility", waves && frame,
       "not supported together with a rotating frame; remove 'rotating-frame', or set 'scheme: none'"}};
  for (const auto& [key, applies, message] : refused)
    s.check([told = applies ? message : ""] { return told; }, key);
}

std::vector<std::array<std::string, 2>> periodic_patches(const FluidParameters& parameters) {
  std::map<std::string, std::string> partner_of;
  for (const auto& [name, b] : parameters.boundaries)
    if (condition_of(b).joined) partner_of[name] = b.partner;
  return mesh::periodic_pairs(partner_of);
}

void declare(config::Section& s, FluidParameters& p) {
  declare_scene(s, p);
  declare_steps(s, p);
  declare_start(s, p);
  declare_schemes(s, p);
  declare_moving_parts(s, p);
  declare_models(s, p);
  declare_heat(s, p);
  declare_written(s, p);
  declare_levels(s, p);
  declare_conflicts(s, p);
}

}  // namespace couplet::fluid
