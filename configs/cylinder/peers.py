# SPDX-License-Identifier: Apache-2.0
"""OpenFOAM's icoFoam on the same mesh for the pictures of scripts/study: (processor seconds, error); omitted where it is not
installed. Its step keeps the largest Courant number below 0.7, as fluid_solver's sub-steps do by themselves."""
import pathlib
import re
import shutil
import subprocess
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT / "client/python"), str(ROOT / "benchmarks/peers"), str(HERE)]
import coefficients  # noqa: E402
from couplet.runs import launch  # noqa: E402
from plane_mesh import PlaneMesh  # noqa: E402
from runs import foam_environment, once, put_foam  # noqa: E402

DEPTH, NU, COURANT = 0.01, 1e-3, 0.7
FLOWS = {  # mean speed, end, velocity at the start (across the channel in the place of the gust that our case sets the street going with), sizes
    "steady": (0.2, 8.0, "0 0 0", (12, 16)), "street": (1.0, 5.0, "1 0.2 0", (12, 16))}
REFERENCES = {"cd": 5.57953523384, "cl": 0.010618948146, "cd_max": 3.2275, "St": 0.3018}


def step_of(mesh, speed):
    """By the smallest cell and the largest speed, that beside the cylinder, about 2.2 times the mean one."""
    size = min(np.sqrt(mesh.area(c)) for c in mesh.cells)
    return float(f"{COURANT * size / (2.2 * speed):.3g}")


def files(mesh, inlet, speed, end, start):
    """{path: (class, text)} of the case."""
    steps = int(np.ceil(end / step_of(mesh, speed)))
    speeds = " ".join(f"({6 * speed * y * (0.41 - y) / 0.41**2:.10g} 0 0)" for _, y in inlet)
    profile = f"type fixedValue; value nonuniform List<vector> {len(inlet)}({speeds});"
    return {
        "0/U": ("volVectorField", f"dimensions [0 1 -1 0 0 0 0]; internalField uniform ({start}); boundaryField{{inlet{{{profile}}} "
                "outlet{type zeroGradient;} walls{type noSlip;} cylinder{type noSlip;} frontAndBack{type empty;}}"),
        "0/p": ("volScalarField", "dimensions [0 2 -2 0 0 0 0]; internalField uniform 0; boundaryField{inlet{type zeroGradient;} "
                "outlet{type fixedValue;value uniform 0;} walls{type zeroGradient;} cylinder{type zeroGradient;} frontAndBack{type empty;}}"),
        "constant/transportProperties": ("dictionary", f"nu [0 2 -1 0 0 0 0] {NU};"),
        "system/fvSolution": ("dictionary", "solvers{p{solver GAMG;smoother GaussSeidel;tolerance 1e-6;relTol 0.05;} pFinal{$p;relTol 0;} "
                              "U{solver smoothSolver;smoother symGaussSeidel;tolerance 1e-6;relTol 0;}} PISO{nCorrectors 2;nNonOrthogonalCorrectors 0;}"),
        "system/fvSchemes": ("dictionary", "ddtSchemes{default backward;} gradSchemes{default Gauss linear;} divSchemes{default none;div(phi,U) Gauss linear;} "
                             "laplacianSchemes{default Gauss linear corrected;} interpolationSchemes{default linear;} snGradSchemes{default corrected;}"),
        "system/controlDict": ("dictionary", f"application icoFoam; startFrom startTime; startTime 0; stopAt endTime; endTime {end}; deltaT {end / steps:.12g}; "
                               f"writeControl timeStep; writeInterval {steps}; writeFormat ascii; timeFormat general; timePrecision 8; runTimeModifiable false; "
                               f"functions{{forces{{type forces;libs (forces);patches (cylinder);rho rhoInf;rhoInf 1;CofR (0 0 0);log false;"
                               f"writeControl timeStep;writeInterval {max(1, steps // 4000)};}}}}")}


def numbers(folder, flow):
    """cd and cl at the end, or largest drag and Strouhal number over the last 1.5 s."""
    speed = FLOWS[flow][0]
    text = next((folder / "postProcessing/forces/0").glob("force*.dat")).read_text()
    rows = np.array([[float(v) for v in re.findall(r"[-+0-9.eE]+", line)] for line in text.splitlines() if not line.startswith("#")])
    t, fx, fy = rows[:, :3].T  # time, then pressure and friction together, as version 1912 writes them
    scale = 2 / (speed**2 * coefficients.DIAMETER * DEPTH)
    cd, cl = scale * fx, scale * fy
    if flow == "steady":
        return {"cd": float(cd[-1]), "cl": float(cl[-1])}
    end = t > t[-1] - 1.5
    z = coefficients.rises(t[end], cl[end])
    if len(z) < 2:
        raise ValueError("icoFoam's lift does not oscillate in the last 1.5 s")
    inside = (t > z[0]) & (t <= z[-1])
    return {"cd_max": coefficients.peak(t[inside], cd[inside]), "St": coefficients.DIAMETER / speed * (len(z) - 1) / (z[-1] - z[0])}


def icofoam(folder, flow, n):
    """The mesh is made before the clock starts."""
    speed, end, start, _ = FLOWS[flow]
    subprocess.run(["gmsh", "-2", str(HERE / "cylinder.geo"), "-setnumber", "n", str(n), "-format", "msh41", "-o", str(folder / "mesh.msh")],
                   check=True, capture_output=True)
    mesh = PlaneMesh(folder / "mesh.msh")
    middles = mesh.write_foam(folder, DEPTH, {"inlet": "patch", "outlet": "patch", "walls": "wall", "cylinder": "wall"})
    for path, (kind, text) in files(mesh, middles["inlet"], speed, end, start).items():
        put_foam(folder, path, kind, text)
    cost = launch(["icoFoam"], folder / "run.log", folder, env=foam_environment())
    return cost.cpu, numbers(folder, flow)


def of(flow, quantity):
    def points(folder):
        """[(name, [(seconds, error)])]; each run is made once, for both quantities."""
        found = []
        for n in FLOWS[flow][3] if shutil.which("icoFoam") and shutil.which("gmsh") else ():
            seconds, values = once(pathlib.Path(folder) / f"icoFoam-{flow}-{n}", lambda place, n=n: icofoam(place, flow, n))
            found.append((seconds, abs(values[quantity] / REFERENCES[quantity] - 1)))
        return [("icoFoam", found)] if found else []
    return points


drag, lift, largest_drag, strouhal = of("steady", "cd"), of("steady", "cl"), of("street", "cd_max"), of("street", "St")
