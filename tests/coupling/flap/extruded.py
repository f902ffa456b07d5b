#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The flap in 3-D, extruded with slip and symmetry sides, moves as the flap in 2-D does on the same cells. Not to
round-off: the weights of the vertex interpolation know the distance across.
Usage: extruded.py CONFIG_FOLDER BIN"""
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import COUPLED, mpmd, said  # noqa: E402

DEPTH, LAYERS, STEPS = 0.5, 2, 10
COUNTS = {"n_side = 80": "n_side = 20", "n_side = 160": "n_side = 40", "n_tip = 8": "n_tip = 4", "n_tip = 16": "n_tip = 8",
          "growth = 1.12; ": "growth = 1.25; ", "wall_cells = 10": "wall_cells = 5"}
# Physical name -> boxes (lower, upper corner) that hold its surfaces.
HALF, E = 0.05, 1e-3
SIDES = [(-3, 0, 0, 3, 4, 0), (-3, 0, DEPTH, 3, 4, DEPTH)]
FLAP = [(-HALF, 0, 0, -HALF, 1, DEPTH), (HALF, 0, 0, HALF, 1, DEPTH), (-HALF, 1, 0, HALF, 1, DEPTH)]
FLUID = {"inlet": [(-3, 0, 0, -3, 4, DEPTH)], "outlet": [(3, 0, 0, 3, 4, DEPTH)],
         "walls": [(-3, 0, 0, 3, 0, DEPTH), (-3, 4, 0, 3, 4, DEPTH)], "flap": FLAP, "sides": SIDES}
SOLID = {"root": [(-HALF, 0, 0, HALF, 0, DEPTH)], "flap": FLAP, "sides": SIDES}


def coarse(text):
    for old, new in COUNTS.items():
        text = text.replace(old, new)
    return text


def extruded(text, surfaces, patches):
    text = text[: text.index("Physical Curve")]
    text += f"made[] = Extrude {{0, 0, {DEPTH}}} {{ Surface{{{surfaces}}}; Layers{{{LAYERS}}}; Recombine; }};\n"
    text += 'Physical Volume("all") = Volume{:};\n'
    for name, boxes in patches.items():
        for i, box in enumerate(boxes):
            corners = [c - E for c in box[:3]] + [c + E for c in box[3:]]
            text += f"{name}{i}[] = Surface In BoundingBox{{{', '.join(map(str, corners))}}};\n"
        text += f'Physical Surface("{name}") = {{{", ".join(f"{name}{i}[]" for i in range(len(boxes)))}}};\n'
    return text


def case_3d(text):
    for old, new in (("dimension: 2", "dimension: 3"), ("[10 m/s, 0 m/s]", "[10 m/s, 0 m/s, 0 m/s]"),
                     ("    plane: strain\n", ""), ("value: [0, 0]", "value: [0, 0, 0]"),
                     ("point: [0, 1]", f"point: [0, 1, {DEPTH / 2}]")):
        assert old in text, old
        text = text.replace(old, new)
    fluid, rest = text.split("\n  solid:")
    solid, mover = rest.split("\n  mover:")
    flap = "flap: {type: interface}"
    add = lambda part, kind: part.replace(flap, f"{flap}\n      sides: {{type: {kind}}}")
    return "\n  solid:".join((add(fluid, "slip"), add(solid, "symmetry"))) + "\n  mover:" + add(mover, "slip")


def tips(folder, bin_folder):
    sets = [f"--set={s}" for s in (f"simulation.end-time={STEPS * 0.01}", "coupling.convergence.relative=1e-9",
                                   "coupling.convergence.max-iterations=100",
                                   "participants.fluid.pressure-tolerance=1e-11")]
    said(mpmd([bin_folder / program, "case.yaml", *sets] for program in COUPLED), 250, cwd=folder)
    lines = (folder / "out/solid/probes.csv").read_text().splitlines()[1:]
    return [[float(v) for v in line.split(",")] for line in lines]


def main():
    config, bin_folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory() as scratch:
        flat, deep = pathlib.Path(scratch) / "2d", pathlib.Path(scratch) / "3d"
        for folder in (flat, deep):
            folder.mkdir()
        case = (config / "case.yaml").read_text()
        fluid, solid = (coarse((config / f"{name}.geo").read_text()) for name in ("fluid", "solid"))
        (flat / "case.yaml").write_text(case)
        (flat / "fluid.geo").write_text(fluid)
        (flat / "solid.geo").write_text(solid)
        (deep / "case.yaml").write_text(case_3d(case))
        (deep / "fluid.geo").write_text(extruded(fluid, "50, 52:58", FLUID))
        (deep / "solid.geo").write_text(extruded(solid, "1", SOLID))
        two, three = tips(flat, bin_folder), tips(deep, bin_folder)
    largest = max(abs(row[1]) for row in two)
    gap = max(abs(a[i] - b[i]) for a, b in zip(two, three) for i in (1, 2)) / largest
    across = max(abs(b[3]) for b in three) / largest
    print(f"{len(two)} steps, tip moved {largest:.6g} m; 2-D and 3-D differ by {gap:.2e} of it, across {across:.2e}")
    if len(two) != STEPS or len(three) != STEPS or largest < 1e-3 or gap > 2e-3 or across > 1e-9:
        sys.exit("2-D and 3-D do not agree")


main()
