# SPDX-License-Identifier: Apache-2.0
"""Wrong fluids; joined by table.py."""

REED = """simulation: {end-time: 1 s, time-step: 0.5 s}
participants:
  fluid:
    program: fluid_solver
    dimension: 2
    boundaries:
      left: {type: inlet, velocity: [1 m/s, 0 m/s]}
      top: {type: interface, surface-density: MASS}
      right: {type: outlet}
      bottom: {type: no-slip}
    mesh: square.msh
    density: 1 kg/m^3
    viscosity: 1e-3 Pa s
  reed:
    program: plate_modal
    mesh: square.msh
    material: {density: 7850 kg/m^3, youngs-modulus: 200 GPa, poissons-ratio: 0.3}
    thickness: 0.4 mm
    boundaries: {left: {type: clamped}, right: {type: free}, top: {type: free}, bottom: {type: free}}
coupling:
  fluid: {participant: fluid}
  structure: {participant: reed}
"""


def cases(fluid, RUN):
    return [
    fluid("viscosity of the other kind", """
case.yaml:9:5: participants.fluid.viscosity: '1e-6 m^2/s': the unit 'm^2/s' is not convertible to Pa s. Expected Pa s or a unit convertible to it.
""", ("1e-3 Pa s", "1e-6 m^2/s")),
    fluid("boundary of a fluid without type", """
case.yaml:13:7: participants.fluid.boundaries.bottom.type: this required key is missing (one of: inlet, outlet, convective-outlet, no-slip, moving-wall, partial-slip, slip, symmetry, periodic, interface, body).
""", ("{type: no-slip}", "{}")),
    fluid("inlet without velocity", """
case.yaml:11:14: participants.fluid.boundaries.left.type: give either 'velocity', 'mean-speed' or 'table'.
""", (", velocity: [1 m/s, 0 m/s]", "")),
    fluid("inlet with two velocities", """
case.yaml:11:14: participants.fluid.boundaries.left.type: give either 'velocity', 'mean-speed' or 'table'.
""", (", velocity: [1 m/s", ", mean-speed: 1, velocity: [1 m/s")),
    fluid("velocity from a file that is not there", """
case.yaml:11:35: participants.fluid.boundaries.left.table.file: the file 'none.csv' does not exist.
""", (", velocity: [1 m/s, 0 m/s]", ", table: {file: none.csv}")),
    fluid("velocity from a file with a gap", """
[fluid 0] error: in.csv: the grid has no value at y = 1, t = 1; a table must be a full grid.
""", (", velocity: [1 m/s, 0 m/s]", ", table: {file: in.csv}"), files={"in.csv": "y,t,u,v\n0,0,1,0\n0,1,1,0\n1,0,1,0\n"}, **RUN),
    fluid("line of a single point", """
case.yaml:10:57: participants.fluid.output.samples.a.to: 'from' and 'to' coincide.
""", ("    boundaries:\n", "    output: {samples: {a: {type: line, from: [0, 0, 0], to: [0, 0, 0]}}}\n    boundaries:\n")),
    fluid("flow area between a patch and itself", """
case.yaml:10:43: participants.fluid.output.flow-areas.a.to: 'from' and 'to' are the same patch.
""", ("    boundaries:\n", "    output: {flow-areas: {a: {from: left, to: left}}}\n    boundaries:\n")),
    fluid("flow area from a patch that is not there", """
case.yaml:10:14: participants.fluid.output.flow-areas: 'lift' of 'a' is not a patch of the boundary; these are: bottom, left, right, top.
""", ("    boundaries:\n", "    output: {flow-areas: {a: {from: lift, to: right}}}\n    boundaries:\n")),
    fluid("turbulence model that is not there", """
case.yaml:10:18: participants.fluid.turbulence.model: 'smagorinski' is not one of: smagorinsky, wale. Did you mean 'smagorinsky'?
""", ("    boundaries:\n", "    turbulence: {model: smagorinski}\n    boundaries:\n")),
    fluid("immersed body without a level", """
case.yaml:10:14: participants.fluid.bodies.ball.level: this required key is missing (expression of x, y, z [m] and t [s]: negative inside, approximately the distance near the surface: number or expression in m).
""", ("    boundaries:\n", "    bodies: {ball: {velocity: [1, 0]}}\n    boundaries:\n")),
    fluid("immersed body in a closed fluid", """
case.yaml:10:5: participants.fluid.bodies: immersed bodies may displace fluid, which needs an outlet.
""", ("    boundaries:\n", "    bodies: {ball: {level: x}}\n    boundaries:\n"), ("{type: outlet, pressure: 0}", "{type: no-slip}")),
    fluid("motion that moves nothing", """
case.yaml:10:5: participants.fluid.motion: nothing moves without a 'translation', an 'angle' or a 'displacement'.
""", ("    boundaries:\n", "    motion: {outer-radius: 1}\n    boundaries:\n")),
    fluid("gap between walls at rest", """
warning: case.yaml:10:5: participants.fluid.gaps: both walls of 'slot' are at rest, so that it neither closes nor opens: one of them must be of `type: interface` or `body`.
""", ("    boundaries:\n", "    gaps: {slot: {between: [bottom, left], opening: 1 mm}}\n    boundaries:\n"), exit_code=0),
    fluid("gap with a wall that may move", "",
          ("    boundaries:\n", "    gaps: {slot: {between: [bottom, top], opening: 1 mm}}\n    boundaries:\n"), exit_code=0),
    fluid("wall a thousand times as heavy as its plate", """
warning: case.yaml:8:30: participants.fluid.boundaries.top.surface-density: 3140 kg/m^2, but the plate 'reed' has 3.14 kg/m^2, density times thickness: implausible; check the number and its unit.
""", text=REED.replace("MASS", "3140 kg/m^2"), exit_code=0),
    fluid("wall as heavy as its plate", "", text=REED.replace("MASS", "3.14 kg/m^2"), exit_code=0),
    fluid("periodic without partner", """
case.yaml:12:7: participants.fluid.boundaries.right.partner: this required key is missing (the patch that is a translated copy of this one: text).
""", ("{type: outlet, pressure: 0}", "{type: periodic}")),
    fluid("partial slip without its length", """
case.yaml:12:7: participants.fluid.boundaries.right.slip-length: this required key is missing (distance behind the wall at which the velocity along it, continued, is zero: u = L du/dn: number in m).
""", ("{type: outlet, pressure: 0}", "{type: partial-slip}")),
    fluid("partial slip of no length", """
case.yaml:12:35: participants.fluid.boundaries.right.slip-length: 0 m is out of range; expected a value above 0 m.
""", ("{type: outlet, pressure: 0}", "{type: partial-slip, slip-length: 0}")),
    fluid("component with a wrong unit", """
case.yaml:11:27: participants.fluid.boundaries.left.velocity: entry 2 of the list: '0 Pa': the unit 'Pa' is not convertible to m/s. Expected m/s or a unit convertible to it.
""", ("0 m/s]", "0 Pa]")),
    fluid("parabola of a velocity that is given", """
case.yaml:11:14: participants.fluid.boundaries.left.type: 'profile: parabolic' requires 'mean-speed'; use 'mean-speed', or remove 'profile'.
""", (", velocity: [1 m/s, 0 m/s]", ", profile: parabolic, velocity: [1 m/s, 0 m/s]")),
    fluid("moment about an axis in the plane", """
[fluid 0] error: output.coefficients.a.axis: a 2-D scene rotates about z, [0, 0, 1]; for the opposite direction use a negative angle or speed.
""", ("    boundaries:\n", "    output: {coefficients: {a: {patches: [top], speed: 1, area: 1, axis: [1, 0, 0]}}}\n    boundaries:\n"), **RUN),
    fluid("forces without a direction", """
case.yaml:10:68: participants.fluid.output.coefficients.a.drag: a direction must not be zero.
""", ("    boundaries:\n", "    output: {coefficients: {a: {patches: [top], speed: 1, area: 1, drag: [0, 0, 0]}}}\n    boundaries:\n")),
    fluid("bound of implicit steps where steps are explicit", """
case.yaml:11:5: participants.fluid.implicit-stretch: it bounds steps with an implicit viscous term, but 'viscous' is explicit; remove it.
""", ("    boundaries:\n", "    viscous: explicit\n    implicit-stretch: 4\n    boundaries:\n")),
    fluid("inner radius without an outer one", """
case.yaml:10:5: participants.fluid.motion.outer-radius: 'inner-radius' has no effect without 'outer-radius'; give both or neither.
""", ("    boundaries:\n", "    motion: {angle: 0.1*t, inner-radius: 0.1}\n    boundaries:\n")),
    fluid("outlet with a velocity", """
case.yaml:12:29: participants.fluid.boundaries.right.velocity: this key is not valid here; it requires type: inlet or type: moving-wall.
""", ("pressure: 0", "velocity: [1, 0]")),
    fluid("two sides without a Robin condition", """
case.yaml:12:32: participants.fluid.boundaries.right.sides: there is no Robin condition here: set 'surface-density' or 'impedance: structure', or remove the key.
""", ("type: outlet, pressure: 0", "type: interface, sides: apart")),
    fluid("sides together without a Robin condition", """
case.yaml:12:32: participants.fluid.boundaries.right.sides: there is no Robin condition here: set 'surface-density' or 'impedance: structure', or remove the key.
""", ("type: outlet, pressure: 0", "type: interface, sides: together")),
    fluid("unknown treatment", """
case.yaml:10:5: participants.fluid.viscous: 'implizit' is not one of: auto, explicit, implicit. Did you mean 'implicit'?
""", ("    boundaries", "    viscous: implizit\n    boundaries")),
    fluid("true or false", """
case.yaml:10:14: participants.fluid.output.vorticity: '2' is not valid; expected true or false.
""", ("    boundaries", "    output: {vorticity: 2}\n    boundaries")),
]
