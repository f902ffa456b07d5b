# SPDX-License-Identifier: Apache-2.0
"""CalculiX (bricks) and OpenFOAM's solidDisplacementFoam on the same mesh for the picture of scripts/study:
(processor seconds, error of the stress at D); programs that are not installed are omitted."""
import pathlib
import re
import shutil
import subprocess
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / "client/python"), str(ROOT / "benchmarks/peers")]
from couplet.runs import launch  # noqa: E402
from plane_mesh import PlaneMesh  # noqa: E402
from runs import foam_environment, put_foam, series  # noqa: E402

SIZES = (16, 32, 64)
YOUNG, POISSON, PULL, STRESS = 210e9, 0.3, 1e7, 92.66e6
DEPTH = 0.01  # [m]: thin, so that bricks are in plane stress; at the 0.1 m of the case they differ by 1 % from one side to the other


def mesh_of(folder, n):
    """By gmsh, as solid_solver has it made, before the clock starts."""
    file = folder / "le1.msh"
    subprocess.run(["gmsh", "-2", str(HERE / "le1.geo"), "-setnumber", "nr", str(n), "-setnumber", "nt", str(3 * n // 2), "-format", "msh41",
                    "-o", str(file)], check=True, capture_output=True)
    return PlaneMesh(file)


def error(stress):
    return abs(stress - STRESS) / STRESS


def calculix(folder, n):
    """Bricks with incompatible modes, one across the thickness and free to get thinner."""
    mesh = mesh_of(folder, n)
    m = len(mesh.points)
    pulled = {frozenset(e) for e in mesh.edges["outer"]}
    sides = [(c + 1, k + 3) for c, corners in enumerate(mesh.cells)
             for k in range(4) if frozenset((corners[k], corners[(k + 1) % 4])) in pulled]
    on = {patch: sorted({p for e in mesh.edges[patch] for p in e}) for patch in ("symmetry-x", "symmetry-y")}
    fixed = [(p + 1 + up, axis) for patch, axis in (("symmetry-x", 1), ("symmetry-y", 2)) for p in on[patch] for up in (0, m)]
    d = int(np.argmin(((mesh.points - (2, 0)) ** 2).sum(axis=1))) + 1
    lines = ["*NODE, NSET=ALL", *(f"{i + 1 + up}, {x:.15g}, {y:.15g}, {z}" for up, z in ((0, 0), (m, DEPTH)) for i, (x, y) in enumerate(mesh.points)),
             "*ELEMENT, TYPE=C3D8I, ELSET=PLATE",
             *(f"{i + 1}, {', '.join(str(p + 1 + up) for up in (0, m) for p in c)}" for i, c in enumerate(mesh.cells)), "*MATERIAL, NAME=STEEL", "*ELASTIC",
             f"{YOUNG}, {POISSON}", "*SOLID SECTION, ELSET=PLATE, MATERIAL=STEEL", "*BOUNDARY", *(f"{p}, {a}, {a}" for p, a in fixed),
             *(f"{p + 1}, 3, 3" for p in range(m)), "*STEP", "*STATIC, SOLVER=SPOOLES", "*DLOAD", *(f"{c}, P{k}, {-PULL}" for c, k in sides),
             "*EL FILE", "S", "*END STEP"]
    (folder / "plate.inp").write_text("\n".join(lines) + "\n")
    cost = launch(["ccx", "plate"], folder / "run.log", folder)
    stresses = (folder / "plate.frd").read_text().split("STRESS", 1)[1].split("\n -3", 1)[0].splitlines()
    both = [float(line[25:37]) for line in stresses if line.startswith(" -1") and int(line[3:13]) in (d, d + m)]
    return cost.cpu, error(sum(both) / len(both))


def foam(folder, n):
    mesh = mesh_of(folder, n)
    mesh.write_foam(folder, DEPTH, {"symmetry-x": "symmetryPlane", "symmetry-y": "symmetryPlane", "outer": "patch", "inner": "patch"})

    def put(path, kind, text):
        put_foam(folder, path, kind, text)

    free = "{type tractionDisplacement; traction uniform (0 0 0); pressure uniform %g; value uniform (0 0 0);}"
    put("0/D", "volVectorField", "dimensions [0 1 0 0 0 0 0]; internalField uniform (0 0 0); boundaryField {symmetry-x {type symmetryPlane;} "
        f"symmetry-y {{type symmetryPlane;}} inner {free % 0} outer {free % -PULL} frontAndBack {{type empty;}}}}")
    put("constant/mechanicalProperties", "dictionary",
        f"rho {{type uniform; value 7850;}} nu {{type uniform; value {POISSON};}} E {{type uniform; value {YOUNG};}} planeStress yes;")
    put("constant/thermalProperties", "dictionary", "C {type uniform; value 434;} k {type uniform; value 60.5;} alpha {type uniform; value 1e-5;} thermalStress no;")
    put("system/fvSolution", "dictionary", 'solvers {"(D|T)" {solver GAMG; smoother GaussSeidel; nCellsInCoarsestLevel 20; tolerance 1e-12; relTol 0.9;}} '
        "stressAnalysis {compactNormalStress yes; nCorrectors 100000; D 1e-6;}")
    put("system/fvSchemes", "dictionary", "d2dt2Schemes {default steadyState;} ddtSchemes {default Euler;} gradSchemes {default leastSquares;} "
        "divSchemes {default none; div(sigmaD) Gauss linear;} laplacianSchemes {default none; laplacian(DD,D) Gauss linear corrected; "
        "laplacian(DT,T) Gauss linear corrected;} interpolationSchemes {default linear;} snGradSchemes {default none;}")
    put("system/controlDict", "dictionary", "application solidDisplacementFoam; startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1; "
        "writeControl timeStep; writeInterval 1; writeFormat ascii; writePrecision 10; timeFormat general;")
    env = foam_environment()
    cost = launch(["solidDisplacementFoam"], folder / "run.log", folder, env=env)
    return cost.cpu, error(stress_at_d(folder, mesh))


def stress_at_d(folder, mesh):
    """From the cells along y = 0: a parabola through the three nearest, as the program gives stresses in cells."""
    text = (folder / "1/sigma").read_text() if (folder / "1/sigma").exists() else None
    if text:
        body = text[text.index("(", text.index("internalField")) + 1:text.index("boundaryField")]
        stress = [float(m.split()[3]) for m in re.findall(r"\(([^()]+)\)", body)]
    else:
        text = (folder / "1/sigmayy").read_text()
        body = text[text.index("(", text.index("internalField")) + 1:text.index("boundaryField")]
        stress = [float(v) for v in body.split(")")[0].split()]
    along = {frozenset(e) for e in mesh.edges["symmetry-y"]}
    cells = [c for c, corners in enumerate(mesh.cells) if any(frozenset((corners[k], corners[(k + 1) % 4])) in along for k in range(4))]
    nearest = sorted(cells, key=lambda c: mesh.centres()[c][0])[:3]
    return float(np.polyval(np.polyfit([mesh.centres()[c][0] - 2 for c in nearest], [stress[c] for c in nearest], 2), 0))


PEERS = (("CalculiX C3D8I", "ccx", calculix, SIZES), ("solidDisplacementFoam", "solidDisplacementFoam", foam, SIZES))


def stress(folder):
    return series(folder, PEERS if shutil.which("gmsh") else [])
