// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/text.hpp"
#include "common/io/fields/surface_series.hpp"
#include "solid_solver/parameters/parameter_checks.hpp"

namespace couplet::solid {

namespace {

const std::vector<std::string> probe_fields{"displacement", "velocity",          "acceleration",
                                            "stress",       "equivalent-stress", "principal-stress",
                                            "strain",       "temperature"};

std::string unknown_field(const std::vector<std::string>& chosen) {
  for (const std::string& field : chosen)
    if (std::ranges::find(probe_fields, field) == probe_fields.end())
      return fmt::format("unknown field '{}'; the fields are {}", field, base::join(probe_fields));
  return chosen.empty() ? "at least one field is needed" : "";
}

const std::vector<std::string> quantity_fields{"displacement", "stress", "equivalent-stress", "temperature",
                                               "heat"};

/// Problem of a quantity that is a heat flow or a temperature.
std::string wrong_heat(const SolidQuantity& q) {
  if (!q.component.empty()) return fmt::format("a {} has no component", q.field);
  if (q.field == "temperature") return q.point.empty() ? "a temperature needs a 'point'" : "";
  return q.patch.empty() || !q.point.empty() ? "heat flows through a 'patch'; give that and no 'point'" : "";
}

std::string wrong_quantity(const SolidQuantity& q, int dimension) {
  if (std::ranges::find(quantity_fields, q.field) == quantity_fields.end())
    return fmt::format("unknown field '{}'; the fields are {}", q.field, base::join(quantity_fields));
  if (!q.patch.empty() && q.field != "heat") return "only 'field: heat' has a 'patch'";
  if (!q.point.empty() && std::ssize(q.point) != dimension)
    return fmt::format("'point' has {} numbers, one per dimension of the case", dimension);
  if (q.field == "heat" || q.field == "temperature") return wrong_heat(q);
  const std::vector<std::string> components =
      q.field == "displacement" ? std::vector<std::string>{"x", "y", "z"}
      : q.field == "stress"     ? std::vector<std::string>{"xx", "yy", "zz", "xy", "yz", "xz"}
                                : std::vector<std::string>{""};
  if (std::ranges::find(components, q.component) == components.end())
    return q.field == "equivalent-stress"
               ? "an equivalent stress has no component"
               : fmt::format("a {} has the components {}; give one", q.field, base::join(components));
  return q.point.empty() && q.field != "equivalent-stress" ? fmt::format("a {} needs a 'point'", q.field)
                                                           : "";
}

}  // namespace

void declare(config::Section& s, SolidProbe& p) {
  s.value("fields", p.fields)
      .doc(
          "fields to record: displacement, velocity, acceleration, stress, equivalent-stress, principal-stress, strain, "
          "temperature. Where materials meet, stress and strain are those of the side with the larger equivalent value");
  s.check([&] { return unknown_field(p.fields); }, "fields");
}

void declare(config::Section& s, SolidQuantity& q, int dimension) {
  s.value("point", q.point)
      .unit("m", 1e-9, 1e4)
      .doc("position in the undeformed solid; an equivalent stress without 'point' is the largest one");
  s.value("patch", q.patch).doc("for a heat flow: the patch through which heat enters the solid");
  s.value("field", q.field)
      .doc("displacement, stress or equivalent-stress; with 'analysis: thermal' temperature or heat");
  s.value("component", q.component).doc("x, y or z of a displacement; xx, yy, zz, xy, yz or xz of a stress");
  s.check([&q, dimension] { return wrong_quantity(q, dimension); }, "field");
}

void declare(config::Section& s, SolidOutputParameters& o) {
  s.value("stress", o.stress).doc("write stress components and the equivalent stress");
  s.value("strain", o.strain).doc("write strain components");
  s.value("point-stress", o.point_stress)
      .doc(
          "also write stress components at the points; where materials meet, those of the side with the larger "
          "equivalent stress");
  s.value("acceleration", o.acceleration).doc("write the acceleration of a dynamic analysis");
  s.value("surfaces", o.surfaces)
      .doc(
          "patches, or [all], for which surface-<patch>.xdmf is written at each output: displacement, stress and traction, and "
          "temperature and heat flux if the case has them");
  s.value("moments", o.moments)
      .doc(
          "also write to reactions.csv the moment of each patch's force about the origin; at finite strain that of the "
          "deformed body");
  s.value("energies", o.energies).doc("write the energies after each step to energies.csv");
  s.value("spectrum", o.spectrum)
      .doc(
          "write the eigenvalues of M^-1 K of a dynamic analysis to spectrum.csv at the start and report "
          "the growth rate of free vibration; for small meshes");
  s.value("modes", o.modes)
      .range(0, 1000)
      .doc(
          "number of lowest free vibrations to compute; 0 means none. They are those of the unloaded body at the start of a "
          "dynamic analysis, or of the loaded equilibrium at the end of a linear static one, whose stress and loads stiffen or "
          "soften the body. They are written to modes.csv and, in 3-D, to modes.h5, which plate_modal reads; requires "
          "'face-gradient: symmetric'");
  s.value("buckling", o.buckling)
      .range(0, 1000)
      .doc(
          "number of lowest load factors at which the equilibrium of a linear static analysis buckles; 0 means none; default "
          "with 'analysis: buckling': 4. They are computed at the end and written to buckling.csv, the mode shapes to "
          "buckling.xdmf; requires 'face-gradient: symmetric'. Pressures follow the surface; they and body forces are "
          "evaluated at the place to which the body moves; other loads keep their direction");
}

namespace {

void declare_scene(config::Section& s, SolidParameters& p) {
  using Analysis = SolidParameters::Analysis;
  using Plane = SolidParameters::Plane;
  s.value("mesh", p.mesh)
      .required()
      .doc(
          "mesh file: .msh, .geo, .inp or a cut mesh, .h5 (other formats: docs/formats.md), relative to the YAML file");
  s.value("mesh-scale", p.mesh_scale)
      .positive()
      .doc(
          "scale factor for all lengths of the mesh file: 0.001 for a mesh in millimeters; positions in "
          "keys remain in meters");
  using TouchingFaces = SolidParameters::TouchingFaces;
  s.choice(
       "touching-faces", p.touching_faces,
       {{"refused", TouchingFaces::refused}, {"tie", TouchingFaces::tie}, {"apart", TouchingFaces::apart}})
      .doc(
          "treatment of parts of the mesh that touch without sharing points. refused: an error, unless the faces on both sides "
          "are separate patches with a load or support (with `heat` also with a thermal condition). tie: joins faces that are "
          "in groups of the mesh and have the same corners (within 1e-4 of their size), and refuses conditions on them. apart: "
          "keeps them separate, like the faces of a crack");
  s.value("mesh-parameters", p.mesh_parameters)
      .doc("values, such as {n: 8}, for names that the .geo defines with DefineConstant");
  s.value("dimension", p.dimension).range(2, 3).doc("2 (cells in the plane z = 0, with unit depth) or 3");
  s.choice("plane", p.plane,
           {{"strain", Plane::strain}, {"stress", Plane::stress}, {"axisymmetric", Plane::axisymmetric}})
      .doc(
          "assumption of a 2-D case. axisymmetric: a body of revolution about the y axis, x is the radius; edges on the axis x = 0 need 'type: symmetry'");
  s.check(
      [&p] {
        return p.dimension == 3 && p.plane != Plane::strain ? "only for 2-dimensional cases; remove this key"
                                                            : "";
      },
      "plane");
  s.choice("analysis", p.analysis,
           {{"dynamic", Analysis::dynamic},
            {"static", Analysis::static_},
            {"thermal", Analysis::thermal},
            {"modal", Analysis::modal},
            {"buckling", Analysis::buckling}})
      .doc(
          "dynamic: with inertia; static: without; thermal: heat conduction only; modal: computes the lowest free vibrations "
          "at the start, 10 or as many as 'output.modes' says, for which one step without loads is enough; buckling: static, "
          "and computes the lowest load factors at which the body buckles, 4 or as many as 'output.buckling' says");
  if (p.analysis == Analysis::modal) {
    p.analysis = Analysis::dynamic;
    p.output.modes = 10;
  }
  if (p.analysis == Analysis::buckling) {
    p.analysis = Analysis::static_;
    p.seeks_buckling = true;
    p.output.buckling = 4;
  }
  using Kinematics = SolidParameters::Kinematics;
  s.choice("kinematics", p.kinematics,
           {{"small-strain", Kinematics::small_strain}, {"finite-strain", Kinematics::finite_strain}})
      .doc(
          "finite-strain: large rotations and strains, hyperelastic material.law, Newton's method on the "
          "symmetric face gradient");
  s.value("energy-momentum", p.energy_momentum)
      .doc(
          "for dynamic finite strain with the trapezoidal rule: the work of the stress in a step equals the "
          "change of the strain energy, so energy and momenta are conserved");
}

void declare_materials(config::Section& s, SolidParameters& p) {
  const bool is_elastic = p.analysis != SolidParameters::Analysis::thermal;
  s.optional_section<bool>(
      "material", p.material_given,
      [&p, is_elastic](config::Section& m, bool&) { declare(m, p.material, is_elastic); },
      "linear elastic material of the whole solid");
  s.map<ZoneMaterial>(
      "materials", p.materials,
      [is_elastic](config::Section& m, ZoneMaterial& v) { declare(m, v, is_elastic); }, "material",
      "instead of 'material': several materials, each with its zones of the mesh; they are bonded where they meet");
  s.check(
      [&p] {
        return p.material_given.has_value() == p.materials.empty()
                   ? ""
                   : "give either 'material' (of the whole solid) or 'materials' (by zone of the mesh)";
      },
      "material");
}

/// Declares supports and loads.
void declare_loads(config::Section& s, SolidParameters& p) {
  s.map<SolidBoundary>(
      "boundaries", p.boundaries, [&p](config::Section& b, SolidBoundary& v) { declare(b, v, p.dimension); },
      "patch", "one entry for each patch of the mesh");
  s.map<PointLoad>(
      "point-loads", p.point_loads, [&p](config::Section& l, PointLoad& v) { declare(l, v, p.dimension); },
      "load", "forces and moments at points of the surface, in addition to the patch loads");
  s.optional_section<contact::ContactParameters>(
      "contact", p.contact,
      [](config::Section& c, contact::ContactParameters& v) { contact::declare(c, v, "z, in 2-D y"); },
      "a rigid seat without friction, which free, loaded and interface faces may touch");
  s.value("body-force", p.body_force)
      .unit("N/m^3", 1e-6, 1e11)
      .doc("force per volume, one expression of x, y, z, t per component");
  s.value("gravity", p.gravity)
      .unit("m/s^2", 1e-3, 2000)
      .doc("acceleration of gravity, one number per component");
  s.value("initial-velocity", p.initial_velocity)
      .unit("m/s", 1e-9, 1e4)
      .doc("initial velocity, one expression of x, y, z per component");
}

void declare_probe(config::Section& s, SolidProbe& probe, int dimension) {
  {
    config::Key point = s.value("point", probe.point);
    point.unit("m", 1e-9, 1e4).required().doc("position in the undeformed solid");
    if (dimension == 3) point.size(3);
  }
  declare(s, probe);
}

void declare_output(config::Section& s, SolidParameters& p) {
  s.map<SolidProbe>(
      "probes", p.probes, [&p](config::Section& q, SolidProbe& v) { declare_probe(q, v, p.dimension); },
      "probe", "points whose displacement is written to probes.csv at each step");
  s.map<SolidQuantity>(
      "quantities", p.quantities, [&p](config::Section& q, SolidQuantity& v) { declare(q, v, p.dimension); },
      "quantity",
      "quantities of interest whose errors are estimated at the end of a linear static or steady heat-conduction run, each by "
      "one additional solve with the same matrix");
  s.section(
      "output",
      [&](config::Section& o) {
        declare(o, p.output);
        // Patches that only conduct heat need no entry; SurfaceSeries checks those.
        if (!p.heat) o.check([&] { return io::wrong_surfaces(p.output.surfaces, p.boundaries); }, "surfaces");
      },
      "fields written at the output interval");
}

}  // namespace

void declare(config::Section& s, SolidParameters& p) {
  declare_scene(s, p);
  declare_materials(s, p);
  declare_loads(s, p);
  s.section(
      "time-scheme",
      [&](config::Section& t) {
        time::declare(t, p.time_scheme, "; auto: generalised-alpha with an interface, else trapezoidal");
      },
      "time integration of a dynamic analysis");
  s.optional_section<SolidDamping>(
      "damping", p.damping, [](config::Section& d, SolidDamping& v) { declare(d, v); },
      "structural damping; dynamic analysis only");
  declare_heat(s, p);
  s.optional_section<TimeStepControl>(
      "time-step-control", p.step_control, [](config::Section& c, TimeStepControl& v) { declare(c, v); },
      "halves steps ('simulation.time-step' is the longest, 'max-step-halvings' limits) where the estimated "
      "error of the time scheme requires it; dynamic analysis only");
  s.section(
      "load-stepping", [&](config::Section& l) { declare(l, p.load_stepping); },
      "steps of a static analysis at large strain");
  s.section(
      "solution-method", [&](config::Section& m) { declare(m, p.method); },
      "solution method for the equations of a step");
  declare_output(s, p);
  check_heat(s, p);
  check_together(s, p);
  check_finite_strain(s, p);
  check_orthotropic(s, p);
  check_axisymmetric(s, p);
  check_rigid_patches(s, p);
  check_contact(s, p);
  check_load_stepping(s, p);
  check_buckling(s, p);
  check_quantities(s, p);
}

}  // namespace couplet::solid
