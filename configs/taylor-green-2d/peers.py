# SPDX-License-Identifier: Apache-2.0
"""OpenFOAM's icoFoam on the same cells and steps for the picture of scripts/couplet study: (processor seconds, error of the velocity); omitted
where it is not installed."""
import math
import pathlib
import re
import shutil
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "client/python"), str(ROOT / "benchmarks/peers")]
from couplet.runs import launch  # noqa: E402
from runs import foam_environment, once, put_foam  # noqa: E402

SIZES = (16, 32, 64, 128)
NU, END = 0.05, 2.0
SIDE = 2 * math.pi


def exact(n, t):
    """Velocities in the cells' centres, x fastest, as blockMesh numbers them."""
    at = (np.arange(n) + 0.5) * SIDE / n
    y, x = np.meshgrid(at, at, indexing="ij")
    return np.stack([np.sin(x) * np.cos(y), -np.cos(x) * np.sin(y)], axis=-1).reshape(-1, 2) * math.exp(-2 * NU * t)


def files(n):
    """Returns {path: (class, text)} of the case."""
    dt = 1.6 / n
    pairs = {"left": ("right", "0 4 7 3"), "right": ("left", "2 6 5 1"), "bottom": ("top", "1 5 4 0"), "top": ("bottom", "3 7 6 2")}
    patches = "".join(f"{a}{{type cyclic;neighbourPatch {b};faces (({f}));}}" for a, (b, f) in pairs.items())
    corners = " ".join(f"({x * SIDE:.16g} {y * SIDE:.16g} {z})" for z in (0, 0.1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
    start = " ".join(f"({u:.12g} {v:.12g} 0)" for u, v in exact(n, 0))
    sides = "".join(f"{name}{{type cyclic;}}" for name in pairs) + "frontAndBack{type empty;}"
    return {
        "system/blockMeshDict": ("dictionary", f"scale 1; vertices ({corners}); blocks (hex (0 1 2 3 4 5 6 7) ({n} {n} 1) simpleGrading (1 1 1)); edges (); "
                                 f"boundary ({patches} frontAndBack{{type empty;faces ((0 3 2 1)(4 5 6 7));}}); mergePatchPairs ();"),
        "0/U": ("volVectorField", f"dimensions [0 1 -1 0 0 0 0]; internalField nonuniform List<vector> {n * n}({start}); boundaryField{{{sides}}}"),
        "0/p": ("volScalarField", f"dimensions [0 2 -2 0 0 0 0]; internalField uniform 0; boundaryField{{{sides}}}"),
        "constant/transportProperties": ("dictionary", f"nu [0 2 -1 0 0 0 0] {NU};"),
        "system/fvSolution": ("dictionary", "solvers{p{solver GAMG;smoother GaussSeidel;tolerance 1e-7;relTol 0.05;} pFinal{$p;relTol 0;} "
                              "U{solver smoothSolver;smoother symGaussSeidel;tolerance 1e-7;relTol 0;}} "
                              "PISO{nCorrectors 2;nNonOrthogonalCorrectors 0;pRefCell 0;pRefValue 0;}"),
        "system/fvSchemes": ("dictionary", "ddtSchemes{default backward;} gradSchemes{default Gauss linear;} divSchemes{default none;div(phi,U) Gauss linear;} "
                             "laplacianSchemes{default Gauss linear orthogonal;} interpolationSchemes{default linear;} snGradSchemes{default orthogonal;}"),
        "system/controlDict": ("dictionary", f"application icoFoam; startFrom startTime; startTime 0; stopAt endTime; endTime {END}; deltaT {dt:.12g}; "
                               f"writeControl timeStep; writeInterval {round(END / dt)}; writeFormat ascii; writePrecision 12; timeFormat general; "
                               "timePrecision 8; runTimeModifiable false;")}


def icofoam(folder, n):
    """The mesh is made before the clock starts."""
    for path, (kind, text) in files(n).items():
        put_foam(folder, path, kind, text)
    env = foam_environment()
    launch(["blockMesh"], folder / "mesh.log", folder, env=env)
    cost = launch(["icoFoam"], folder / "run.log", folder, env=env)
    last = max((f for f in folder.iterdir() if re.fullmatch(r"[0-9.]+", f.name)), key=lambda f: float(f.name))
    text = (last / "U").read_text()
    body = text[text.index("(", text.index("internalField")) + 1:text.index("boundaryField")]
    u = np.array(re.findall(r"\(([^()]+) ([^()]+) [^()]+\)", body), dtype=float)
    wanted = exact(n, float(last.name))
    return cost.cpu, float(np.linalg.norm(u - wanted) / np.linalg.norm(wanted))


def velocity(folder):
    """Returns [(name, [(seconds, error)])]; each run is made once."""
    points = []
    for n in SIZES if shutil.which("icoFoam") and shutil.which("blockMesh") else ():
        points.append(tuple(once(pathlib.Path(folder) / f"icoFoam-{n}", lambda place, n=n: icofoam(place, n))))
    return [("icoFoam", points)] if points else []
