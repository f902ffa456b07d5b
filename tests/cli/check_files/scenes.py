# SPDX-License-Identifier: Apache-2.0
"""Which keys of which program name files, a scene with each, a right file and broken ones."""
import gzip
import pathlib
import sys
from dataclasses import dataclass, field

WRONG = pathlib.Path(__file__).resolve().parents[1] / "wrong"
sys.path.insert(0, str(WRONG))
from table import CASES  # noqa: E402

OF_MESH = next(c for c in CASES if c.name == "seat of unknown stiffness").edits[0][0]  # what a file of modes replaces


@dataclass
class Scene:
    program: str
    key: str  # as --check names it
    base: str  # NAME.yaml of tests/cli/wrong
    edits: list
    file: str
    right: bytes  # None: made by a run
    broken: dict = field(default_factory=dict)  # what is wrong -> (bytes, words of the message)
    word: str = "file"  # the key's own name in --docs; empty: a key of another kind

    def text(self):
        text = (WRONG / f"{self.base}.yaml").read_text()
        for old, new in self.edits:
            if text.count(old) != 1:
                raise SystemExit(f"{self.key}: '{old}' is in {self.base}.yaml {text.count(old)} times instead of once")
            text = text.replace(old, new)
        return text


def table(separator=",", names=("t", "p"), rows=((0, 1.5), (1, 2.5), (2, 3.5)), comma=False):
    lines = [separator.join(names), *(separator.join(str(v) for v in row) for row in rows)]
    text = "\n".join(lines) + "\n"
    return (text.replace(".", ",") if comma else text).encode()


# 40 MB of blank lines in some 40 kB, behind a right file: members of gzip follow one another.
BOMB = gzip.compress((b" " * 99 + b"\n") * 400000, 9)


def broken_texts(right):
    """What may be wrong with any text file: the same for all readers."""
    lines = right.decode().rstrip("\n").split("\n")
    last = lines[-1]
    n = len(lines)
    cells = last.replace(";", ",").split(",")
    return {
        "a row with one cell more": (("\n".join([*lines[:-1], last + ",7"]) + "\n").encode(), [f":{n}: ", "columns"]),
        "a cell that is nan": ("\n".join([*lines, ",".join(["nan"] * len(cells))]).encode(), [":"]),
        "zero bytes": (right.replace(b"\n", b"\n\0", 1), [":2: ", "zero bytes"]),
        "UTF-16": (right.decode().encode("utf-16"), ["zero bytes"]),
        "a line without end": (right + b"1" * 70000, ["more than 65536 bytes"]),
        "gzip that was cut": (gzip.compress(right)[:-9], ["damaged or truncated"]),
        "gzip with a flipped bit": (bytes([*gzip.compress(right)[:-6], 0, *gzip.compress(right)[-5:]]), ["damaged or truncated"]),
        "a gzip bomb": (gzip.compress(right) + BOMB, ["expands to more than 100 times"]),
        "nothing": (b"", [""]),
    }


MESH = (WRONG / "square.msh").read_bytes()
BROKEN_MESH = {"half of it": (MESH[:len(MESH) // 2], [""]), "no mesh": (b"hello\n", [""]), "nothing": (b"", [""])}
OWN_MESH = [("square.msh", "own.msh")]

LOAD = table()
COMMAS = {"decimal commas": (table(";", comma=True), [":2: '1,5' has a decimal comma; write 1.5"]),
          "decimal commas, tabs": (table("\t", comma=True), [":2: '1,5' has a decimal comma"]),
          "decimal commas among commas": (table(",", comma=True), [":2: 3 values, but the file has 2 columns"]),
          "places that do not grow": (table(rows=((0, 1.5), (2, 1), (1, 3))), [":4: ", "must increase"]),
          "numbers beyond doubles": (table(rows=((0, "1e999"), (1, 1))), [":2: '1e999' is beyond the range"])}
GRID = b"y,t,u,v\n0,0,1.5,0\n0,1,1,0\n1,0,1,0\n1,1,1,0\n"
BROKEN_GRID = {"decimal commas": (GRID.replace(b",", b";").replace(b".", b","), [":2: '1,5' has a decimal comma"]),
               "a place without a value": (GRID.rsplit(b"\n", 2)[0] + b"\n", ["no value at"]),
               "a place twice": (GRID + b"1,1,1,0\n", [":6: "])}
HEAD = "hour,dni_W_m2,T_degC,wind_m_s,rh_pct,p_Pa\n"
WEATHER = (HEAD + "".join(f"{h},0,20.5,1,50,101325\n" for h in range(24))).encode()
YEAR = (HEAD + "".join(f"{h},0,20.5,1,50,101325\n" for h in range(8760))).encode()


def broken_weather(right):
    return {"semicolons and decimal commas": (right.replace(b",", b";").replace(b".", b","), [":1: "]),
            "decimal commas": (right.replace(b"20.5", b"20,5"), [":2: 7 values, but the file has 6 columns. If commas are decimal commas"]),
            "a row less": (right.rsplit(b"\n", 2)[0] + b"\n", ["23 of the 24 hours"])}


FLOWS = b"time [h],mass-flow [kg/s],inlet-temperature [degC]\n0,-20,390.5\n1,20,290\n"
BROKEN_FLOWS = {"decimal commas": (FLOWS.replace(b",", b";").replace(b".", b","), [":2: '390,5' has a decimal comma"]),
                "times that do not grow": (FLOWS + b"0.5,20,290\n", [":4: "])}

ROWS = """    flow:
      type: schedule
      rows:
        - {at: 0 h, mass-flow: -20 kg/s, inlet-temperature: 390 degC}
"""
TANK = """    diameter: 10 m
    fluid: {type: solar-salt}
    bed:
      cells: 20
      advection: tvd
      initial-temperature: 290 degC
      layers:
        - {height: 5 m, porosity: 0.22, diameter: 5 mm}
    shell:
      material: {type: a387-grade-91}
      plates:
        - {height: 5 m, thickness: 20 mm}
    filler-mechanics: {}
    insulation: {thickness: 0.3 m}
    ground:
      layers:
        - {material: soil, thickness: 5 m}
""" + ROWS
GROUND = """    element: ground
    diameter: 18.2 m
    initial-temperature: 204 degC
    ground: {layers: [{material: soil, thickness: 9 m}]}
"""
BLANKET = """    element: insulation
    diameter: 18.2 m
    height: 14 m
    initial-temperature: 204 degC
    insulation: {thickness: 0.3 m}
"""
FILE = "    ambient: {type: file, file: w.csv}\n"
AIR = ("    ambient: {type: smooth-days, latitude: 37, daily-sums: [1e7, 1e7, 1e7, 1e7, 1e7, 1e7, 1e7, 1e7, 1e7, 1e7, 1e7, 1e7], "
       "air: w.csv}\n")


def of_table(program, key, base, old, new, word=""):
    return Scene(program, key, base, [(old, new)], "p.csv", LOAD, {**broken_texts(LOAD), **COMMAS}, word)


def weather(key, edits, all_of_it=True):
    right = YEAR if key.endswith("air") else WEATHER
    broken = {**(broken_texts(right) if all_of_it else {}), **broken_weather(right)}
    return Scene("thermocline", key, "tank", edits, "w.csv", right, broken, key.rsplit(".", 1)[1])


SCENES = [
    Scene("solid_solver", "participants.solid.mesh", "solid", OWN_MESH, "own.msh", MESH, BROKEN_MESH, "mesh"),
    Scene("fluid_solver", "participants.fluid.mesh", "fluid", OWN_MESH, "own.msh", MESH, BROKEN_MESH, "mesh"),
    Scene("plate_modal", "participants.plate.mesh", "plate", OWN_MESH, "own.msh", MESH, BROKEN_MESH, "mesh"),
    Scene("mesh_mover", "participants.mover.mesh", "coupled", [("    program: mesh_mover\n    mesh: square.msh", "    program: mesh_mover\n    mesh: own.msh")],
          "own.msh", MESH, BROKEN_MESH, "mesh"),
    of_table("solid_solver", "participants.solid.boundaries.right.value", "solid", "{type: traction, value: [1000, 0]}",
             "{type: pressure, value: {of: t, file: p.csv, column: p}}"),
    of_table("solid_solver", "participants.solid.boundaries.right.value", "solid", "value: [1000, 0]", "value: [0, '2*table(t, \"p.csv\")']"),
    of_table("fluid_solver", "participants.fluid.boundaries.left.velocity", "fluid", "velocity: [1 m/s, 0 m/s]",
             "velocity: [{of: t, file: p.csv}, 0]"),
    of_table("mesh_mover", "participants.mover.boundaries.top.motion", "coupled", "      bottom: {type: interface}\n      top: {type: fixed}",
             "      bottom: {type: interface}\n      top: {type: moving, motion: {translation: [0, {of: t, file: p.csv}]}}"),
    of_table("plate_modal", "participants.plate.load.upper-pressure", "plate", "    modes: {number: 3}\n",
             "    modes: {number: 3}\n    load: {upper-pressure: {of: t, file: p.csv}}\n"),
    Scene("fluid_solver", "participants.fluid.boundaries.left.table.file", "fluid", [(", velocity: [1 m/s, 0 m/s]", ", table: {file: g.csv}")],
          "g.csv", GRID, {**broken_texts(GRID), **BROKEN_GRID}),
    Scene("plate_modal", "participants.plate.modes.file", "plate", [(OF_MESH, ""), ("modes: {number: 3}", "modes: {file: own.h5}"),
                                                                    ("    contact: {height: -1 cm}\n", "")], "own.h5", None),
    weather("participants.tank.ambient.file", [("    flow:\n", FILE + "    flow:\n")]),
    weather("participants.tank.ambient.air", [("    flow:\n", AIR + "    flow:\n")]),
    weather("participants.tank.ambient.file", [(TANK, GROUND + FILE)], False),
    weather("participants.tank.ambient.air", [(TANK, GROUND + AIR)], False),
    weather("participants.tank.ambient.file", [(TANK, BLANKET + FILE)], False),
    weather("participants.tank.ambient.air", [(TANK, BLANKET + AIR)], False),
    Scene("thermocline", "participants.tank.flow.file", "tank", [(ROWS, "    flow: {type: schedule, file: f.csv}\n")], "f.csv", FLOWS,
          {**broken_texts(FLOWS), **BROKEN_FLOWS}),
]
