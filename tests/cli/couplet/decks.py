# SPDX-License-Identifier: Apache-2.0
"""Decks of CalculiX and Abaqus become cases by `couplet import`, whose answers are those of theory. Usage: decks.py BIN PART; parts: left_out, static, heat, modes"""
import csv
import itertools
import math
import pathlib
import sys
import tempfile

import yaml

from scene import call, call_here
from checks import check, end  # noqa: E402  (scene knows where it is)

bin_, what = pathlib.Path(sys.argv[1]), sys.argv[2]
STEEL = "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000, 0.3\n*DENSITY\n7.85e-9\n*EXPANSION\n1.2e-5\n*CONDUCTIVITY\n50\n*SPECIFIC HEAT\n4.6e8\n*SOLID SECTION, ELSET=Eall, MATERIAL=STEEL\n"


def rows(numbers):
    return "".join(", ".join(map(str, numbers[i:i + 12])) + "\n" for i in range(0, len(numbers), 12))


def box(cells, sizes, element, **sets):
    """A deck of quadrilaterals or hexahedra, whose sets of nodes are given by conditions on the place; E<axis> are the elements at the end of an axis."""
    step, points, elements = 2 if element.startswith("C3D20") else 1, {}, []
    dim = len(cells)
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    corners = square if dim == 2 else [(*s, z) for z in (0, 1) for s in square]
    order = [[step * c for c in corner] for corner in corners]
    if step == 2:
        edges = [(k, (k + 1) % 4) for k in range(4)] + [(4 + k, 4 + (k + 1) % 4) for k in range(4)] + [(k, k + 4) for k in range(4)]
        order += [[(a + b) // 2 for a, b in zip(order[i], order[j])] for i, j in edges]
    for cell in itertools.product(*(range(n) for n in cells)):
        elements.append([points.setdefault(tuple(step * c + o for c, o in zip(cell, at)), len(points) + 1) for at in order])
    places = {n: tuple(x * size / step / count for x, size, count in zip(p, sizes, cells)) for p, n in points.items()}
    text = f"*HEADING\na box\n*NODE, NSET=Nall\n{''.join(f'{n}, ' + ', '.join(f'{x:.9g}' for x in p) + chr(10) for n, p in places.items())}*ELEMENT, TYPE={element}, ELSET=Eall\n"
    for n, nodes in enumerate(elements, 1):
        text += f"{n}, {', '.join(map(str, nodes[:10]))}{',' if nodes[10:] else ''}\n" + (", ".join(map(str, nodes[10:])) + "\n" if nodes[10:] else "")
    for name, holds in sets.items():
        text += f"*NSET, NSET={name}\n{rows([n for n, p in places.items() if holds(*p)])}"
    for axis, count in enumerate(cells):
        at_end = [n for n, cell in enumerate(itertools.product(*(range(n) for n in cells)), 1) if cell[axis] == count - 1]
        text += f"*ELSET, ELSET=E{'xyz'[axis]}\n{rows(at_end)}"
    return text


def imported(folder, name, text, *words):
    (folder / f"{name}.inp").write_text(text)
    said = call_here(bin_, "import", folder / f"{name}.inp", *words)
    check(f"{name}: the deck is imported", said.returncode == 0, said.stderr[-500:])
    text = (folder / f"{name}.yaml").read_text()
    return said.stdout, text, yaml.safe_load(text)["participants"]["solid"]


def ran(folder, name, table):
    """Last row of a table of the run of an imported case."""
    done = call(bin_, "run", folder / f"{name}.yaml", "-q", "--set", f"simulation.output.folder={folder / name}")
    check(f"{name}: it runs", done.returncode == 0, done.stderr[-500:])
    with open(folder / name / f"solid/{table}.csv", newline="") as file:
        found = list(csv.DictReader(file))
    return found if table in ("modes", "buckling") else {key: float(value) for key, value in found[-1].items()}


def near(claim, found, wanted, share):
    check(f"{claim}: {found:.6g} for {wanted:.6g}", abs(found - wanted) <= share * abs(wanted))


ROOT = {"root": lambda x, *_: x < 1e-6}
CANTILEVER = {**ROOT, "end": lambda x, *_: x > 199.999, "tip": lambda x, y, *_: x > 199.999 and abs(y - 10) < 1e-6}


def left_out(folder):
    """All that is left out is named with its line, in the output and in the case; what cannot be a case is refused."""
    mesh = box((4, 2, 2), (4, 2, 2), "C3D8", **ROOT, line=lambda x, y, z: x > 3.9 and y > 1.9)
    deck = mesh + STEEL + "*CONTACT PAIR, INTERACTION=i\na, b\n*BOUNDARY\nroot, 1, 3\nline, 3\n*STEP\n*STATIC\n*DLOAD\nEx, P4, 2.\n1, P4, 1.\n*DLOAD\nEall, CENTRIF, 1., 0,0,0, 1,0,0\n*END STEP\n*STEP\n*DYNAMIC\n0.1, 1\n*CLOAD\nroot, 1, 5.\n*END STEP\n"
    said, text, solid = imported(folder, "deck", deck)
    lines = deck.split("\n")
    for word, line in (("*CONTACT PAIR is", "*CONTACT PAIR, INTERACTION=i"), ("*BOUNDARY of 3 of the 3 nodes of 'line'", "line, 3"), ("*DLOAD P of '1'", "1, P4, 1."),
                       ("*DLOAD CENTRIF of 'Eall'", "Eall, CENTRIF, 1., 0,0,0, 1,0,0"), ("the *STEP with *DYNAMIC", "*STEP")):
        number = (len(lines) - lines[::-1].index(line)) if line == "*STEP" else lines.index(line) + 1
        note = next((n for n in said.split("\n") if word in n), "")
        check(f"{word}: left out with its line", f"deck.inp:{number}: " in note and "is left out: " in note and f"\n# {note}" in text, (note, number))
    check("units: SI, with the option for millimeters", "taken as SI" in said and "--units mm" in said and solid["material"]["youngs-modulus"] == "210000 Pa" and "mesh-scale" not in solid, said)
    check("a load on a part of the boundary: a mesh of its own", solid["mesh"] == "deck-mesh.msh" and solid["boundaries"]["Ex-P4"] == {"type": "pressure", "value": "2 Pa"}, solid)
    again = call_here(bin_, "import", folder / "deck.inp")
    check("an existing case is kept", again.returncode == 2 and "--force" in again.stderr, again.stderr)
    (folder / "deck.yaml").unlink()
    listed = call_here(bin_, "import", folder / "deck.inp", "--check")
    check("--check only lists", listed.stdout in said and "CONTACT PAIR" in listed.stdout and not (folder / "deck.yaml").exists(), listed.stdout)
    said, _, solid = imported(folder, "plain", mesh + STEEL + "*BOUNDARY\nroot, ENCASTRE\n*STEP\n*STATIC\n*DLOAD\nEall, GRAV, 9810., 0, 0, -1\n*END STEP\n", "--units", "mm")
    check("patches of the deck suffice: the deck is the mesh, in millimeters", solid["mesh"] == "plain.inp" and solid["mesh-scale"] == 0.001 and solid["boundaries"]["root"]["type"] == "fixed-displacement", solid)
    check("density and gravity in SI", solid["material"]["density"] == "7850 kg/m^3" and solid["gravity"][2] == "-9.81 m/s^2", solid)
    step = "*BOUNDARY\nroot, 1, 3\n*STEP\n*FREQUENCY\n2\n*END STEP\n"
    for claim, text, words in (("a deck without a step", mesh + STEEL, "nothing to run: no *STEP contains one of *STATIC"), ("modes without a density", mesh + STEEL.replace("*DENSITY\n7.85e-9\n", "") + step, "needs *DENSITY"),
                               ("an unknown set", mesh + STEEL + "*BOUNDARY\nnone, 1\n", "'none' is neither a number nor the name of an *NSET"), ("a missing material", mesh + STEEL.replace("NAME=STEEL", "NAME=IRON") + step, "no *MATERIAL, NAME=STEEL"),
                               ("no number", mesh + STEEL.replace("210000", "21x"), "'21x' is not a number"), ("a missing section", mesh + STEEL.partition("*SOLID")[0] + step, "no *SOLID SECTION")):
        (folder / "wrong.inp").write_text(text)
        done = call_here(bin_, "import", folder / "wrong.inp")
        check(f"{claim} is refused", done.returncode == 2 and words in done.stderr and not (folder / "wrong.yaml").exists(), done.stderr)
    done = call_here(bin_, "import", folder / "a.xml", "--units", "mm")
    check("--units is of decks", done.returncode == 2 and "--units: applies to decks" in done.stderr, done.stderr)


def static(folder):
    """Deflection of a cantilever, a pipe, and thermal stress."""
    end_load = "*CLOAD\nend, 2, -10.\n*NODE PRINT, NSET=tip\nU\n*END STEP\n"
    said, _, solid = imported(folder, "sheet", box((80, 8), (200, 20), "CPS4", **CANTILEVER) + STEEL + "5.\n*BOUNDARY\nroot, 1, 2\n*STEP\n*STATIC\n" + end_load, "--units", "mm")
    check("the force of 9 nodes for a depth of 1 m instead of 5 mm", solid["boundaries"]["end"] == {"type": "force", "value": ["0 N", "-18000 N"]} and solid["plane"] == "stress", solid)
    tip = next(value for key, value in ran(folder, "sheet", "probes").items() if " y " in key)
    near("cantilever", tip, -(90 * 200**3 / (3 * 210000 * 20**3 * 5 / 12) + 1.2 * 90 * 200 / (80769 * 100)) * 1e-3, 0.01)
    beam = box((20, 2, 2), (200, 20, 10), "C3D20R", **ROOT, tip=lambda x, y, z: x > 199.999 and abs(y - 10) < 1e-6 and abs(z - 5) < 1e-6)
    _, _, solid = imported(folder, "beam", beam + STEEL + "*BOUNDARY\nroot, PINNED\n*STEP\n*STATIC\n*DLOAD\nEz, P2, 0.1\n*NODE PRINT, NSET=tip\nU\n*END STEP\n", "--units", "mm")
    tip = next(value for key, value in ran(folder, "beam", "probes").items() if " z " in key)
    near("cantilever of C3D20R under pressure", tip, -2 * 200**4 / (8 * 210000 * 20 * 10**3 / 12) * 1e-3, 0.02)
    ends = {"left": lambda x, *_: x < 1e-6, "right": lambda x, *_: x > 99.999, "low": lambda x, y, z: y < 1e-6, "near": lambda x, y, z: z < 1e-6}
    hot = "*BOUNDARY\nleft, XSYMM\nright, 1\nlow, 2\nnear, 3, 3, 0.\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNall, 20\n*STEP\n*STATIC\n*TEMPERATURE\nNall, 120\n*END STEP\n"
    said, _, solid = imported(folder, "hot", box((4, 2, 2), (100, 40, 40), "C3D8", **ends) + STEEL + hot, "--units", "mm")
    check("temperatures below 70 are taken in degC, which is said", solid["temperature"] == "120 degC" and "taken in degC" in said, said)
    near("force of a heated block between walls", ran(folder, "hot", "reactions")["left x [N]"], 210000 * 1.2e-5 * 100 * 1600, 1e-6)
    table = "*MATERIAL, NAME=S\n*ELASTIC\n210000, .3\n*EXPANSION, ZERO=20\n1.1e-5, 20\n1.3e-5, 150\n1.6e-5, 300\n*SOLID SECTION, ELSET=Eall, MATERIAL=S\n"
    free = hot.replace("right, 1\n", "").replace("Nall, 120\n", "Nall, 220\n*NODE PRINT, NSET=tip\nU\n")
    imported(folder, "free", box((2, 2, 2), (100, 40, 40), "C3D8", **ends, tip=lambda x, y, z: x > 99 and min(y, z) > 39) + table + free, "--units", "mm")
    near("strain of mean coefficients over temperature", next(v for k, v in ran(folder, "free", "probes").items() if " x " in k), 1.44e-5 * 200 * 0.1, 1e-5)
    surfaces = "*SURFACE, NAME=skin\nEy, S5\nEx, S4\n*SURFACE, NAME=top\nEy, S5\n*BOUNDARY\nroot, 1, 2\nNall, 3\n*STEP\n*STATIC\n*DSLOAD\ntop, P, 1.\n*DLOAD\nEx, P4, -3.\n*END STEP\n"
    imported(folder, "layer", box((10, 4, 1), (100, 20, 5), "C3D8I", **ROOT) + STEEL + surfaces, "--units", "mm")
    sums = ran(folder, "layer", "reactions")
    near("pressure on faces of two surfaces that are held along z", sums["load y [N]"], -500, 1e-9)
    near("tension beside it", sums["load x [N]"], 300, 1e-9)


def heat(folder):
    """A bar between a temperature and a fluid, and a pipe with heat and pressure."""
    bar = box((8, 2, 2), (100, 40, 40), "C3D8", left=lambda x, *_: x < 1e-6)
    said, _, solid = imported(folder, "bar", bar + STEEL + "*PHYSICAL CONSTANTS, ABSOLUTE ZERO=0\n*STEP\n*HEAT TRANSFER, STEADY STATE\n*BOUNDARY\nleft, 11, 11, 373.15\n*FILM\nEx, F4, 293.15, 0.5\n*END STEP\n", "--units", "mm")
    check("heat alone, in K as the deck says", solid["analysis"] == "thermal" and solid["heat"]["boundaries"]["left"]["value"] == "373.15 K" and "taken in K" not in said, said)
    near("heat through the bar", ran(folder, "bar", "heat")["left [W]"], 32, 1e-6)
    inner = "".join(f"{n}, P4, 10.\n" for n in range(1, 5))  # elements at the inner radius
    pipe = box((8, 4), (10, 10), "CAX4", ends=lambda x, y: y < 1e-6 or y > 9.999, tip=lambda x, y: x < 1e-6 and abs(y - 5) < 1e-6)
    pipe = "\n".join(f"{w[0]}, {float(w[1]) + 50}, {w[2]}" if len(w := line.split(", ")) == 3 and "*" not in line and "." not in w[0] and i < 48 else line for i, line in enumerate(pipe.split("\n")))
    pressed = "*BOUNDARY\nends, 2\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNall, 20\n*STEP\n*STATIC\n*DLOAD\n" + inner + "*TEMPERATURE\nNall, 120\n*NODE PRINT, NSET=tip\nU\n*END STEP\n"
    _, _, solid = imported(folder, "pipe", pipe + STEEL + pressed, "--units", "mm")
    check("a body of revolution", solid["plane"] == "axisymmetric" and solid["boundaries"]["elements"] == {"type": "pressure", "value": "10000000 Pa"}, solid)
    pressure = 1.3 / 210000 * 10 * 2500 / 1100 * (0.4 * 50 + 3600 / 50)
    near("widening of a pipe, Lame and heat", next(v for k, v in ran(folder, "pipe", "probes").items() if " x " in k), (pressure + 1.3 * 1.2e-3 * 50) * 1e-3, 1e-3)


def modes(folder):
    """Frequencies of a cantilever, its motion after a load that grows, its load of buckling, and large bending."""
    sheet, held = box((40, 4), (200, 20), "CPS4", **CANTILEVER) + STEEL + "5.\n", "*BOUNDARY\nroot, 1, 2\n"
    imported(folder, "free", sheet + held + "*STEP\n*FREQUENCY\n2\n*END STEP\n", "--units", "mm")
    near("first frequency", float(ran(folder, "free", "modes")[0]["frequency [Hz]"]), 0.55959 * math.sqrt(2.1e11 * 20e-3**2 / 12 / 7850) / 0.2**2, 0.01)
    said, _, solid = imported(folder, "pulled", sheet + held + "*STEP\n*STATIC\n*CLOAD\nend, 1, 1000.\n*END STEP\n*STEP, PERTURBATION\n*FREQUENCY\n1\n*END STEP\n", "--units", "mm")
    check("modes of the loaded part", solid["analysis"] == "static" and solid["output"] == {"modes": 1} and "about the equilibrium" in said, solid)
    column = box((20, 2, 2), (400, 10, 10), "C3D8", **ROOT)
    said, _, solid = imported(folder, "column", column + STEEL + "*BOUNDARY\nroot, 1, 3\n*STEP\n*BUCKLE\n1\n*DLOAD\nEx, P4, 1.\n*END STEP\n", "--units", "mm")
    check("a pressure that keeps its direction, as in CalculiX", solid["boundaries"]["Ex-P4"] == {"type": "traction", "value": ["-1000000 Pa", "0 Pa", "0 Pa"]} and "keeps its direction" in said, solid)
    near("load of buckling", float(ran(folder, "column", "buckling")[0]["load factor [-]"]), math.pi**2 * 210000 * 10**4 / 12 / (4 * 400**2) / 100, 0.02)
    load = "*CLOAD, AMPLITUDE=A\nend, 2, -10.\n*NODE PRINT, NSET=tip\nU\n*END STEP\n"
    _, _, solid = imported(folder, "moving", sheet + "*AMPLITUDE, NAME=a\n0, 0, 0.002, 1,\n0.01, 1\n" + held + "*STEP\n*DYNAMIC\n1e-4, 6e-3\n" + load, "--units", "mm")
    check("a load over time", solid["boundaries"]["end"]["value"][1] == "-10000*table(t, 0, 0, 0.002, 1, 0.01, 1)", solid)
    omega, settled = math.tau * 417.3, 50 * 200**3 / (3 * 210000 * 20**3 * 5 / 12)
    wanted = settled * (1 + 0.97 * (math.sin(omega * 4e-3) - math.sin(omega * 6e-3)) / (omega * 2e-3))
    near("motion after it", -1e3 * next(v for k, v in ran(folder, "moving", "probes").items() if " y " in k), wanted, 0.03)
    _, _, solid = imported(folder, "large", sheet + held + "*STEP, NLGEOM\n*STATIC\n0.5, 1.\n*CLOAD\nend, 2, -3500.\n*NODE PRINT, NSET=tip\nU\n*END STEP\n", "--units", "mm")
    check("large strain in steps of the load", solid["kinematics"] == "finite-strain" and "table(t, 0, 0, 1, 1)" in solid["boundaries"]["end"]["value"][1], solid)
    tip = -1e3 * next(v for k, v in ran(folder, "large", "probes").items() if " y " in k)
    near("large bending for P L^2 = E I (Bisshopp and Drucker)", tip, 0.3017 * 200, 0.02)


with tempfile.TemporaryDirectory(prefix="couplet-decks-") as folder:
    {"left_out": left_out, "static": static, "heat": heat, "modes": modes}[what](pathlib.Path(folder))
end()
