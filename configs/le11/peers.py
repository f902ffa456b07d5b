# SPDX-License-Identifier: Apache-2.0
"""CalculiX on the same meshes for the picture of scripts/couplet study: (processor seconds, error of the stress at A); omitted where it is not installed."""
import pathlib
import re
import shutil
import subprocess
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / "client/python"), str(ROOT / "benchmarks/peers")]
import calculix_plate  # noqa: E402
from couplet.runs import launch  # noqa: E402
from runs import series  # noqa: E402

YOUNG, POISSON, EXPANSION, TOP, STRESS = 210e9, 0.3, 2.3e-4, 1.79, -105.67e6
MESHES = {"C3D8I": (1, 2, 4), "C3D20": (1, 2)}  # refine


def mesh(folder, element, refine):
    """Nodes (number, x, y, z) and the text of the elements, by gmsh, before the clock starts."""
    file = folder / "mesh.inp"
    subprocess.run(["gmsh", "-3", str(HERE / "le11.geo"), "-setnumber", "refine", str(refine), "-order", "2" if element == "C3D20" else "1",
                    "-setnumber", "Mesh.SecondOrderIncomplete", "1", "-format", "inp", "-o", str(file)], check=True, capture_output=True)
    blocks = re.split(r"^(?=\*[A-Z])", file.read_text(), flags=re.M)
    nodes = np.loadtxt(next(b for b in blocks if b.startswith("*NODE")).split("\n*")[0].splitlines()[1:], delimiter=",")
    bodies = [b.split("\n", 1)[1] for b in blocks if re.match(r"\*ELEMENT, type=C3D", b)]
    return nodes, f"*ELEMENT,TYPE={element},ELSET=ALL\n" + "".join(bodies)


def write(folder, element, refine):
    """The input deck; gives the number of the node at A."""
    nodes, elements = mesh(folder, element, refine)
    number, place = nodes[:, 0].astype(int), nodes[:, 1:]
    heat = np.hypot(place[:, 0], place[:, 1]) + place[:, 2]
    held = [(n, axis + 1) for axis, at in ((0, 0.0), (1, 0.0), (2, 0.0), (2, TOP)) for n in number[np.abs(place[:, axis] - at) < 1e-6]]
    lines = ["*NODE,NSET=ALL", *(f"{n},{x:.12g},{y:.12g},{z:.12g}" for n, (x, y, z) in zip(number, place)), elements.rstrip(),
             f"*MATERIAL,NAME=M\n*ELASTIC\n{YOUNG},{POISSON}\n*EXPANSION\n{EXPANSION}\n*SOLID SECTION,ELSET=ALL,MATERIAL=M",
             "*INITIAL CONDITIONS,TYPE=TEMPERATURE\nALL,0.", "*BOUNDARY", *(f"{n},{a},{a}" for n, a in held), "*STEP\n*STATIC,SOLVER=SPOOLES", "*TEMPERATURE",
             *(f"{n},{t:.12g}" for n, t in zip(number, heat)), "*EL FILE\nS\n*END STEP"]
    (folder / "body.inp").write_text("\n".join(lines) + "\n")
    return int(number[np.argmin(np.linalg.norm(place - (1, 0, 0), axis=1))])


def calculix(element):
    def run(folder, refine):
        a = write(folder, element, refine)
        seconds = launch(["ccx", "body"], folder / "run.log", folder).cpu
        return seconds, abs(calculix_plate.stress_at(folder / "body.frd", a, 2) / STRESS - 1)
    return run


def stress(folder):
    return series(folder, [(f"CalculiX {element}", "ccx", calculix(element), meshes) for element, meshes in MESHES.items()] if shutil.which("gmsh") else [])
