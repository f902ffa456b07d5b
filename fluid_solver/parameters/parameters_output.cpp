// SPDX-License-Identifier: Apache-2.0
// Keys of the section `output`.
#include <Eigen/Geometry>

#include "fluid_solver/parameters/gradient_fields.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {
namespace {

void declare_coefficients(config::Section& s, CoefficientParameters& c) {
  s.value("patches", c.patches).required().doc("walls whose forces are summed");
  s.value("speed", c.speed)
      .unit("m/s")
      .plausible(1e-9, 1e4)
      .positive()
      .required()
      .doc("U of the dynamic pressure q = rho U^2 / 2");
  s.value("area", c.area)
      .unit("m^2")
      .plausible(1e-14, 1e7)
      .positive()
      .required()
      .doc("A: force over q A; in 2-D a length times 1 m");
  s.value("length", c.length).unit("m").plausible(1e-9, 1e4).positive().doc("L: moment over q A L");
  s.value("pressure", c.pressure)
      .unit("Pa")
      .plausible(1e-9, 1e9)
      .doc("p_ref of Cp = (p - p_ref) / q at these walls, written where 'surfaces' names them");
  s.value("drag", c.drag).doc("direction of the first coefficient; need not be of length 1");
  s.value("lift", c.lift).doc("direction of the second coefficient");
  s.value("centre", c.centre).unit("m").plausible(1e-9, 1e4).doc("fixed reference point of the moment");
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
                   : "it is along 'drag'; both coefficients would be of the same force";
      },
      "lift");
}

void declare_sample(config::Section& s, SampleParameters& p) {
  using Type = SampleParameters::Type;
  const auto line = [&p](config::Section& v) {
    v.value("from", p.from)
        .unit("m")
        .plausible(1e-9, 1e4)
        .required()
        .doc("first end, in the reference configuration");
    v.value("to", p.to).unit("m").plausible(1e-9, 1e4).required().doc("other end");
    v.value("points", p.points).range(2, 100000).doc("number of points, ends included");
    v.check([&p] { return p.from == p.to ? "'from' and 'to' coincide" : ""; }, "to");
  };
  const auto plane = [&p, line](config::Section& v) {
    line(v);
    v.value("up", p.up)
        .unit("m")
        .plausible(1e-9, 1e4)
        .required()
        .doc("third corner: the plane is from-to by from-up");
    v.value("rows", p.rows).range(2, 10000).doc("number of points along from-up");
    v.check(
        [&p] { return (p.to - p.from).cross(p.up - p.from).norm() > 0 ? "" : "the corners lie on one line"; },
        "up");
  };
  s.variant("type", p.type, {{"line", Type::line, line}, {"plane", Type::plane, plane}},
            "line: points from one end to the other; plane: a grid of points", true);
}

}  // namespace

void declare_output(config::Section& s, FluidOutputParameters& p) {
  for (const GradientField& field : gradient_fields())
    s.value(field.name, p.gradient_fields[field.name]).doc(field.meaning);
  s.value("walls", p.walls)
      .doc("walls.csv: shear and y+ of each wall; with a turbulence model it is always written");
  s.value("fluxes", p.fluxes)
      .doc(
          "fluxes.csv: volume and momentum that pass through each patch out of the fluid (a load is a flux of momentum), mean "
          "pressure");
  s.value("surfaces", p.surfaces)
      .doc(
          "patches, or [all]: surface-<patch>.xdmf with pressure, traction, wall shear, y+ at walls, and Cp at walls that "
          "'coefficients' names, at each output");
  s.map<CoefficientParameters>(
      "coefficients", p.coefficients, declare_coefficients, "name",
      "coefficients.csv: force and moment coefficients of some walls, means over the step");
  s.map<FlowAreaParameters>(
      "flow-areas", p.flow_areas,
      [](config::Section& area, FlowAreaParameters& a) {
        area.value("from", a.from).required().doc("patch upstream, whose inflow counts");
        area.value("to", a.to).required().doc("patch downstream");
        area.check([&a] { return a.from == a.to ? "'from' and 'to' are the same patch" : ""; }, "to");
      },
      "name",
      "flow-areas.csv: effective flow area between two patches, m/sqrt(2 rho (p_from - p_to)) with the mass flow m and mean "
      "pressures");
  s.map<SampleParameters>(
      "samples", p.samples, declare_sample, "name",
      "sample-<name>.csv: velocity and pressure (with 'statistics' their means and rms) on a line or plane "
      "at each output; the points move with the mesh, and points outside it are omitted");
  s.value("energy-budget", p.energy_budget)
      .doc(
          "energy.csv: kinetic energy and the power that viscosity, eddy viscosity and pressure take from "
          "it");
}

}  // namespace couplet::fluid
