# SPDX-License-Identifier: Apache-2.0
"""Elliptic plate for OpenFOAM's solidDisplacementFoam: write a case, read the error. Hexahedra nr x nt x nz."""
import pathlib

import numpy as np

from plate import POISSON, PRESSURE, THICKNESS, YOUNG, error, place
from runs import foam_header, put_foam

SOLVERS = {"GAMG": "solver GAMG; smoother GaussSeidel; nCellsInCoarsestLevel 20;",
           "PCG": "solver PCG; preconditioner DIC;"}


def write(folder, n, tolerance, solver="GAMG", relative=0.9):
    """`tolerance`: tolerance of the outer iteration; `relative`: relative tolerance of the linear solver within one."""
    folder = pathlib.Path(folder)
    for part in ("0", "system", "constant/polyMesh"):
        (folder / part).mkdir(parents=True, exist_ok=True)
    write_mesh(folder / "constant/polyMesh", *n)

    def put(path, kind, text):
        put_foam(folder, path, kind, text)

    free = "{type tractionDisplacement; traction uniform (0 0 0); pressure uniform %g; value uniform (0 0 0);}"
    put("0/D", "volVectorField",
        "dimensions [0 1 0 0 0 0 0]; internalField uniform (0 0 0); boundaryField {symX {type symmetryPlane;} "
        "symY {type symmetryPlane;} outer {type fixedValue; value uniform (0 0 0);} "
        f"inner {free % 0} bottom {free % 0} top {free % PRESSURE}}}")
    put("constant/mechanicalProperties", "dictionary",
        f"rho {{type uniform; value 7850;}} nu {{type uniform; value {POISSON};}} E {{type uniform; value {YOUNG};}} planeStress no;")
    put("constant/thermalProperties", "dictionary",
        "C {type uniform; value 434;} k {type uniform; value 60.5;} alpha {type uniform; value 1e-5;} thermalStress no;")
    put("system/fvSolution", "dictionary",
        f'solvers {{"(D|T)" {{{SOLVERS[solver]} tolerance 1e-12; relTol {relative};}}}} '
        f"stressAnalysis {{compactNormalStress yes; nCorrectors 100000; D {tolerance};}}")
    put("system/fvSchemes", "dictionary",
        "d2dt2Schemes {default steadyState;} ddtSchemes {default Euler;} gradSchemes {default leastSquares;} "
        "divSchemes {default none; div(sigmaD) Gauss linear;} laplacianSchemes {default none; laplacian(DD,D) Gauss "
        "linear corrected; laplacian(DT,T) Gauss linear corrected;} interpolationSchemes {default linear;} snGradSchemes "
        "{default none;}")
    put("system/controlDict", "dictionary",
        "application solidDisplacementFoam; startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1; "
        "writeControl timeStep; writeInterval 1; writeFormat ascii; writePrecision 10; timeFormat general;")


def write_mesh(folder, nr, nt, nz):
    def point(i, j, k):
        return i + (nr + 1) * (j + (nt + 1) * k)

    def cell(i, j, k):
        return i + nr * (j + nt * k)

    def grid(*axes):
        return [a.ravel() for a in np.meshgrid(*axes, indexing="ij")]

    corners = {"s": ((0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1)), "t": ((0, 0, 0), (0, 0, 1), (1, 0, 1), (1, 0, 0)),
               "z": ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))}

    def faces(axis, i, j, k):
        return np.column_stack([point(i + a, j + b, k + c) for a, b, c in corners[axis]])

    k, j, i = grid(np.arange(nz + 1), np.arange(nt + 1), np.arange(nr + 1))
    points = np.column_stack(place(i / nr, j * np.pi / 2 / nt, k * THICKNESS / nz))
    points[j == nt, 0] = 0
    all_r, all_t, all_z = np.arange(nr), np.arange(nt), np.arange(nz)
    inner = []
    for axis, step, ranges in (("s", (1, 0, 0), (all_r[:-1], all_t, all_z)), ("t", (0, 1, 0), (all_r, all_t[:-1], all_z)),
                               ("z", (0, 0, 1), (all_r, all_t, all_z[:-1]))):
        i, j, k = grid(*ranges)
        next_ = (i + step[0], j + step[1], k + step[2])
        inner.append((faces(axis, *next_), cell(i, j, k), cell(*next_)))
    face, owner, neighbour = (np.concatenate(part) for part in zip(*inner))
    order = np.lexsort((neighbour, owner))
    face, owner, neighbour = face[order], owner[order], neighbour[order]
    patches = []
    for name, kind, axis, ranges, beyond in (
            ("inner", "patch", "s", ([0], all_t, all_z), 0), ("outer", "patch", "s", ([nr - 1], all_t, all_z), 1),
            ("symY", "symmetryPlane", "t", (all_r, [0], all_z), 0),
            ("symX", "symmetryPlane", "t", (all_r, [nt - 1], all_z), 1),
            ("bottom", "patch", "z", (all_r, all_t, [0]), 0), ("top", "patch", "z", (all_r, all_t, [nz - 1]), 1)):
        i, j, k = grid(*ranges)
        shift = {"s": (beyond, 0, 0), "t": (0, beyond, 0), "z": (0, 0, beyond)}[axis]
        here = faces(axis, i + shift[0], j + shift[1], k + shift[2])
        patches.append((name, kind, here if beyond else here[:, ::-1], cell(i, j, k)))

    def put(name, kind, lines, count):
        (folder / name).write_text(foam_header(kind, name) + f"{count}\n(\n" + "\n".join(lines) + "\n)\n")

    whole = np.vstack([face] + [p[2] for p in patches])
    owners = np.concatenate([owner] + [p[3] for p in patches])
    put("points", "vectorField", ("(%.15g %.15g %.15g)" % tuple(p) for p in points), len(points))
    put("faces", "faceList", ("4(%d %d %d %d)" % tuple(f) for f in whole), len(whole))
    put("owner", "labelList", map(str, owners), len(owners))
    put("neighbour", "labelList", map(str, neighbour), len(neighbour))
    first, lines = len(face), []
    for name, kind, here, _ in patches:
        lines.append(f"{name} {{type {kind}; nFaces {len(here)}; startFace {first};}}")
        first += len(here)
    put("boundary", "polyBoundaryMesh", lines, len(patches))


def plate_error(folder, n):
    """Cell values: four points over the thickness, splines in (s, phi)."""
    nr, nt, nz = n
    text = (pathlib.Path(folder) / "1/D").read_text()
    first = text.index("\n(\n", text.index("nonuniform")) + 3
    values = text[first : text.index("\n)\n", first)].replace("(", " ").replace(")", " ").split()
    u = np.array(values, float).reshape(nz, nt, nr, 3)
    m = nz // 2
    middle = (-u[m - 2] + 9 * u[m - 1] + 9 * u[m] - u[m + 1]) / 16
    return error((np.arange(nr) + 0.5) / nr, (np.arange(nt) + 0.5) * np.pi / 2 / nt, middle.transpose(1, 0, 2))
