# SPDX-License-Identifier: Apache-2.0
"""The wrong configurations: how each differs from a right one, and what the program must say about it."""
import pathlib
from dataclasses import dataclass, field

import check_table
import flow_table
import material_table
import plant_table
import plate_table
import tank_table


@dataclass
class Case:
    name: str
    program: str
    message: str = ""
    base: str = ""  # NAME.yaml beside this file ...
    edits: list = field(default_factory=list)  # ... with these (old, new) replacements
    text: str = None  # or the whole YAML file
    arguments: list = field(default_factory=lambda: ["case.yaml", "--check"])
    files: dict = field(default_factory=dict)  # further files in the folder of the case
    exit_code: int = 2


def solid(name, message, *edits, **more):
    return Case(name, "solid_solver", message, "solid", list(edits), **more)


def fluid(name, message, *edits, **more):
    return Case(name, "fluid_solver", message, "fluid", list(edits), **more)


def coupler(name, message, *edits, **more):
    return Case(name, "coupler", message, "coupled", list(edits), **more)


def mover(name, message, *edits, **more):
    return Case(name, "mesh_mover", message, "coupled", list(edits), **more)


RUN = {"arguments": ["case.yaml"]}


def with_set(*assignments):
    arguments = ["case.yaml", "--check"]
    for assignment in assignments:
        arguments += ["--set", assignment]
    return {"arguments": arguments}


# The right ones: without them every message below could come from somewhere else.
RIGHT = [
    solid("right solid", "", exit_code=0),
    fluid("right fluid", "", exit_code=0),
    coupler("right coupling", "", exit_code=0),
    mover("right mover", "", exit_code=0),
    solid("right name", "", ("  solid:", '  "checkpoints2":'), exit_code=0),
]

FILE = [
    solid("no such file", "cases.yaml: this file does not exist. Give the path of the case's YAML file.", arguments=["cases.yaml", "--check"]),
    solid("a folder instead of a file", """
.: this is a folder; give the YAML file in it, for example ./case.yaml.
""", arguments=[".", "--check"]),
    solid("empty file", """
case.yaml:1:1: this file is empty.
case.yaml:1:1: the `participants` section, which defines what solid_solver runs, is missing.
""", text=""),
    solid("a list instead of a mapping", """
case.yaml:1:1: expected a mapping (keys with values), found a list.
case.yaml:1:1: the `participants` section, which defines what solid_solver runs, is missing.
""", text="- a\n- b\n"),
    solid("tab", "case.yaml:5:2: this is not valid YAML: tabs cannot be used for indentation; use spaces.", ("    program", "\tprogram")),
    solid("list that is not closed", """
case.yaml:14:52: this is not valid YAML: this bracket closes nothing; check '[', ']', '{' and '}'.
""", ("value: [0, 0]}", "value: [0, 0}")),
    solid("mapping that is not closed", """
case.yaml:3:13: this is not valid YAML: a mapping opened with '{' before this position is not closed by '}'.
""", ("time-step: 0.5 s}", "time-step: 0.5 s")),
    solid("indented too little", """
case.yaml:9:4: this is not valid YAML: this line does not match the mapping above; check its indentation and its ':'.
""", ("    material", "   material")),
    solid("two colons in a line", """
case.yaml:5:26: this is not valid YAML: a ':' is not allowed here; check the indentation above, and quote text that contains ': '.
""", ("program: solid_solver", "program: solid_solver: 2")),
    solid("duplicate key", """
case.yaml:8:5: participants.solid.mesh: this key appears twice (first at 6:5); remove one of the two.
""", ("    analysis", "    mesh: other.msh\n    analysis")),
    coupler("duplicate participant", """
case.yaml:16:3: participants.fluid: this key appears twice (first at 5:3); remove one of the two.
""", ("  solid:", "  fluid:")),
    solid("unknown section", """
case.yaml:2:1: simulations: unknown section. Did you mean 'simulation'?
case.yaml:1:1: simulation: this section is missing. Did you write 'simulations'?
""", ("simulation:", "simulations:")),
    solid("anchor that does not exist", """
case.yaml:11:23: this is not valid YAML: this '*name' refers to an anchor '&name' that does not exist.
""", ("1 MPa", "*modulus")),
]

SIMULATION = [
    solid("no simulation", "case.yaml:1:1: simulation: this section is missing.", ("simulation: {end-time: 1 s, time-step: 0.5 s}\n", "")),
    solid("no end time", """
case.yaml:2:1: simulation.end-time: this required key is missing (end time of the run: number in s).
""", ("end-time: 1 s, ", "")),
    solid("unit of another quantity", """
case.yaml:2:14: simulation.end-time: '1 m': the unit 'm' is not convertible to s. Expected s or a unit convertible to it.
""", ("end-time: 1 s", "end-time: 1 m")),
    solid("unknown unit", """
case.yaml:2:14: simulation.end-time: '1 sec': unknown unit 'sec'. Expected s or a unit convertible to it.
""", ("end-time: 1 s", "end-time: 1 sec")),
    solid("decimal comma", """
case.yaml:2:14: simulation.end-time: '1,5 s' has a decimal comma; use a decimal point.
""", ("end-time: 1 s", 'end-time: "1,5 s"')),
    solid("not a number", """
case.yaml:2:14: simulation.end-time: 'long' is not a number; expected a number in s or with its unit.
""", ("end-time: 1 s", "end-time: long")),
    solid("no value", """
case.yaml:2:14: simulation.end-time: this key has no value; expected a number in s or with its unit.
""", ("end-time: 1 s", "end-time: ")),
    solid("negative step", """
case.yaml:2:29: simulation.time-step: -0.5 s is out of range; expected a value above 0 s.
""", ("time-step: 0.5 s", "time-step: -0.5 s")),
    solid("step longer than the run", """
case.yaml:2:29: simulation.time-step: the time step must not be longer than the run ('end-time').
""", ("time-step: 0.5 s", "time-step: 2 s")),
    solid("unknown key with a neighbour", """
case.yaml:2:14: simulation.endtime: unknown key. Did you mean 'end-time'?
""", ("end-time", "endtime")),
    solid("unknown key below", """
case.yaml:2:56: simulation.output.each: unknown key. Valid keys: folder, interval, steps, every, compression, box.
""", ("time-step: 0.5 s", "time-step: 0.5 s, output: {each: 1 s}")),
    solid("value instead of a section", """
case.yaml:2:47: simulation.output: expected a mapping (keys with values), found 'all'. Its keys: folder, interval, steps, every, compression, box.
""", ("time-step: 0.5 s", "time-step: 0.5 s, output: all")),
]

OURS = "this name is reserved for a folder or file of the run; choose another"
NO_FOLDER = "the name becomes a folder name: it must not contain '/', '\\', '.' or blanks, nor start with '-'"
PARTICIPANTS = [
    solid("no participants", """
case.yaml:1:1: the `participants` section, which defines what solid_solver runs, is missing.
""", text="simulation: {end-time: 1 s, time-step: 0.5 s}\n"),
    solid("no program", """
case.yaml:4:3: participants.solid: the key 'program' is missing: the program that runs this participant, for example solid_solver.
case.yaml:3:1: participants: no participant is run by the program 'solid_solver': 'solid' (?).
""", ("    program: solid_solver\n", "")),
    solid("misspelt program", """
case.yaml:3:1: participants: no participant is run by the program 'solid_solver': 'solid' (solid_slover).
""", ("program: solid_solver", "program: solid_slover")),
    solid("no such participant", """
--participant sold: case.yaml has no participant with this name. Did you mean 'solid'?
""", arguments=["case.yaml", "--check", "--participant", "sold"]),
    fluid("program of another participant", """
case.yaml:2:1: participants: no participant is run by the program 'fluid_solver': 'solid' (solid_solver).
""", arguments=["case.yaml", "--check"], text="""\
simulation: {end-time: 1 s, time-step: 0.5 s}
participants:
  solid: {program: solid_solver}
"""),
    solid("two participants with this program", """
case.yaml:3:1: participants: 2 participants are run by the program 'solid_solver' (other, solid): select one with --participant.
""", ("  solid:", "  other: {program: solid_solver}\n  solid:")),
    *[solid(f"participant named '{name}'", f"case.yaml:3:1: participants: '{name}': {why}.", ("  solid:", f'  "{name}":'))
      for name, why in (("", "a participant needs a name"), ("coupler", "the coupler is not a participant; its keys are in `coupling`"),
                        ("checkpoints", OURS), ("run", OURS), ("a/b", NO_FOLDER), ("..", NO_FOLDER), ("-o", NO_FOLDER),
                        ("a" * 51, "the name has 51 characters; at most 50 are allowed"))],
    coupler("no coupling", "case.yaml:1:1: the `coupling` section is missing, so the coupler has nothing to do: add the section (docs/config.md), or run each participant alone, without the coupler.", text="simulation: {end-time: 1 s, time-step: 0.5 s}\nparticipants:\n  a: {program: b}\n"),
    coupler("a structure without an interface", """
case.yaml:25:5: participants.solid.boundaries: 'solid' is coupled, but none of its patches is an interface: set `type: interface` where it meets the other participant.
""", ("top: {type: interface}", "top: {type: free}")),
]

SOLID = [
    solid("missing section", """
case.yaml:4:3: participants.solid.material: give either 'material' (of the whole solid) or 'materials' (by zone of the mesh).
""", ("    material:\n      density: 1000 kg/m^3\n      youngs-modulus: 1 MPa\n"
                                      "      poissons-ratio: 0.3\n", "")),
    solid("modulus in kilograms", """
case.yaml:11:7: participants.solid.material.youngs-modulus: '1 kg': the unit 'kg' is not convertible to Pa. Expected Pa or a unit convertible to it.
""", ("1 MPa", "1 kg")),
    solid("misspelt unit", """
case.yaml:11:7: participants.solid.material.youngs-modulus: '1 Mpa': unknown unit 'Mpa'. Did you mean 'MPa'? Expected Pa or a unit convertible to it.
""", ("1 MPa", "1 Mpa")),
    solid("incompressible", """
case.yaml:12:7: participants.solid.material.poissons-ratio: 0.5 is out of range; expected a value from -0.99 to 0.49999.
""", ("poissons-ratio: 0.3", "poissons-ratio: 0.5")),
    solid("misspelt key", """
case.yaml:12:7: participants.solid.material.poisson-ratio: unknown key. Did you mean 'poissons-ratio'?
""", ("poissons-ratio", "poisson-ratio")),
    solid("unit where there is none", """
case.yaml:12:7: participants.solid.material.poissons-ratio: '0.3 m' contains more than a number ('m'); expected a plain number.
""", ("poissons-ratio: 0.3", "poissons-ratio: 0.3 m")),
    solid("unknown word", """
case.yaml:8:5: participants.solid.analysis: 'dynamics' is not one of: dynamic, static, thermal, buckling. Did you mean 'dynamic'?
""", ("analysis: dynamic", "analysis: dynamics")),
    solid("four dimensions", """
case.yaml:7:5: participants.solid.dimension: 4 is out of range; expected a value from 2 to 3.
""", ("dimension: 2", "dimension: 4")),
    solid("half a dimension", "case.yaml:7:5: participants.solid.dimension: '2.5' is not a whole number.", ("dimension: 2", "dimension: 2.5")),
    solid("unknown boundary type", """
case.yaml:15:15: participants.solid.boundaries.right.type: 'tractions' is not one of: fixed-displacement, traction, pressure, force, remote-load, bearing-load, hydrostatic-pressure, symmetry, frictionless, roller, soft-support, hard-support, spring, zero-normal-gradient, free, interface. Did you mean 'traction'?
""", ("type: traction", "type: tractions")),
    solid("boundary without type", """
case.yaml:16:7: participants.solid.boundaries.bottom.type: this required key is missing (one of: fixed-displacement, traction, pressure, force, remote-load, bearing-load, hydrostatic-pressure, symmetry, frictionless, roller, soft-support, hard-support, spring, zero-normal-gradient, free, interface).
""", ("{type: free}\n      top", "{}\n      top")),
    solid("boundary without value", """
case.yaml:14:7: participants.solid.boundaries.left.value: give either 'value' (all components) or 'components' (the prescribed ones of x, y, z).
""", ("value: [0, 0]", "")),
    solid("key of another boundary type", """
case.yaml:16:28: participants.solid.boundaries.bottom.value: this key is not valid here; it requires type: fixed-displacement or type: traction or type: pressure or type: force or type: roller or type: spring.
""", ("bottom: {type: free}", "bottom: {type: free, value: [0, 0]}")),
    solid("boundaries as a list", """
case.yaml:13:5: participants.solid.boundaries: expected a mapping with one entry for each patch, found a list.
""", ("""\
      left: {type: fixed-displacement, value: [0, 0]}
      right: {type: traction, value: [1000, 0]}
      bottom: {type: free}
      top: {type: free}
""", "      [left, right]\n")),
    solid("number instead of a list", """
case.yaml:13:5: participants.solid.gravity: expected a list of numbers in m/s^2 or with their units, found '9.81'.
""", ("    boundaries", "    gravity: 9.81\n    boundaries")),
    solid("probe without a second coordinate", """
case.yaml:13:20: participants.solid.probes.tip.point: expected a list of 2 or 3 numbers in m or with their units, found 1 of them.
""", ("    boundaries", "    probes: {tip: {point: [1]}}\n    boundaries")),
    solid("damping of a static analysis", """
case.yaml:9:5: participants.solid.damping: damping has no effect in a static analysis; remove it.
""", ("analysis: dynamic", "analysis: static\n    damping: {mass: 1}")),
    solid("step control of a static analysis", """
case.yaml:9:5: participants.solid.time-step-control: a static analysis has no time error to control; remove it.
""", ("analysis: dynamic", "analysis: static\n    time-step-control: {tolerance: 1 mm}")),
    solid("probe of an unknown field", """
case.yaml:19:28: participants.solid.probes.tip.fields: unknown field 'stres'; the fields are displacement, velocity, acceleration, stress, equivalent-stress, principal-stress, strain, temperature.
""", ("      top: {type: free}", "      top: {type: free}\n    probes:\n      tip: {point: [1, 1], fields: [stres]}")),
    solid("time scheme of a static analysis", """
case.yaml:9:5: participants.solid.time-scheme: a static analysis has no inertia to integrate in time; remove it.
""", ("analysis: dynamic", "analysis: static\n    time-scheme: {type: bathe}")),
    solid("volume strain of another gradient", """
case.yaml:9:49: participants.solid.solution-method.volume-strain: it requires 'face-gradient: symmetric' with 'type: newton-krylov'; change these, or remove it.
""", ("analysis: dynamic", "analysis: dynamic\n    solution-method: {face-gradient: corrected, volume-strain: cells}")),
    solid("initial velocity of a static analysis", """
case.yaml:9:5: participants.solid.initial-velocity: it requires 'analysis: dynamic'; remove it.
""", ("analysis: dynamic", "analysis: static\n    initial-velocity: [1, 0]")),
    solid("data of an interface that is not there", """
case.yaml:9:5: participants.solid.interface: no patch is an interface: set 'type: interface' for one, or remove this section.
""", ("analysis: dynamic", "analysis: dynamic\n    interface: {load: pressure}")),
    solid("unknown time scheme", """
case.yaml:9:19: participants.solid.time-scheme.type: 'bath' is not one of: auto, euler, three-point, trapezoidal, bathe, generalised-alpha. Did you mean 'bathe'?
""", ("analysis: dynamic", "analysis: dynamic\n    time-scheme: {type: bath}")),
    solid("known components and all of them", """
case.yaml:14:40: participants.solid.boundaries.left.value: give either 'value' (all components) or 'components' (the prescribed ones of x, y, z).
""",
          ("{type: fixed-displacement, value: [0, 0]}", "{type: fixed-displacement, value: [0, 0], components: {x: 0}}")),
    solid("third component of a plane scene", """
case.yaml:14:7: participants.solid.boundaries.left.value: a 2-dimensional scene has no component z.
""",
          ("{type: fixed-displacement, value: [0, 0]}", "{type: fixed-displacement, components: {z: 0}}")),
    solid("part without its faces", """
case.yaml:16:36: participants.solid.boundaries.bottom.parts[0].where: this required key is missing (expression of x, y, z at the face centres, nonzero on the faces of this part: number or expression).
""", ("bottom: {type: free}", "bottom: {type: free, parts: [{type: symmetry}]}")),
    solid("part with an unknown name", """
case.yaml:16:37: participants.solid.boundaries.bottom.parts[0].where: cannot parse the expression 'abs(r) < 1' at column 5: unknown name 'r'. Known are the variables x, y, z [m] and t [s], the constant pi, the operators + - * / ^ < > == && || ?: and functions such as sin, cos, exp, sqrt, abs, min, max.
""",
          ("bottom: {type: free}", "bottom: {type: free, parts: [{where: abs(r) < 1, type: symmetry}]}")),
    solid("interface on a part", """
case.yaml:16:51: participants.solid.boundaries.bottom.parts[0].type: 'interface' is not one of: fixed-displacement, traction, pressure, force, remote-load, bearing-load, hydrostatic-pressure, symmetry, frictionless, roller, soft-support, hard-support, spring, zero-normal-gradient, free.
""",
          ("bottom: {type: free}", "bottom: {type: free, parts: [{where: x < 1, type: interface}]}")),
    solid("spring without stiffness", """
case.yaml:16:7: participants.solid.boundaries.bottom.stiffness: this required key is missing (force per area and displacement, of x, y, z (Winkler foundation): number or expression in N/m^3).
""", ("bottom: {type: free}", "bottom: {type: spring}")),
    solid("several mistakes at once", """
case.yaml:2:14: simulation.end-time: 0 s is out of range; expected a value above 0 s.
case.yaml:6:5: participants.solid.mash: unknown key. Did you mean 'mesh'?
case.yaml:11:7: participants.solid.material.youngs-modulus: 'soft' is not a number; expected a number in Pa or with its unit.
""", ("1 MPa", "soft"), ("end-time: 1 s", "end-time: 0"), ("    mesh", "    mash")),
]

HEAT = [
    solid("thermal strain without a temperature", """
case.yaml:13:5: participants.solid.thermal-expansion: thermal strain needs a temperature; add 'heat' or 'temperature'.
""", ("    boundaries:\n", "    thermal-expansion: {reference-temperature: 20 degC}\n    boundaries:\n")),
    solid("heat without conductivity", """
case.yaml:9:5: participants.solid.material: 'conductivity' of the material is missing; 'heat' needs it.
""", ("    boundaries:\n", "    heat: {initial-temperature: 20 degC}\n    boundaries:\n")),
    solid("heat and a prescribed temperature", """
case.yaml:14:5: participants.solid.temperature: 'heat' computes the temperature; remove one of the two.
""", ("    boundaries:\n", "    temperature: 300 + x\n    heat: {analysis: steady}\n    boundaries:\n"),
          ("poissons-ratio: 0.3", "poissons-ratio: 0.3\n      conductivity: 50")),
    solid("thermal analysis without heat", """
case.yaml:8:5: participants.solid.analysis: a thermal analysis needs 'heat'.
""", ("analysis: dynamic", "analysis: thermal")),
    solid("property that is an expression", """
case.yaml:13:7: participants.solid.material.conductivity: '50 - 0.1*T' is neither a number nor a table of the temperature, such as {of: T, at: [300 K, 600 K], values: [210 GPa, 180 GPa]}.
""", ("poissons-ratio: 0.3", "poissons-ratio: 0.3\n      conductivity: 50 - 0.1*T")),
    solid("table with a value too few", """
case.yaml:15:31: participants.solid.boundaries.right.value: entry 1 of the list: a table needs one value per point; 2 points and 1 values are given.
""", ("value: [1000, 0]", "value: [{of: t, at: [0, 1], values: [1000]}, 0]")),
    solid("places of a table that do not grow", """
case.yaml:15:31: participants.solid.boundaries.right.value: entry 1 of the list: the points of a table must increase, but 2 is followed by 1.
""", ("value: [1000, 0]", "value: [{of: t, at: [0, 2, 1], values: [0, 1, 2]}, 0]")),
]

COUPLING = [
    coupler("role of nobody", """
case.yaml:38:15: coupling.structure.participant: there is no participant 'solids'. Did you mean 'solid'?
case.yaml:16:3: participants.solid: this participant has no role in `coupling` (fluid, structure, mesh or exchange): assign one, or remove the participant.
""", ("structure: {participant: solid}", "structure: {participant: solids}")),
    coupler("role missing", """
case.yaml:16:3: participants.solid: this participant has no role in `coupling` (fluid, structure, mesh or exchange): assign one, or remove the participant.
""", ("  structure: {participant: solid}\n", "")),
    coupler("a body that the mover does not move", """
case.yaml:34:13: participants.mover.boundaries.top.type: the wall 'top' is a body in 'fluid', which the mesh mover must move: set `type: moving` with its `motion`.
""", ("top: {type: slip}", "top: {type: body}")),
    coupler("a wall at rest that the mover moves", """
case.yaml:15:13: participants.fluid.boundaries.top.type: the wall 'top' is moved by 'mover', but in 'fluid' it is at rest: set `type: body`.
""", ("top: {type: slip}", "top: {type: no-slip}"), ("top: {type: fixed}\ncoupling", "top: {type: moving, motion: {translation: [0, t]}}\ncoupling")),
    coupler("two roles missing", """
case.yaml:16:3: participants.solid: this participant has no role in `coupling` (fluid, structure, mesh or exchange): assign one, or remove the participant.
case.yaml:26:3: participants.mover: this participant has no role in `coupling` (fluid, structure, mesh or exchange): assign one, or remove the participant.
case.yaml:35:1: coupling.structure: 'structure' is missing; a coupling has 'fluid' and 'structure' (each with its participant), 'fluid' and 'mesh' (whose bodies move as the case prescribes), or 'exchange'.
""", ("  structure: {participant: solid}\n", ""), ("  mesh: {participant: mover}\n", "")),
    coupler("participant without a role", """
case.yaml:26:3: participants.mover: this participant has no role in `coupling` (fluid, structure, mesh or exchange): assign one, or remove the participant.
""", ("  mesh: {participant: mover}\n", "")),
    coupler("one participant in two roles", """
case.yaml:38:15: coupling.structure.participant: 'fluid' is run by fluid_solver, which cannot be the structure: the role 'structure' takes a load [N or Pa] at faces or vertices and gives 'displacement' [m] at vertices and 'velocity' [m/s] at vertices; it takes no load [N or Pa] at faces or vertices (it takes 'displacement' [m] at vertices, 'velocity' [m/s] at vertices and gives 'pressure-force' [N] at faces, 'viscous-force' [N] at faces). In this case 'solid' (solid_solver) can.
case.yaml:16:3: participants.solid: this participant has no role in `coupling` (fluid, structure, mesh or exchange): assign one, or remove the participant.
case.yaml:38:3: coupling.structure: fluid and structure must be two different participants.
""", ("structure: {participant: solid}", "structure: {participant: fluid}")),
    coupler("half the names of another program's fluid", """
case.yaml:37:31: coupling.fluid.load: 'displacement' and 'load' are given together: the names of another program's data.
""", ("fluid: {participant: fluid}", "fluid: {participant: fluid, load: Force}")),
    coupler("exchange beside a fluid", """
case.yaml:40:3: coupling.exchange: an exchange has no separate structure: it is one of its participants; use one or the other.
""", ("  mesh: {participant: mover}\n", "  mesh: {participant: mover}\n  exchange: {participants: [fluid, solid]}\n")),
    coupler("exchange with a stranger", """
case.yaml:37:14: coupling.exchange.participants: there is no participant 'slid'. Did you mean 'solid'?
case.yaml:37:14: coupling.exchange.participants: 'mover' is run by mesh_mover, which cannot be part of an exchange: it serves one fluid and gives the coupler no data; name it as `mesh` and its fluid as `fluid`.
case.yaml:16:3: participants.solid: this participant has no role in `coupling` (fluid, structure, mesh or exchange): assign one, or remove the participant.
""", ("  scheme: implicit\n  fluid: {participant: fluid}\n  structure: {participant: solid}\n  mesh: {participant: mover}\n", "  scheme: explicit\n  exchange: {participants: [fluid, slid, mover]}\n")),
    coupler("exchange with a fluid whose mesh nobody moves", """
case.yaml:38:14: coupling.exchange.participants: 'mover' is run by mesh_mover, which cannot be part of an exchange: it serves one fluid and gives the coupler no data; name it as `mesh` and its fluid as `fluid`.
case.yaml:38:3: coupling.exchange: with an exchange give either both `fluid` and `mesh` (whose mesh is moved, and by which participant) or neither.
""", ("  structure: {participant: solid}\n  mesh: {participant: mover}\n", "  exchange: {participants: [fluid, solid, mover]}\n")),
    coupler("sub-steps of nobody", "\ncase.yaml:40:3: coupling.sub-steps: there is no participant 'slid' that supports sub-steps.\n", (
        "  mesh: {participant: mover}\n", "  mesh: {participant: mover}\n  sub-steps: {slid: 2}\n")),
    coupler("sub-steps of a structure", "\ncase.yaml:40:15: coupling.sub-steps.solid: solid_solver supports no sub-steps beside fluid_solver: the fluid's added mass acts on "
        "its change of velocity over the whole step; use a smaller `simulation.time-step`.\n", (
            "  mesh: {participant: mover}\n", "  mesh: {participant: mover}\n  sub-steps: {solid: 4}\n")),
    coupler("unknown scheme", """
case.yaml:36:3: coupling.scheme: 'semiimplicit' is not one of: auto, explicit, semi-implicit, implicit. Did you mean 'semi-implicit'?
""", ("scheme: implicit", "scheme: semiimplicit")),
    coupler("unknown acceleration", """
case.yaml:40:18: coupling.acceleration.type: 'anderson' is not one of: constant, aitken, iqn-ils, iqn-mvj.
""", ("type: aitken", "type: anderson")),
    coupler("relaxation out of range", """
case.yaml:40:32: coupling.acceleration.initial-relaxation: 0 is out of range; expected a value from 1e-06 to 2.
""", ("initial-relaxation: 0.5", "initial-relaxation: 0")),
    coupler("tolerance in percent too large", """
case.yaml:41:17: coupling.convergence.relative: 2 is out of range; expected a value from 1e-14 to 1.
""", ("relative: 1e-5", "relative: 200 %")),
    coupler("unknown key of convergence", """
case.yaml:41:17: coupling.convergence.relativ: unknown key. Did you mean 'relative'?
""", ("relative: 1e-5", "relativ: 1e-5")),
    coupler("half an order of the predictor", """
case.yaml:41:15: coupling.predictor.order: it must be 0, 1 or 2.
""", ("  convergence", "  predictor: {order: 1.5}\n  convergence")),
    coupler("order of the predictor", """
case.yaml:41:15: coupling.predictor.order: 3 is out of range; expected a value from 0 to 2.
""", ("  convergence", "  predictor: {order: 3}\n  convergence")),
    coupler("participant for the coupler", """
The coupler takes no --participant: it couples the participants named in case.yaml.
""", arguments=["case.yaml", "--check", "--participant", "fluid"]),
    mover("unknown motion", """
case.yaml:32:15: participants.mover.boundaries.right.type: 'loose' is not one of: interface, moving, fixed, slip, free, periodic.
""", ("right: {type: fixed}", "right: {type: loose}")),
    mover("motion missing", "case.yaml:32:7: participants.mover.boundaries.right.type: this required key is missing (one of: "
          "interface, moving, fixed, slip, free, periodic).", ("right: {type: fixed}", "right: {}")),
    mover("a moving patch without a motion", "case.yaml:34:7: participants.mover.boundaries.top.motion: nothing moves without a 'translation', an 'angle' or a "
          "'displacement'.", ("top: {type: fixed}", "top: {type: moving}")),
    mover("a barrier across periodic patches", "case.yaml:27:5: participants.mover.method: barrier is not available with periodic patches: use pseudo-solid, or type: slip for both patches.", ("  mover:\n", "  mover:\n    method: barrier\n"), ("right: {type: fixed}", "right: {type: periodic, partner: left}"), ("left: {type: fixed}", "left: {type: periodic, partner: right}")),
    mover("limit of the guard out of range", """
case.yaml:27:13: participants.mover.guard.largest-angle: 100 is out of range; expected a value from 0 to 90.
""", ("  mover:\n", "  mover:\n    guard: {largest-angle: 100}\n")),
    mover("current volumes in the total form", "case.yaml:27:5: participants.mover.stiffening-volumes: 'stiffening-volumes: current' requires 'form: incremental'.",
          ("  mover:\n", "  mover:\n    stiffening-volumes: current\n")),
    mover("stiffening out of range", """
case.yaml:27:5: participants.mover.stiffening: 5 is out of range; expected a value from 0 to 3.
""", ("  mover:\n", "  mover:\n    stiffening: 5\n")),
]

COMMAND_LINE = [
    solid("set without a value", """
--set simulation.end-time: expected key=value, for example --set simulation.end-time='2 s'.
""", **with_set("simulation.end-time")),
    solid("set below a section that is not there", """
--set participants.sold.dimension=3: 'sold' does not exist in 'participants'. Did you mean 'solid'? (A missing mapping can be set as a whole: --set 'participants.sold={key: value}'.)
""", **with_set("participants.sold.dimension=3")),
    solid("set below a value", """
--set simulation.end-time.s=3: 'simulation.end-time' is a single value, so 's' cannot be set below it.
""", **with_set("simulation.end-time.s=3")),
    solid("set to a wrong value", """
--set simulation.end-time=2 kg: simulation.end-time: '2 kg': the unit 'kg' is not convertible to s. Expected s or a unit convertible to it.
""", **with_set("simulation.end-time=2 kg")),
    solid("set of a misspelt key", """
--set simulation.endtime=2 s: simulation.endtime: unknown key. Did you mean 'end-time'?
""", **with_set("simulation.endtime=2 s")),
    solid("set to broken YAML", """
--set simulation={end-time: 1 s: the value is not valid YAML: a mapping opened with '{' before this position is not closed by '}'.
""", **with_set("simulation={end-time: 1 s")),
    solid("no case", """
Give the YAML file of the case, for example: solid_solver case.yaml
Run with --help for more information.
""", arguments=["--check"]),
    solid("unknown option", """
Unknown option or argument '--chekc'. Did you mean '--check'?
Run with --help for more information.
""", arguments=["case.yaml", "--chekc"]),
]

# The point in the middle moved beyond the right side.
FOLDED = (pathlib.Path(__file__).parent / "square.msh").read_text(encoding="utf-8").replace("5 0.5 0.5 0", "5 1.4 0.5 0")

MESH = [
    solid("mesh file that is not there", """
[solid 0] error: The mesh file 'squares.msh' does not exist. The path is relative to the folder of the YAML file.
""", ("square.msh", "squares.msh"), **RUN),
    solid("mesh of an unknown kind", """
[solid 0] error: The mesh file 'case.yaml' is not a .msh, .geo, .inp, .unv, .med, .exo or .cgns file. Convert it with gmsh or meshio to .msh 4.1 with physical names.
""", ("square.msh", "case.yaml"), **RUN),
    solid("mesh that is not one", """
[solid 0] error: text.msh:1: Expected a section such as $Nodes here, found 'hello'.
""", ("square.msh", "text.msh"), files={"text.msh": "hello\n"}, **RUN),
    solid("unknown patch", """
[solid 0] error: boundaries.rigth: mesh 'square.msh' has no patch with this name. Did you mean 'right'? The patches are left, right, bottom, top.
""", ("right: {type", "rigth: {type"), **RUN),
    solid("patch without a boundary", """
[solid 0] error: boundaries: patch 'top' of mesh 'square.msh' has no entry; each patch needs one (a stress-free patch: 'type: free'). The patches are left, right, bottom, top.
""", ("      top: {type: free}\n", ""), **RUN),
    solid("part that selects no face", """
[solid 0] error: boundaries.bottom.parts[0].where: 'y > 2' selects no face of patch 'bottom'. It is evaluated at the face centres; widen it, for example to abs(z - 0.5) < half the height of a face.
""", ("bottom: {type: free}", "bottom: {type: free, parts: [{where: y > 2, type: symmetry}]}"), **RUN),
    solid("spring that depends on time", """
[solid 0] error: boundaries.bottom.stiffness: the stiffness of a spring cannot depend on the time t.
""", ("bottom: {type: free}", "bottom: {type: spring, stiffness: 1e9*t}"), **RUN),
    solid("static body that floats", """
couplet: The job cannot start:
  [solid] case.yaml:13:5: participants.solid.boundaries: no patch supports the solid in this static analysis: at least one must be fixed, supported, sprung or a plane of symmetry.
""", ("analysis: dynamic", "analysis: static"), ("{type: fixed-displacement, value: [0, 0]}", "{type: free}"), **RUN),
    solid("static body on one roller", """
[solid 0] error: boundaries: the supports of this static analysis leave rigid motions free: translation along y. Prevent them by 'fixed-displacement' (all or some components), 'symmetry', a 'spring' or another support, or use 'analysis: dynamic'.
""", ("analysis: dynamic", "analysis: static"), ("{type: fixed-displacement, value: [0, 0]}", "{type: symmetry}"), **RUN),
    solid("zone that is not there", """
[solid 0] error: Cannot use the mesh 'square.msh'. It has no zone 'insid' for a material. Did you mean 'inside'? The zones (physical surfaces of gmsh) are inside.
""", ("    material:\n      density", "    materials: {steel: {zones: [insid], density"),
          (" kg/m^3\n      youngs-modulus: 1 MPa\n      poissons-ratio: 0.3\n", ", youngs-modulus: 1e6, poissons-ratio: 0.3}}\n"), **RUN),
    solid("folded mesh", """
[solid 0] error: Cannot use the mesh 'folded.msh'. The mesh has a self-intersecting cell: cell 1 at (0.975, 0.25) m. Its points are in the wrong order; remesh there.
""", ("square.msh", "folded.msh"), files={"folded.msh": FOLDED}, **RUN),
    solid("plane mesh in three dimensions", """
couplet: The job cannot start:
  [solid] case.yaml:14:40: participants.solid.boundaries.left.value: 2 components are given, but the 3-dimensional scene needs 3.
  [solid] case.yaml:15:31: participants.solid.boundaries.right.value: 2 components are given, but the 3-dimensional scene needs 3.
""", ("dimension: 2", "dimension: 3"), **RUN),
    solid("components of a vector", """
couplet: The job cannot start:
  [solid] case.yaml:15:31: participants.solid.boundaries.right.value: 3 components are given, but the 2-dimensional scene needs 2.
""", ("value: [1000, 0]", "value: [1000, 0, 0]"), **RUN),
    solid("expression that cannot be read", """
couplet: The job cannot start:
  [solid] case.yaml:15:31: participants.solid.boundaries.right.value: entry 1 of the list: cannot parse the expression '1000*sin(t' at column 11: a ')' is missing. Known are the variables x, y, z [m] and t [s], the constant pi, the operators + - * / ^ < > == && || ?: and functions such as sin, cos, exp, sqrt, abs, min, max.
""", ("value: [1000, 0]", "value: [1000*sin(t, 0]"), **RUN),
    solid("expression with an unknown name", """
couplet: The job cannot start:
  [solid] case.yaml:15:31: participants.solid.boundaries.right.value: entry 1 of the list: cannot parse the expression '1000*time' at column 6: unknown name 'time'. Known are the variables x, y, z [m] and t [s], the constant pi, the operators + - * / ^ < > == && || ?: and functions such as sin, cos, exp, sqrt, abs, min, max.
""", ("value: [1000, 0]", "value: [1000*time, 0]"), **RUN),
    fluid("unknown patch of a fluid", """
[fluid 0] error: boundaries.rigth: the mesh 'square.msh' has no patch 'rigth'. Did you mean 'right'?
""", ("right: {type", "rigth: {type"), **RUN),
    fluid("patch of a fluid without a boundary", """
[fluid 0] error: boundaries: the mesh 'square.msh' has patches without a boundary condition: top. Give each of them a type (inlet, outlet, convective-outlet, no-slip, moving-wall, partial-slip, slip, symmetry, periodic, interface or body).
""", ("      top: {type: slip}\n", ""), **RUN),
    mover("mover without its coupled job", """
couplet: The job cannot start:
  participant 'coupler' (coupler) is missing: it was not started.
  participant 'fluid' (fluid_solver) is missing: it was not started.
  participant 'solid' (solid_solver) is missing: it was not started.
  To run 'mover' alone: mesh_mover case.yaml --participant mover
  Start it with: mpirun -n 1 coupler case.yaml : -n 1 fluid_solver case.yaml : -n 1 solid_solver case.yaml : -n 1 mesh_mover case.yaml
""", **RUN),
    solid("checkpoint that is not there", """
[solid 0] error: --restart old: no complete checkpoint found. Give a checkpoint folder of an earlier run, such as out/checkpoints/step-00000100, or its parent folder for the latest one.
""", arguments=["case.yaml", "--restart", "old"]),
]

RIGHT_TANK, TANK = tank_table.cases(Case, RUN)
FLUID = flow_table.cases(fluid, RUN)
RIGHT_PLANT, PLANT = plant_table.cases(Case, RUN)
RIGHT_PLATE, PLATE = plate_table.cases(Case, RUN)
RIGHT_CHECK, CHECK = check_table.cases(Case)
RIGHT += RIGHT_TANK + RIGHT_PLANT + RIGHT_PLATE + RIGHT_CHECK
CASES = RIGHT + FILE + SIMULATION + PARTICIPANTS + SOLID + material_table.cases(solid) + HEAT + FLUID + COUPLING + COMMAND_LINE + MESH + CHECK + TANK + PLANT + PLATE
