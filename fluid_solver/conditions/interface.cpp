// SPDX-License-Identifier: Apache-2.0
// A wall that moves with the structure. Where its mass is known the pressure equation foresees its answer, as a Robin
// condition: pressure/yielding_walls.
#include "fluid_solver/conditions/condition.hpp"

namespace couplet::fluid {
namespace {

void declare_interface(config::Section& s, BoundaryParameters& b) {
  s.value("surface-density", b.surface_density)
      .unit("kg/m^2")
      .plausible(1e-6, 1e6)
      .positive()
      .doc(
          "mass per area of the structure behind the wall: the pressure equation then anticipates "
          "its response (Robin condition), with `coupling.order: structure-first`; the density of a "
          "solid times its thickness, or less: too small costs passes, too large may diverge; "
          "absent: the wall moves as the coupling prescribes");
  s.choice("impedance", b.impedance, {{"given", Impedance::given}, {"structure", Impedance::structure}})
      .doc(
          "source of the surface density: given: `surface-density`, if present; structure: the "
          "structure itself, for each face (solid_solver with `interface: {surface-density: true}`, "
          "plate_modal with `surface-density: true`, or any program that gives 'surface-density' "
          "[kg/m^2] at its faces)");
  s.choice("sides", b.sides,
           {{"auto", Sides::automatic}, {"together", Sides::together}, {"apart", Sides::apart}})
      .doc(
          "Robin condition of faces that lie opposite each other, on two wet sides of one body no thicker than a "
          "quarter of the interface's extent: together: one motion, driven by the difference of their pressures, with "
          "the mass of both, refused where there are none, and in a fluid without an outlet; apart: each for itself, for a body that a pressure wave needs more than a step to cross; auto: together where that is possible");
  s.check(
      [&b] {
        return b.sides != Sides::automatic && !b.foresees()
                   ? "there is no Robin condition here: set 'surface-density' or 'impedance: structure', or remove the key"
                   : "";
      },
      "sides");
  s.check(
      [&b] {
        return b.surface_density && b.impedance == Impedance::structure
                   ? "the structure gives it: remove 'surface-density'"
                   : "";
      },
      "impedance");
}

}  // namespace

Condition conditions::interface() {
  return {.name = "interface",
          .about = "interface: wall that moves with the structure",
          .declare = declare_interface,
          .velocity = GivenBy::structure,
          .wall = true};
}

}  // namespace couplet::fluid
