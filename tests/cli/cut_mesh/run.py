# SPDX-License-Identifier: Apache-2.0
"""Runs from a cut mesh, beside the same from the mesh it was cut from. Usage: run.py BIN PART; parts: fluid, periodic, solid, mover, command, refused"""
import pathlib
import re
import subprocess
import sys
import tempfile

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "tests/support"), str(ROOT / "tests/cli/couplet"), str(ROOT / "client/python")]
from checks import check, end  # noqa: E402
from scene import call, environment  # noqa: E402

bin_, part = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
TIMES = "simulation: {end-time: 0.04, time-step: 0.01, output: {interval: 0.04}, checkpoint: {interval: 0.02}, accept: [error-estimate]}\n"
SCENES = {
    # Pressure and velocity are solved so tightly that what is left of a tolerance is not seen.
    "fluid": "fluid_solver, dimension: 2, density: 1, viscosity: 0.01, pressure-tolerance: 1e-11, probes: {middle: {point: [0.5, 0.4]}}, boundaries: {left: {type: no-slip}, "
             "right: {type: no-slip}, bottom: {type: no-slip}, top: {type: moving-wall, velocity: [1, 0]}}",
    "periodic": "fluid_solver, dimension: 2, density: 1, viscosity: 0.01, pressure-tolerance: 1e-11, probes: {middle: {point: [0.5, 0.4]}}, body-force: [1, 0], boundaries: "
                "{left: {type: periodic, partner: right}, right: {type: periodic, partner: left}, bottom: {type: no-slip}, top: {type: moving-wall, velocity: [1, 0]}}",
    # Two materials: the faces between them are found in parallel, too.
    "solid": "solid_solver, dimension: 2, probes: {middle: {point: [0.5, 0.4]}}, materials: {soft: {zones: [west], density: 1000, youngs-modulus: 1 MPa, poissons-ratio: 0.3}, "
             "hard: {zones: [east], density: 3000, youngs-modulus: 50 MPa, poissons-ratio: 0.2}}, boundaries: {left: {type: fixed-displacement, value: [0, 0]}, "
             "right: {type: traction, value: [0, 1000]}, bottom: {type: free}, top: {type: free}}",
    "mover": "mesh_mover, dimension: 2, boundaries: {left: {type: moving, motion: {displacement: ['t*t', 'y*t']}}, right: {type: fixed}, bottom: {type: slip}, top: {type: free}}",
}

# Of the largest value: what the solvers leave.
TOLERANCE = {"fluid": 1e-7, "periodic": 1e-7, "solid": 1e-7, "mover": 1e-7}


def square(n):
    """The unit square of n x n quadrilaterals, those right of the middle in the zone east; .msh 2.2."""
    def at(i, j):
        return 1 + i + (n + 1) * j
    points = [f"{at(i, j)} {i / n} {j / n + 0.1 * (i / n) * (1 - i / n) * (j / n)} 0" for j in range(n + 1) for i in range(n + 1)]
    sides = [(1, at(0, j + 1), at(0, j)) for j in range(n)] + [(2, at(n, j), at(n, j + 1)) for j in range(n)]
    sides += [(3, at(i, 0), at(i + 1, 0)) for i in range(n)] + [(4, at(i + 1, n), at(i, n)) for i in range(n)]
    elements = [f"1 2 {k} {k} {a} {b}" for k, a, b in sides]
    elements += [f"3 2 {5 + (2 * i >= n)} 1 {at(i, j)} {at(i + 1, j)} {at(i + 1, j + 1)} {at(i, j + 1)}" for j in range(n) for i in range(n)]
    names = '1 1 "left"\n1 2 "right"\n1 3 "bottom"\n1 4 "top"\n2 5 "west"\n2 6 "east"'
    numbered = "\n".join(f"{i} {e}" for i, e in enumerate(elements, 1))
    return (f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n6\n{names}\n$EndPhysicalNames\n$Nodes\n{len(points)}\n" + "\n".join(points)
            + f"\n$EndNodes\n$Elements\n{len(elements)}\n{numbered}\n$EndElements\n")


def scene(folder, kind, n=16):
    """The case from the .msh, and beside it the same from the cut mesh."""
    (folder / "square.msh").write_text(square(n))
    for name, mesh in (("whole.yaml", "square.msh"), ("case.yaml", "square.h5")):
        (folder / name).write_text(f"{TIMES}participants:\n  it: {{program: {SCENES[kind]},\n    mesh: {mesh}}}\n")
    cut = call(bin_, "mesh", "cut", folder / "whole.yaml")
    check("couplet mesh cut CASE writes the cut mesh beside the mesh and says what to write", cut.returncode == 0 and "participants.it.mesh: square.h5" in cut.stdout
          and (folder / "square.h5").is_file(), cut.stdout + cut.stderr)


def run(folder, case, ranks, out, *words):
    done = call(bin_, "run", folder / case, "-n", f"it={ranks}", "--set", f"simulation.output.folder={folder / out}", *words)
    check(f"{case} runs on {ranks}: {out}", done.returncode == 0, (done.stdout + done.stderr)[-500:] if done.returncode else "")


def fields(file):
    """Of the last step, by the numbers of cells and points, which stand on file rank by rank."""
    with h5py.File(file) as data:
        numbers = {"cells": data["mesh/cell-id"][:].ravel(), "points": data["mesh/point-id"][:].ravel()}
        step = data["steps"][max(data["steps"])]
        return {f"{kind}/{name}": values[:][np.argsort(numbers[kind])] for kind in numbers if kind in step for name, values in step[kind].items()}


def apart(first, second):
    """Largest difference of any field, as a share of its largest value, and how many there are."""
    if first.keys() != second.keys():
        return np.inf, 0
    return max(np.abs(first[n] - second[n]).max() / max(np.abs(first[n]).max(), 1e-300) for n in first), len(first)


def same_results(folder, kind):
    scene(folder, kind)
    run(folder, "whole.yaml", 1, "whole")
    for ranks in (1, 2, 3):
        run(folder, "case.yaml", ranks, f"cut{ranks}")
    same = call(bin_, "compare", folder / "whole", folder / "cut1")
    count = re.search(r"^(\d+) columns and fields: equal bit for bit", same.stdout, re.M)
    check("on one rank the cut mesh gives the same bit for bit", same.returncode == 0 and count and int(count[1]) > 20, same.stdout[-600:])
    results = {name: fields(folder / name / "it/it.h5") for name in ("whole", "cut2", "cut3")}
    for ranks in (2, 3):
        gap, count = apart(results["whole"], results[f"cut{ranks}"])
        check(f"on {ranks} ranks it gives the same within the solver's tolerance", gap < TOLERANCE[kind] and count > 1, f"{gap:.2g} of the largest value, {count} fields")
    checkpoint = folder / "cut2/checkpoints/step-00000002"
    run(folder, "case.yaml", 2, "rest2", "--restart", checkpoint)
    run(folder, "case.yaml", 3, "rest3", "--restart", checkpoint)
    rest2, rest3 = (fields(folder / name / "it/it.h5") for name in ("rest2", "rest3"))
    check("a restart on the same ranks ends bit for bit alike", apart(results["cut2"], rest2)[0] == 0)
    gap, _ = apart(results["cut2"], rest3)
    check("a restart on other ranks ends alike", gap < TOLERANCE[kind], f"{gap:.2g}")


def command(folder):
    """couplet mesh: boxes in parallel, a .geo by its parameters, wrong words."""
    made = call(bin_, "mesh", "box", "--cells", 4, 5, 6, "--length", 1, 2, 3, "--tetrahedra", "-n", 2, "-o", folder / "box.h5")
    opened = call(bin_, "mesh", "open", folder / "box.h5", "-n", 3)
    check("a box made on two ranks opens on three", made.returncode == 0 and opened.returncode == 0 and "3 ranks, 720 cells" in opened.stdout, made.stderr + opened.stdout + opened.stderr)
    (folder / "strip.geo").write_text("""DefineConstant[ n = 4 ];
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1}; Transfinite Curve {1, 2, 3, 4} = n + 1; Transfinite Surface {1}; Recombine Surface {1};
Physical Curve("around") = {1, 2, 3, 4}; Physical Surface("inside") = {1};
""")
    cut = call(bin_, "mesh", "cut", folder / "strip.geo", "--dimension", 2, "--parameter", "n=7")
    check("a .geo is meshed with its parameters", cut.returncode == 0 and "49 cells" in cut.stdout, cut.stdout + cut.stderr)
    for words, said in ((("box", "-o", folder / "box.h5"), "--cells NX NY NZ"), (("cut",), "SOURCE is missing"), (("cut", folder / "strip.geo", "-o", folder / "strip.mesh"), "must end in .h5"),
                        (("cut", folder / "strip.geo", "--dimension", 2, "--parameter", "m=7"), "'m'"), (("cut", folder / "no.msh"), "does not exist"),
                        (("box", "--cells", 0, 1, 1, "-o", folder / "box.h5"), "1 to 1000000 cells"), (("open", folder / "strip.h5"), "2-dimensional")):
        wrong = call(bin_, "mesh", *words)
        check(f"couplet mesh {' '.join(map(str, words)).replace(str(folder), '')}: exit code 2, '{said}'", wrong.returncode == 2 and said in wrong.stderr, f"{wrong.returncode} {wrong.stderr[-300:]}")


def answer(folder, *words):
    done = subprocess.run([bin_ / "fluid_solver", folder / "case.yaml", *words], capture_output=True, text=True, env=environment(bin_), cwd=folder, timeout=100)
    return done.returncode, done.stdout + done.stderr


def refused(folder):
    """By --check with file, line and key; by a run with the file."""
    scene(folder, "fluid", 6)
    whole, case = (folder / "square.h5").read_bytes(), (folder / "case.yaml").read_text()

    def both(claim, words, by_run=None, key="participants.it.mesh", changed=case):
        (folder / "case.yaml").write_text(changed)
        code, text = answer(folder, "--check")
        line = next((i for i, of_case in enumerate(changed.splitlines(), 1) if key.rpartition(".")[2] + ":" in of_case), 0)
        check(f"--check, {claim}", code == 2 and re.search(rf"case\.yaml:{line}(:\d+)?: {key}: ", text) and words in text, f"{code} {text[-400:]}")
        code, text = answer(folder)
        check(f"the run, {claim}", code == 2 and (by_run or words) in text, f"{code} {text[-400:]}")

    (folder / "square.h5").unlink()
    both("no such file", "does not exist", "there is no such file")
    (folder / "square.h5").write_bytes(whole[: len(whole) // 2])
    both("truncated", "truncated")
    (folder / "square.h5").write_bytes(b"no HDF5 at all" * 50)
    both("no HDF5", "square.h5")
    (folder / "square.h5").write_bytes(whole)
    with h5py.File(folder / "square.h5", "a") as file:
        file.attrs["cut-mesh-version"] = 2.0
    both("of another version", "it is of version 2; this program reads version 1")
    with h5py.File(folder / "square.h5", "a") as file:
        del file.attrs["cut-mesh-version"]
    both("another HDF5 file", "not a cut mesh")
    (folder / "square.h5").write_bytes(whole)
    both("a wrong name of a patch", "top", key="participants.it.boundaries.lid", changed=case.replace("top: {", "lid: {"))
    (folder / "case.yaml").write_text(case.replace("dimension: 2", "dimension: 2, mesh-parameters: {n: 4}"))
    code, text = answer(folder)
    check("mesh-parameters of a cut mesh", code == 2 and "'mesh-parameters' cannot change it" in text, f"{code} {text[-300:]}")


with tempfile.TemporaryDirectory(prefix="couplet-cut-mesh-") as temporary:
    {"command": command, "refused": refused}.get(part, lambda folder: same_results(folder, part))(pathlib.Path(temporary))
end()
