#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every program that reads a mesh says once, in one line, how good it is and where it is worst, and refuses a folded one by
cell and place before its first step. usage: run.py BIN_FOLDER SQUARE_MESH"""
import pathlib
import re
import subprocess
import sys
import tempfile

SOLID = "material: {density: 1000, youngs-modulus: 1 MPa, poissons-ratio: 0.3}"
PROGRAMS = {
    "solid_solver": f"dimension: 2, analysis: static, {SOLID}, boundaries: {{left: {{type: fixed-displacement, value: [0, 0]}}, "
                    "right: {type: traction, value: [1, 0]}, bottom: {type: free}, top: {type: free}}",
    "fluid_solver": "dimension: 2, density: 1, viscosity: 1, boundaries: {left: {type: inlet, velocity: [1, 0]}, right: {type: outlet}, "
                    "bottom: {type: no-slip}, top: {type: no-slip}}",
    "mesh_mover": "dimension: 2, boundaries: {left: {type: moving, motion: {translation: ['0.01*t', 0]}}, right: {type: fixed}, "
                  "bottom: {type: free}, top: {type: free}}",
    "plate_modal": f"{SOLID}, thickness: 1 cm, modes: {{number: 2}}, initial-amplitudes: [1e-4], "
                   "boundaries: {left: {type: clamped}, right: {type: free}, bottom: {type: free}, top: {type: free}}",
}
NUMBER, PLACE = r"[-\d.e+]+", r"\([-\d.e+]+(?:, [-\d.e+]+){1,2}\)"
LINE = re.compile(rf"mesh: 4 cells in a box of 1 x {NUMBER} m; smallest volume {NUMBER} m\^3 at ({PLACE}), largest non-orthogonality {NUMBER} degrees at {PLACE}, "
                  rf"skewness {NUMBER} at {PLACE}, aspect ratio ({NUMBER}) at ({PLACE})$", re.M)


def run(binary, words, mesh):
    with tempfile.TemporaryDirectory(prefix="couplet-mesh-report-") as folder:
        folder = pathlib.Path(folder)
        (folder / "square.msh").write_text(mesh)
        (folder / "case.yaml").write_text("simulation: {end-time: 0.01, time-step: 0.01}\n"
                                          f"participants: {{it: {{program: {binary.name}, mesh: square.msh, {words}}}}}\n")
        result = subprocess.run([binary, "case.yaml"], cwd=folder, capture_output=True, text=True, timeout=60, check=False)
        return result.returncode, result.stdout + result.stderr


def problems(binary, words, square):
    """The middle of the square stands at (0.5, 0.5); moved to (0.5, 0.9) the upper cells are flat, to (0.5, 1.4) folded."""
    flat, folded = (square.replace("5 0.5 0.5 0", f"5 0.5 {y} 0") for y in (0.9, 1.4))
    code, text = run(binary, words, flat)
    lines = LINE.findall(text)
    if code != 0 or len(lines) != 1:
        yield f"a sound mesh: exit code {code}, {len(lines)} lines of the report: {text[-400:]}"
    elif any(float(place.strip("()").split(",")[1]) < 0.7 for place in (lines[0][0], lines[0][2])) or not float(lines[0][1]) > 2:
        yield f"the worst is in the flat cells above: {lines[0]}"
    code, text = run(binary, words, folded)
    if code == 0 or not re.search(rf"cell \d+ (of the mid-surface )?at {PLACE}", text) or " step 1 " in text:
        yield f"a folded mesh: exit code {code}: {text[-400:]}"


def main():
    binaries, square = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).read_text(encoding="utf-8")
    assert square.count("5 0.5 0.5 0") == 1
    bad = [f"{program}: {p}" for program, words in PROGRAMS.items() for p in problems((binaries / program).resolve(), words, square)]
    print("\n".join(bad) or f"{len(PROGRAMS)} programs report their mesh and refuse a folded one")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
