# SPDX-License-Identifier: Apache-2.0
"""Expressions, headings, values and parts that would be taken in another way than they are meant, or do nothing at all."""
PULL, LEFT, RIGHT, MATERIAL = "value: [1 MPa, 0]", "left: {type: inlet, velocity: [0.1 m/s, 0 m/s]}", "right: {type: outlet, pressure: 0}", "poissons-ratio: 0.3\n"
HOT, COLD = "left: {type: temperature, value: 100 degC}", "right: {type: temperature, value: 30 degC}"
PLANT = """      type: plant
      electric-power: 50 MW
      block-efficiency: 0.38
      field-area: 510120 m^2
      field-efficiency: 0.70
      hot: 390 degC
      cold: 290 degC
"""
POINT, ASSIGNS, IN_A_ROW = "write a decimal point", "'=' does not compare", "comparisons in a row"


def part(where):
    return [("right: {type: traction, value: [1 MPa, 0]}", f'right: {{type: free, parts: [{{where: "{where}", type: traction, value: [1 MPa, 0]}}]}}')]


def pulled_by(heading, of="t", column=2):
    """A traction from a table with these headings."""
    return [(PULL, f"value: [{{of: {of}, file: p.csv, column: {column}}}, 0]")], {"run": True, "files": {"p.csv": heading + "\n0,145\n2,145\n"}}


def refused_table(name, heading, message, of="t"):
    edits, more = pulled_by(heading, of)
    return (name, "solid", edits, "refused", {"message": message, **more})


def schedule(rows):
    return [(PLANT, "      type: schedule\n      file: f.csv\n")], {"run": True, "files": {"f.csv": "time [h],mass-flow [kg/s],inlet-temperature [degC]\n" + rows}}


def tank(name, rows, outcome, message):
    edits, more = schedule(rows)
    return (name, "tank", edits, outcome, {"message": message, **more})


def fluid(name, edits, outcome, message, **more):
    return (name, "fluid", edits, outcome, {"message": message, **more})


def solid(name, edits, outcome, message, **more):
    return (name, "solid", edits, outcome, {"message": message, **more})


def heat(name, edits, outcome, message, **more):
    return (name, "heat", edits, outcome, {"message": message, **more})


EXPRESSIONS = [
    fluid("decimal comma in an expression", [("velocity: [0.1 m/s, 0 m/s]", 'velocity: ["1,5*4*y*(1 - y)", 0]')], "refused", POINT),
    solid("commas between thousands", [(PULL, 'value: ["1,000,000", 0]')], "refused", POINT),
    heat("decimal comma in a source", [("      boundaries: {left", '      source: "t < 1 ? 0 : 1,5*x"\n      boundaries: {left')], "refused", POINT),
    fluid("decimal comma in a motion", [("    boundaries:", '    motion: {translation: ["0,1*t", 0]}\n    boundaries:')], "refused", POINT),
    solid("assignment in a selection", part("y = 0.75"), "refused", ASSIGNS, run=True),
    fluid("assignment in a velocity", [("velocity: [0.1 m/s, 0 m/s]", 'velocity: ["t = 0 ? 1 : 2", 0]')], "refused", ASSIGNS),
    ("assignment in a load of a plate", "plate", [("    modes:", '    load: {upper-pressure: "t = 0"}\n    modes:')], "refused", {"message": ASSIGNS}),
    solid("comparisons in a row", part("0.5 < y < 1"), "refused", IN_A_ROW, run=True),
    fluid("comparisons in a row in a level", [("    boundaries:", '    bodies: {b: {level: "0.1 < x < 0.2 ? -1 : 1"}}\n    boundaries:')], "refused", IN_A_ROW),
    heat("comparisons in a row in a temperature", [("value: 100 degC", 'value: "0 <= y <= 0.5 ? 300 : 400"')], "refused", IN_A_ROW),
    solid("comparisons joined", part("0.5 < y && y < 1"), "right", "both hold", run=True),
]
UNITS = [
    *(refused_table(f"heading [{unit}]", f"t [s],p [{unit}]", f"the values are in '{unit}', but a table's values are taken in Pa") for unit in ("psi", "mmHg", "Mpa", "Bar", "kPa", "m")),
    *(refused_table(f"heading [{unit}] of the time", f"t [{unit}],p [Pa]", f"the first column is in '{unit}', but 't' is in s") for unit in ("msec", "sec", "hours", "ms")),
    refused_table("unit of a radius", "r [mm],p [Pa]", "the first column is in 'mm'", "r"),
    refused_table("unknown unit in round brackets", "t,p (psi)", "has its unit in round brackets"),
    ("heading in the unit of the key", "solid", pulled_by("t [s],p [N/m^2]")[0], "right", {"message": "N/m^2 is Pa", **pulled_by("t [s],p [N/m^2]")[1]}),
    tank("unknown unit of a schedule", "", "refused", "unknown unit 'sec'")[:4] + ({"message": "column 'time': unknown unit 'sec'", "run": True, "files": {
        "f.csv": "time [sec],mass-flow [kg/s],inlet-temperature [degC]\n0,-100,390\n"}},),
    *(fluid(f"speed of rotation: {text}", [("top: {type: slip}", f"top: {{type: moving-wall, rotation: {{speed: {text}}}}}")], "refused", "a turn is 6.2832 rad or 360 deg")
      for text in ("60 1/min", "1 1/s", "1 Hz", "50 %")),
    ("radians for a rate", "solid", [("analysis: static", "analysis: dynamic"), ("    probes:", "    damping: {mass: 2 rad/s}\n    probes:")], "refused", {"message": "the unit 'rad/s' is not convertible to 1/s"}),
]
VALUES = [
    heat("Celsius in an expression", [("value: 100 degC", 'value: "20 + 80*y"')], "flagged", "yields 20 K (usual: 70 to 5000 K): implausible", run=True),
    heat("Celsius in an expression for the surroundings", [(HOT, 'left: {type: convection, coefficient: 10, ambient: "20 + 10*y"}')], "flagged", "(usual: 70 to 5000 K): implausible", run=True),
    heat("Celsius in an initial temperature", [("initial-temperature: 20 degC", 'initial-temperature: "20 + x"')], "flagged", "(usual: 70 to 5000 K): implausible", run=True),
    heat("kelvin in an expression", [("value: 100 degC", 'value: "300 + 80*y"')], "right", "it is in K", run=True),
    heat("below absolute zero in an expression", [("value: 100 degC", 'value: "-50 + 0*x"')], "refused", "it must be at least 0 K", run=True),
    heat("more heat drawn than there is", [(HOT, "left: {type: flux, value: -1e6 W/m^2}")], "flagged", "below absolute zero", run=True, code=4),
    heat("negative film", [(HOT, "left: {type: convection, coefficient: -10, ambient: 20 degC}")], "refused", "coefficient: -10 W/(m^2 K) is out of range; expected a value at least 0 W/(m^2 K)."),
    heat("negative film in an expression", [(HOT, 'left: {type: convection, coefficient: "10 - t", ambient: 20 degC}')], "refused", "it must be at least 0 W/(m^2 K)", run=True, code=1),
    heat("negative film in a table", [(HOT, "left: {type: convection, coefficient: {of: y, at: [0, 1], values: [-1, 10]}, ambient: 20 degC}")], "refused", "-1 W/(m^2 K) is out of range"),
    *(heat(f"only a film of {text}", [(HOT, f'left: {{type: convection, coefficient: "{text}", ambient: 20 degC}}'), (COLD, "right: {type: flux, value: 1000 W/m^2}")],
           "refused", "a steady temperature is undetermined without a level", run=True, code=1) for text in ("0", "t < 5 ? 0 : 0")),
    solid("Poisson's ratio of a table", [(MATERIAL, MATERIAL + "      poissons-ratio-table: {of: T, at: [20 degC, 1000 degC], values: [0.3, 0.7]}\n"), ("    probes:", "    temperature: 900 degC\n    probes:")],
          "refused", "0.7 is out of range; expected a value from -0.99 to 0.49999"),
    solid("a modulus of a table that falls below 0", [(MATERIAL, MATERIAL + "      youngs-modulus-table: {of: T, at: [20 degC, 1000 degC], values: [210 GPa, -1 GPa]}\n"), ("    probes:", "    temperature: 900 degC\n    probes:")],
          "refused", "-1000000000 Pa is out of range; expected a value above 0 Pa"),
]
ACTS = [
    fluid("a profile over another axis", [("velocity: [0.1 m/s, 0 m/s]", 'velocity: ["6*x*(1 - x)", 0]')], "flagged", "boundaries.left.velocity[0]: '6*x*(1 - x)' never acted", run=True, code=4),
    fluid("an inlet along itself", [("velocity: [0.1 m/s, 0 m/s]", "velocity: [0, 0.1 m/s]")], "flagged", "boundaries.left: the inlet, through which fluid enters, never acted", run=True),
    fluid("a periodic channel without a force", [(LEFT, "left: {type: periodic, partner: right}"), (RIGHT, "right: {type: periodic, partner: left}")], "flagged", "the run is at rest", run=True),
    fluid("a body elsewhere", [("    boundaries:", '    bodies: {b: {level: "sqrt((x - 50)^2 + y^2) - 0.02"}}\n    boundaries:')], "flagged", "bodies.b: the body, which closes cells or parts of them, never acted", run=True),
    fluid("a wall between cells", [("    boundaries:", '    bodies: {b: {level: "abs(x - 0.51) - 0.001"}}\n    boundaries:')], "flagged", "bodies.b: the body, which closes cells or parts of them, never acted", run=True),
    fluid("a motion far away", [("    boundaries:", '    motion: {translation: ["0.01*t", 0], centre: [50, 5], inner-radius: 0.01, outer-radius: 0.02}\n    boundaries:')], "flagged", "motion: the motion, which moves points, never acted", run=True),
    fluid("a body force that never begins", [("    boundaries:", '    body-force: ["t > 60 ? 1 : 0", 0]\n    boundaries:')], "flagged", "never acted", run=True),
    solid("a load between face centers", [(PULL, 'value: ["abs(y - 0.5) < 0.1 ? 1e6 : 0", 0]')], "right", "it is integrated over the faces", run=True),
    solid("a load beside its patch", [(PULL, 'value: ["abs(y - 5) < 0.1 ? 1e6 : 0", 0]')], "flagged", "never acted", run=True),
    solid("water below the wall", [("right: {type: traction, value: [1 MPa, 0]}", "right: {type: hydrostatic-pressure, density: 1000 kg/m^3, gravity: [0, -9.81], level: -5 m}")],
          "flagged", "boundaries.right: the hydrostatic pressure never acted", run=True),
    heat("a flux between face centers", [(HOT, 'left: {type: flux, value: "abs(y - 0.5) < 0.1 ? 1e4 : 0"}')], "right", "it is integrated over the faces", run=True),
    heat("a flux beside its patch", [(HOT, 'left: {type: flux, value: "abs(y - 5) < 0.1 ? 1e7 : 0"}')], "flagged", "heat.boundaries.left.value: 'abs(y - 5) < 0.1 ? 1e7 : 0' never acted", run=True),
    heat("a source that never begins", [("      boundaries: {left", '      source: "t > 3600 ? 1e3 : 0"\n      boundaries: {left')], "flagged", "heat.source: 't > 3600 ? 1e3 : 0' never acted", run=True),
    ("gravity along a plate", "plate", [("    initial-amplitudes: [1 mm]\n", "    gravity: [0, -9.81, 0]\n")], "flagged", {"message": "motion in the plane neglected", "run": True}),
]
TIMES = [
    fluid("an inlet whose period is the step", [("velocity: [0.1 m/s, 0 m/s]", 'velocity: ["1 + sin(2*pi*2*t)", 0]'), ("end-time: 1 s", "end-time: 2 s")], "flagged", "the steps do not see it", run=True),
    fluid("a pulse between two steps", [("velocity: [0.1 m/s, 0 m/s]", 'velocity: ["1 + (t > 0.61 && t < 0.62 ? 50 : 0)", 0]')], "flagged", "the steps do not see it", run=True),
    solid("a static load whose period is the step", [(PULL, 'value: ["1e6*(1 + 5*sin(2*pi*t))", 0]'), ("end-time: 1 s", "end-time: 2 s")], "flagged", "the steps do not see it", run=True),
    solid("a load that the steps see", [(PULL, 'value: ["t < 1.2 ? 1e6*t : 1.2e6", 0]'), ("end-time: 1 s", "end-time: 3 s")], "right", "it grows and stays", run=True),
    solid("a table that starts after the end", [(PULL, "value: [{of: t, at: [2 s, 3 s], values: [0, 1 MPa]}, 0]")], "flagged", "it covers 2 to 3, but was only read from 1 to 1", run=True),
    solid("a table that was over before the start", [(PULL, "value: [{of: t, at: [0, 0.5 s], values: [0, 1 MPa]}, 0]")], "flagged", "it covers 0 to 0.5, but was only read from 1 to 1", run=True),
    solid("a material beyond its table", [(MATERIAL, MATERIAL + "      youngs-modulus-table: {of: T, at: [20 degC, 100 degC], values: [210 GPa, 200 GPa]}\n"), ("    probes:", "    temperature: 900 degC\n    probes:")],
          "flagged", "its table covers 293.15 to 373.15 K, but was read from 1173.15 to 1173.15 K", run=True),
    tank("a schedule in seconds as hours", "0,-100,390\n1800,0,390\n", "flagged", "flow.rows[1] starts at 6.48e+06 s, after the end of the run; of 2 rows 1 ran"),
    tank("a schedule that ends early", "0,-100,390\n0.01,-100,390\n", "flagged", "the last row, flow.rows[1], starts at 36 s and its flow went on"),
]
NAMES = [
    fluid("walls twice", [("    boundaries:", "    output: {coefficients: {c: {patches: [bottom, bottom], speed: 1 m/s, area: 0.1 m^2}}}\n    boundaries:")], "refused", "'bottom' is listed twice"),
    fluid("surfaces twice", [("    boundaries:", "    output: {surfaces: [bottom, bottom]}\n    boundaries:")], "refused", "'bottom' is listed twice"),
    solid("fields of a probe twice", [("{point: [1, 1]}", "{point: [1, 1], fields: [displacement, displacement]}")], "refused", "'displacement' is listed twice"),
    ("participants twice", "coupled", [("  fluid: {participant: fluid}\n  structure: {participant: solid}\n  mesh: {participant: mover}\n", "  exchange: {participants: [fluid, fluid]}\n")], "refused", {"message": "listed twice"}),
    fluid("lift along drag", [("    boundaries:", "    output: {coefficients: {c: {patches: [bottom], speed: 1 m/s, area: 0.1 m^2, drag: [1, 0], lift: [-2, 0]}}}\n    boundaries:")], "refused", "it is along 'drag'"),
    solid("a comma in the name of a probe", [("{corner:", '{"a,b":')], "refused", "probes.a,b: a name is that of columns in tables; it must not contain a comma"),
    fluid("a comma in the name of a coefficient", [("    boundaries:", "    output: {coefficients: {'a,b': {patches: [bottom], speed: 1 m/s, area: 0.1 m^2}}}\n    boundaries:")], "refused", "coefficients.a,b: a name is that of columns in tables"),
    *(solid(f"output in {folder}", [("time-step: 1 s}", f"time-step: 1 s, output: {{folder: {folder}}}}}")], "refused", "'~' and '$' are not replaced here") for folder in ("~/results", "$HOME/results")),
]
MISTAKES = EXPRESSIONS + UNITS + VALUES + ACTS + TIMES + NAMES
