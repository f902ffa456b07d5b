# SPDX-License-Identifier: Apache-2.0
"""Fluids: properties, openings, motion."""
OIL = [("density: 900 kg/m^3", "density: 1000 kg/m^3")]
LEFT, RIGHT = "left: {type: inlet, velocity: [0.1 m/s, 0 m/s]}", "right: {type: outlet, pressure: 0}"
WALLS = [("bottom: {type: slip}", "bottom: {type: no-slip}"), ("top: {type: slip}", "top: {type: no-slip}")]
STIFF = WALLS + [("50 Pa s", "5000 Pa s"), ("end-time: 1 s", "end-time: 20 s")]
MISTAKES = [
    ("kinematic for dynamic viscosity", "fluid", OIL + [("50 Pa s", "1e-6")], "flagged",
     {"message": "viscosity/density is 1e-09 m^2/s (usual: at least 5e-08 m^2/s): implausible"}),
    ("kinematic viscosity with its unit", "fluid", OIL + [("50 Pa s", "1e-6 m^2/s")], "refused",
     {"message": "'1e-6 m^2/s': the unit 'm^2/s' is not convertible to Pa s"}),
    ("density of air for water", "fluid", [("density: 900 kg/m^3", "density: 1.2 kg/m^3"), ("50 Pa s", "1 mPa s")], "right",
     {"message": "a gas of this viscosity is hot, but possible; no key tells which fluid is meant"}),
    ("density of water with the viscosity of air", "fluid", OIL + [("50 Pa s", "18 uPa s")], "flagged", {"message": "viscosity/density is 1.8e-08 m^2/s"}),
    ("no mistake: fluid", "fluid", [], "right", {"message": "the case that the others differ from", "run": True}),
    ("inflow through an outlet", "fluid", [(LEFT, "left: {type: outlet}"), ("    boundaries:", "    body-force: [1 m/s^2, 0]\n    boundaries:")], "flagged",
     {"message": "outlet 'left': ", "run": True}),
    ("a pressure that pushes through an outlet", "fluid", [(RIGHT, "right: {type: outlet, pressure: 1 Pa}"), (LEFT, "left: {type: outlet}")], "right",
     {"message": "a pressure that is given pushes", "run": True}),
    ("inlet that sucks", "fluid", [("[0.1 m/s, 0 m/s]", "[-0.1 m/s, 0 m/s]")], "flagged",
     {"message": "inlet 'left': outflow 0.1 m^3 (expected: none): implausible", "run": True}),
    ("inlets without an outlet", "fluid", [(RIGHT, "right: {type: no-slip}")], "refused",
     {"message": "The fluid domain is closed, but the prescribed velocities give a net outflow of -0.1 m^3/s. Add an outlet", "run": True, "code": 1}),
    ("three components in two dimensions", "fluid", [("[0.1 m/s, 0 m/s]", "[0.1, 0, 0]")], "refused",
     {"message": "3 components are given, but the 2-dimensional scene needs 2."}),
    ("degrees for radians in a motion", "fluid", [("    boundaries:", "    motion: {angle: 30}\n    boundaries:")], "refused",
     {"message": "motion.angle: '30' has no unit, but one is required: write 30 deg or 30 rad."}),
    ("hertz for radians per second", "fluid", [("    boundaries:", "    rotating-frame: {speed: 10 Hz}\n    boundaries:")], "refused",
     {"message": "rotating-frame.speed: '10 Hz': the unit 'Hz' is not convertible to rad/s (a turn is 6.2832 rad or 360 deg)."}),
    ("a step far beyond the explicit limit", "fluid", STIFF + [("    boundaries:", "    viscous: explicit\n    time-step: 0.5 s\n    boundaries:")],
     "refused", {"message": "The explicit viscous term is stable there up to a step of", "run": True, "code": 1}),
    ("a long step that the fluid may divide", "fluid", STIFF + [("    boundaries:", "    viscous: explicit\n    boundaries:")],
     "right", {"message": "the fluid cuts the step to its limit", "run": True}),
]
