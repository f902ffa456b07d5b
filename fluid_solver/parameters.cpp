// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/parameters.hpp"

namespace couplet::fluid {
namespace {

void declare_boundary(config::Section& s, BoundaryParameters& b) {
  const auto velocity = [&b](config::Section& v) {
    v.value("velocity", b.velocity)
        .unit("m/s")
        .required()
        .doc("one expression of x, y, z [m] and t [s] a component");
  };
  const auto nothing = [](config::Section&) {};
  s.variant(
      "type", b.type,
      {{"inlet", BoundaryType::inlet,
        [&b, velocity](config::Section& v) {
          velocity(v);
          v.value("ramp", b.ramp)
              .unit("s")
              .positive()
              .doc("the velocity grows from 0 as (1 - cos(pi t/ramp))/2 until t = ramp; absent: no ramp");
        }},
       {"outlet", BoundaryType::outlet,
        [&b](config::Section& v) {
          v.value("pressure", b.pressure).unit("Pa").doc("expression of x, y, z [m] and t [s]");
        }},
       {"no-slip", BoundaryType::no_slip, nothing},
       {"moving-wall", BoundaryType::moving_wall, velocity},
       {"slip", BoundaryType::slip, nothing},
       {"interface", BoundaryType::interface, nothing}},
      "inlet: given velocity; outlet: given pressure; no-slip: wall at rest; moving-wall: wall with a given "
      "velocity; slip: no flow through, no friction (also a symmetry plane); interface: wall that moves with "
      "the structure",
      true);
}

}  // namespace

void declare(config::Section& s, FluidParameters& p) {
  s.value("mesh", p.mesh).required().doc("mesh file, .msh or .geo, relative to the case's folder");
  s.value("mesh-parameters", p.mesh_parameters)
      .doc("numbers for names that the .geo defines by DefineConstant: {n: 8}");
  s.value("dimension", p.dimension).required().range(2, 3).doc("2 or 3; a 2-D scene is 1 m deep");
  s.value("density", p.density).unit("kg/m^3").positive().required().doc("density");
  s.value("viscosity", p.viscosity).unit("Pa s").not_negative().required().doc("dynamic viscosity");
  s.map<BoundaryParameters>("boundaries", p.boundaries, declare_boundary, "patch",
                            "what happens at each patch of the mesh; every patch needs an entry");
  s.value("time-step", p.time_step)
      .unit("s")
      .positive()
      .doc(
          "largest step of the fluid itself; a coupling step is cut into equal parts not larger than it. "
          "Absent: "
          "the stability limit");
  s.value("safety-factor", p.safety_factor)
      .range(0.05, 1)
      .doc("part of the stability limit that is used when time-step is absent");
  s.choice("viscous", p.viscous,
           {{"auto", ViscousTreatment::automatic},
            {"explicit", ViscousTreatment::explicit_},
            {"implicit", ViscousTreatment::implicit}})
      .doc(
          "time scheme of the viscous term; auto: implicit where its explicit stability limit would cost "
          "clearly "
          "more steps;");
  s.value("pressure-tolerance", p.pressure_tolerance)
      .range(1e-14, 1e-1)
      .doc(
          "of the pressure equation, relative to the divergence of the predicted velocity; a coupled run "
          "needs about "
          "1e-4 of the coupling tolerance");
  s.value("initial-velocity", p.initial_velocity)
      .unit("m/s")
      .doc("one expression of x, y, z [m] a component; made divergence-free at the start. Absent: at rest");
  s.value("initial-pressure", p.initial_pressure)
      .unit("Pa")
      .doc("expression of x, y, z [m]; a first guess only");
  s.value("flux-memory", p.flux_memory)
      .doc(
          "keep the difference between face fluxes and averaged cell velocities from step to step, so that "
          "small "
          "steps do not smooth the pressure");
  s.map<ProbeParameters>(
      "probes", p.probes,
      [](config::Section& q, ProbeParameters& probe) {
        q.value("point", probe.point).unit("m").required().doc("place in the reference configuration");
      },
      "probe", "points whose velocity and pressure are written after each step");
}

}  // namespace couplet::fluid
