// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/model/parameters.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/config/values.hpp"

namespace couplet::plate {
namespace {

config::Key& as_density(config::Key&& key) { return key.unit("kg/m^3", 1, 25000); }
config::Key& as_modulus(config::Key&& key) { return key.unit("Pa", 1, 2e12); }
config::Key& as_thickness(config::Key&& key) { return key.unit("m", 1e-7, 10); }

/// Declares material and thickness.
void declare_layers(config::Section& s, Parameters& p) {
  s.section(
      "material",
      [&](config::Section& m) {
        as_density(m.value("density", p.material.density)).not_negative().doc("density");
        as_modulus(m.value("youngs-modulus", p.material.youngs_modulus))
            .not_negative()
            .doc("Young's modulus");
        m.value("poissons-ratio", p.material.poissons_ratio).range(-0.99, 0.499).doc("Poisson's ratio");
        m.doubt([&] { return config::check_wave_speed(p.material.youngs_modulus, p.material.density); },
                "density");
      },
      "isotropic material of the plate; needed with 'mesh'");
  as_thickness(s.value("thickness", p.thickness))
      .not_negative()
      .doc("thickness of the plate; needed with 'mesh'");
  s.map<Zone>(
      "zones", p.zones,
      [](config::Section& z, Zone& v) {
        as_thickness(z.value("thickness", v.thickness)).positive().doc("instead of the plate's");
        as_density(z.value("density", v.density)).positive().doc("instead of the plate's");
        as_modulus(z.value("youngs-modulus", v.youngs_modulus)).positive().doc("instead of the plate's");
      },
      "zone", "parts of the mesh (physical surfaces) that differ from the rest");
}

void declare_body(config::Section& s, Parameters& p) {
  s.value("mesh", p.mesh)
      .doc(
          "mid-surface: 2-D mesh of triangles or quadrilaterals (.msh, or .geo to be meshed by gmsh); with 'body' the "
          "mesh that has its surface");
  s.value("mesh-scale", p.mesh_scale)
      .positive()
      .doc(
          "scale factor for all lengths of the mesh file: 0.001 for a mesh in millimeters; positions in keys remain in meters");
  s.value("mesh-parameters", p.mesh_parameters)
      .doc("values for names that the .geo defines with DefineConstant");
  declare_layers(s, p);
  s.map<EdgeSupport>(
      "boundaries", p.boundaries,
      [](config::Section& b, EdgeSupport& v) {
        b.choice("type", v.support,
                 {{"free", Support::free},
                  {"clamped", Support::clamped},
                  {"simply-supported", Support::simply_supported},
                  {"symmetry", Support::symmetry}})
            .required()
            .doc("support of the edge. symmetry: no slope across it");
      },
      "patch", "one entry for each part of the outline; needed with 'mesh'");
}

void declare_place(config::Section& s, Parameters& p) {
  s.section(
      "placement",
      [&](config::Section& q) {
        q.value("origin", p.placement.origin).unit("m", 1e-9, 1e4).doc("position of the mesh origin");
        q.value("x-axis", p.placement.x).doc("direction of the mesh's x axis, a vector of any length");
        q.value("y-axis", p.placement.y)
            .doc("direction of the mesh's y axis, a vector of any length; the plate's normal is x cross y");
        q.check(
            [&]() -> std::string {
              // Scaled by their largest components first, because the square of a small length underflows.
              const Vec3 x = p.placement.x.stableNormalized(), y = p.placement.y.stableNormalized();
              return x.norm() > 0.5 && y.norm() > 0.5 && std::abs(x.dot(y)) < 1e-9
                         ? ""
                         : "x-axis and y-axis must be perpendicular and nonzero";
            },
            "x-axis");
      },
      "position of the mid-surface");
  s.choice("wetted", p.wetted, {{"both", Wetted::both}, {"upper", Wetted::upper}, {"lower", Wetted::lower}})
      .doc(
          "sides that form the interface. upper: where the normal points. both: including the rims of free edges");
}

void declare_modes(config::Section& s, Parameters& p) {
  s.section(
      "modes",
      [&](config::Section& m) {
        m.value("number", p.number)
            .range(1, 10000)
            .doc("number of modes of a mesh to keep, the lowest first; default: 15");
        m.check(
            [&] { return p.number && *p.number != std::floor(*p.number) ? "a whole number is needed" : ""; },
            "number");
        m.value("file", p.modes_file)
            .doc("modes written by another program (docs/formats.md), instead of 'mesh'");
        m.value("cavity", p.cavity)
            .doc(
                "for 'file'. true: its surface is the wall of a cavity, so the normals must point into the enclosed space. "
                "false: such a surface is rejected as inside out");
        m.check([&] { return p.cavity && !p.modes_file ? "it applies only to a 'file'" : ""; }, "cavity");
        m.check(
            [&] {
              return p.modes_file && !p.mesh && p.number
                         ? "it has no effect with 'modes.file': all modes of the file are used"
                         : "";
            },
            "number");
      },
      "modes of the structure; those of a mesh are stored in modes.h5 of the output folder and reused while "
      "mesh and data are the same");
  s.section(
      "time-scheme", [&](config::Section& t) { couplet::time::declare(t, p.time_scheme); },
      "integration in time");
  s.optional_section<Damping>(
      "damping", p.damping,
      [](config::Section& d, Damping& v) {
        d.value("ratio", v.ratio).range(0, 1).doc("fraction of critical damping, the same in every mode");
        d.value("mass", v.mass).unit("1/s", 1e-9, 1e9).not_negative().doc("Rayleigh coefficient of the mass");
        d.value("stiffness", v.stiffness)
            .unit("s", 1e-15, 1e4)
            .not_negative()
            .doc("Rayleigh coefficient of the stiffness");
      },
      "modal damping");
}

void declare_loads(config::Section& s, Parameters& p) {
  s.value("gravity", p.gravity)
      .unit("m/s^2", 1e-3, 2000)
      .size(3)
      .doc("acceleration of gravity, three numbers");
  s.optional_section<Load>(
      "load", p.load,
      [](config::Section& l, Load& v) {
        l.value("upper-pressure", v.upper)
            .unit("Pa", 1e-9, 1e11)
            .doc(
                "pressure on the side to which the normal points (with 'modes.file': +z), an expression of x, y, z, t");
        l.value("lower-pressure", v.lower)
            .unit("Pa", 1e-9, 1e11)
            .doc("pressure on the opposite side (with 'modes.file': -z), an expression of x, y, z, t");
      },
      "pressures acting on the sides, in addition to those of a fluid; 'table(t, \"p.csv\")' reads a table from a file");
  s.optional_section<ContactParameters>(
      "contact", p.contact,
      [](config::Section& c, ContactParameters& v) { declare(c, v, "the plate's normal"); },
      "a rigid seat under the structure, for dynamic analyses only");
}

/// Rejects keys of a plate for modes from a file, which have their own surface, position and mass.
void check_file_alone(config::Section& s, const Parameters& p) {
  const auto of_no_use = [&](const char* key, const char* why, auto&& is_given) {
    s.check(
        [&p, why, is_given] {
          return p.modes_file && !p.mesh && is_given()
                     ? fmt::format("it has no effect with 'modes.file': {}", why)
                     : "";
        },
        key);
  };
  const char* inside = "the modes include it already";
  of_no_use("mesh-parameters", "there is no .geo", [&p] { return !p.mesh_parameters.empty(); });
  of_no_use("mesh-scale", "the file is in meters", [&p] { return p.mesh_scale != 1; });
  of_no_use("material", inside, [&p] {
    const PlateMaterial m;
    return p.material.density != m.density || p.material.youngs_modulus != m.youngs_modulus ||
           p.material.poissons_ratio != m.poissons_ratio;
  });
  of_no_use("thickness", inside, [&p] { return p.thickness > 0; });
  of_no_use("zones", inside, [&p] { return !p.zones.empty(); });
  of_no_use("boundaries", inside, [&p] { return !p.boundaries.empty(); });
  of_no_use("placement", "the file defines the position of the surface", [&p] {
    const PlateFrame here;
    return p.placement.origin != here.origin || p.placement.x != here.x || p.placement.y != here.y;
  });
  of_no_use("wetted", "the interface is the surface of the file", [&p] { return p.wetted != Wetted::both; });
}

/// Rejects keys of a plate or of modes for a rigid body.
void check_body_alone(config::Section& s, const Parameters& p) {
  const auto of_no_use = [&](const char* key, auto&& is_given) {
    s.check([&p, is_given] { return p.body && is_given() ? "it has no effect with 'body'; remove it" : ""; },
            key);
  };
  of_no_use("analysis", [&p] { return p.analysis != Parameters::Analysis::dynamic; });
  of_no_use("modes", [&p] { return p.modes_file || p.number || p.cavity; });
  of_no_use("material", [&p] { return p.material.density > 0 || p.material.youngs_modulus > 0; });
  of_no_use("thickness", [&p] { return p.thickness > 0; });
  of_no_use("zones", [&p] { return !p.zones.empty(); });
  of_no_use("boundaries", [&p] { return !p.boundaries.empty(); });
  of_no_use("time-scheme", [&p] { return p.time_scheme.type != time::TimeScheme::trapezoidal; });
  of_no_use("damping", [&p] { return p.damping.has_value(); });
  of_no_use("load", [&p] { return p.load.has_value(); });
  of_no_use("contact", [&p] { return p.contact.has_value(); });
  of_no_use("initial-amplitudes", [&p] { return !p.initial_amplitudes.empty(); });
  s.check([&p] { return p.body ? problem_of_velocity(*p.body, p.initial_velocity) : ""; },
          "initial-velocity");
  s.check(
      [&p] {
        return p.body && p.mesh.has_value() == p.body->surface.empty()
                   ? "a body with a surface needs both 'mesh' and 'body.surface', the patches of the mesh that are its surface"
                   : "";
      },
      "body");
}

void check_together(config::Section& s, Parameters& p) {
  using Analysis = Parameters::Analysis;
  const auto refuse = [&](const char* key, const char* why, auto&& is_wrong) {
    s.check([why, is_wrong] { return is_wrong() ? why : ""; }, key);
  };
  refuse("mesh", "give either 'mesh' (of the mid-surface) or 'modes.file' (modes of another program)",
         [&p] { return !p.body && p.mesh.has_value() == p.modes_file.has_value(); });
  const auto is_plate = [&p] { return p.mesh && !p.body; };
  const char* plate = p.mesh ? "mesh" : "modes";
  refuse(plate, "a plate needs 'thickness' above 0",
         [&p, is_plate] { return is_plate() && !(p.thickness > 0); });
  refuse(plate, "a plate needs 'material.density' above 0",
         [&p, is_plate] { return is_plate() && !(p.material.density > 0); });
  refuse(plate, "a plate needs 'material.youngs-modulus' above 0",
         [&p, is_plate] { return is_plate() && !(p.material.youngs_modulus > 0); });
  refuse("contact", "contact requires a dynamic analysis; remove it",
         [&p] { return p.contact && p.analysis != Analysis::dynamic; });
  refuse("contact", "with 'modes.file' the material is unknown: give 'stiffness'",
         [&p] { return p.contact && p.modes_file && !p.contact->stiffness; });
  refuse("contact", "'rule: conserving' requires the trapezoidal time scheme; use 'rule: midpoint'", [&p] {
    return p.contact && p.contact->rule == ContactRule::conserving &&
           p.time_scheme.type != time::TimeScheme::trapezoidal;
  });
  refuse("damping", "damping has no effect in this analysis; remove it",
         [&p] { return p.damping && p.analysis != Analysis::dynamic; });
  s.check(
      [&p] {
        return p.mesh && std::ssize(p.initial_amplitudes) > p.n_modes()
                   ? fmt::format("{} amplitudes are given, but there are {} modes",
                                 p.initial_amplitudes.size(), p.n_modes())
                   : "";
      },
      "initial-amplitudes");
}

}  // namespace

void declare(config::Section& s, Parameters& p) {
  using Analysis = Parameters::Analysis;
  s.choice("analysis", p.analysis,
           {{"dynamic", Analysis::dynamic}, {"static", Analysis::static_}, {"modal", Analysis::modal}})
      .doc("static: deflection of the plate without inertia. modal: frequencies and shapes only");
  declare_body(s, p);
  declare_place(s, p);
  declare_modes(s, p);
  declare_loads(s, p);
  s.optional_section<BodyParameters>(
      "body", p.body, [](config::Section& b, BodyParameters& v) { declare(b, v); },
      "a rigid body with up to six degrees of freedom and large rotations, instead of modes");
  s.value("initial-velocity", p.initial_velocity)
      .unit("m/s", 1e-9, 1e4)
      .doc("initial velocity of the whole structure; of a rigid body, of its reference point");
  s.value("initial-amplitudes", p.initial_amplitudes)
      .unit("m", 1e-9, 1e4)
      .doc("initial amplitudes of the modes: for each mode, the displacement where it is largest");
  s.map<PlateProbe>(
      "probes", p.probes,
      [](config::Section& q, PlateProbe& v) {
        q.value("point", v.point)
            .required()
            .unit("m", 1e-9, 1e4)
            .doc(
                "position on the undeformed surface, or no farther from it than the thickness or a hundredth of the "
                "structure's size; the nearest point of the surface is used; with 'body' any point that moves with it");
      },
      "probe", "points of the structure whose displacement is written to probes.csv at each step");
  s.section(
      "output",
      [&](config::Section& o) {
        o.value("modes", p.output.modes)
            .doc("write the mode shapes as a time series with one shape per time");
        o.value("fields", p.output.fields).doc("write the moving surface at the output interval");
      },
      "what is written");
  check_file_alone(s, p);
  check_body_alone(s, p);
  check_together(s, p);
}

}  // namespace couplet::plate
