# SPDX-License-Identifier: Apache-2.0
"""Channel flow past a cylinder for OpenFOAM (version 1912), Re = 100: blocks of hexahedra around the cylinder, 24 330
cells. At rest for icoFoam; swinging across the stream, with mesh motion by displacementLaplacian, for pimpleFoam."""
from math import pi, sqrt

from runs import put_foam

RADIAL, QUARTER = 48, 40  # cells from the cylinder to the square around it, on a quarter of the cylinder
RADIUS, CENTRE, HALF, DEPTH = 0.05, 0.2, 0.12, 0.01


def points():
    x, y, q = [0, CENTRE - HALF, CENTRE + HALF, 2.2], [0, CENTRE - HALF, CENTRE + HALF, 0.41], RADIUS / sqrt(2)
    flat = [(a, b) for b in y for a in x] + [(CENTRE + i * q, CENTRE + j * q) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return [(*p, z) for z in (0, DEPTH) for p in flat], y


def block_mesh():
    """Text of blockMeshDict, number of cells, inlet speeds cell by cell."""
    vertices, y = points()
    nx = [QUARTER * 3 // 4, QUARTER, QUARTER * 9 // 2]
    ny = [int(QUARTER * 0.42), QUARTER, int(QUARTER * 0.42) + 1]
    at, square, ring, up = (lambda i, j: 4 * j + i), (5, 6, 10, 9), (16, 17, 18, 19), 20

    def block(corners, n, grading):
        every = " ".join(str(c) for c in (*corners, *(c + up for c in corners)))
        return f"hex ({every}) ({n[0]} {n[1]} 1) simpleGrading ({grading})\n"

    def sides(pairs):
        return " ".join(f"({a} {b} {b + up} {a + up})" for a, b in pairs)

    text = "".join(block((square[m], square[(m + 1) % 4], ring[(m + 1) % 4], ring[m]), (QUARTER, RADIAL), "1 0.1667 1")
                   for m in range(4))
    cells = 4 * QUARTER * RADIAL
    for j in range(3):
        for i in range(3):
            if (i, j) != (1, 1):
                text += block((at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)), (nx[i], ny[j]), f"{(1, 1, 4)[i]} 1 1")
                cells += nx[i] * ny[j]
    arcs = "".join(f"arc {ring[m] + k} {ring[(m + 1) % 4] + k} ({CENTRE + RADIUS * a} {CENTRE + RADIUS * b} {z})\n"
                   for k, z in ((0, 0), (up, DEPTH)) for m, (a, b) in enumerate(((0, -1), (1, 0), (0, 1), (-1, 0))))
    walls = sides((at(i, 0), at(i + 1, 0)) for i in range(3)) + " " + sides((at(i + 1, 3), at(i, 3)) for i in range(3))
    patches = (("inlet", "patch", sides((at(0, j + 1), at(0, j)) for j in range(3))),
               ("outlet", "patch", sides((at(3, j), at(3, j + 1)) for j in range(3))),
               ("walls", "wall", walls), ("cylinder", "wall", sides((ring[m], ring[(m + 1) % 4]) for m in range(4))))
    boundary = "".join(f"{name}{{type {kind};faces ({faces});}}\n" for name, kind, faces in patches)
    speeds = []
    for j in range(3):
        for k in range(ny[j]):
            h = y[j] + (k + 0.5) * (y[j + 1] - y[j]) / ny[j]
            speeds.append(6 * h * (0.41 - h) / 0.41**2)
    corners = "\n".join(f"({a:.12g} {b:.12g} {c:.12g})" for a, b, c in vertices)
    return (f"scale 1;\nvertices (\n{corners}\n);\nblocks (\n{text});\nedges (\n{arcs});\nboundary (\n{boundary});\n"
            "defaultPatch{name frontAndBack;type empty;}\nmergePatchPairs ();"), cells, speeds


def flow(case, start, cylinder):
    """Mesh, velocity and pressure at t = 0; gives the number of cells."""
    mesh, cells, speeds = block_mesh()
    put_foam(case, "system/blockMeshDict", "dictionary", mesh)
    inlet = f"nonuniform List<vector> {len(speeds)}({' '.join(f'({s:.9g} 0 0)' for s in speeds)})"
    put_foam(case, "0/U", "volVectorField", f"""dimensions [0 1 -1 0 0 0 0]; internalField uniform ({start} 0);
boundaryField{{inlet{{type fixedValue;value {inlet};}} outlet{{type zeroGradient;}} walls{{type noSlip;}}
cylinder{{{cylinder}}} frontAndBack{{type empty;}}}}""")
    put_foam(case, "0/p", "volScalarField", """dimensions [0 2 -2 0 0 0 0]; internalField uniform 0;
boundaryField{inlet{type zeroGradient;} outlet{type fixedValue;value uniform 0;} walls{type zeroGradient;}
cylinder{type zeroGradient;} frontAndBack{type empty;}}""")
    return cells


def write_resting(case, dt, end, tolerance):
    """All files of the case at rest (2D-2 of Schaefer and Turek) for icoFoam, forces in every step; gives the number of
    cells."""
    cells = flow(case, "1 0.2", "type noSlip;")
    put_foam(case, "constant/transportProperties", "dictionary", "nu [0 2 -1 0 0 0 0] 0.001;")
    put_foam(case, "system/fvSolution", "dictionary", f"""solvers{{p{{solver GAMG;smoother GaussSeidel;tolerance {tolerance};relTol 0.05;}}
pFinal{{$p;relTol 0;}} U{{solver smoothSolver;smoother symGaussSeidel;tolerance 1e-6;relTol 0;}}}}
PISO{{nCorrectors 2;nNonOrthogonalCorrectors 0;}}""")
    put_foam(case, "system/fvSchemes", "dictionary", """ddtSchemes{default backward;} gradSchemes{default Gauss linear;}
divSchemes{default none;div(phi,U) Gauss linear;} laplacianSchemes{default Gauss linear corrected;}
interpolationSchemes{default linear;} snGradSchemes{default corrected;}""")
    put_foam(case, "system/controlDict", "dictionary", f"""application icoFoam; startFrom startTime; startTime 0;
stopAt endTime; endTime {end}; deltaT {dt}; writeControl runTime; writeInterval {end}; writeFormat binary;
timeFormat general; timePrecision 8; runTimeModifiable false;
functions{{forces{{type forces;libs (forces);patches (cylinder);rho rhoInf;rhoInf 1;CofR (0 0 0);log false;
writeControl timeStep;writeInterval 1;}}}}""")
    return cells


def write(case, dt, steps, tolerance):
    """All files of the case; gives the number of cells."""
    cells = flow(case, "1 0", "type movingWallVelocity;value uniform (0 0 0);")
    still = "type fixedValue;value uniform (0 0 0);"
    put_foam(case, "0/pointDisplacement", "pointVectorField", f"""dimensions [0 1 0 0 0 0 0]; internalField uniform (0 0 0);
boundaryField{{inlet{{{still}}} outlet{{{still}}} walls{{{still}}} frontAndBack{{type empty;}}
cylinder{{type oscillatingDisplacement;amplitude (0 0.02 0);omega {4 * pi:.10g};value uniform (0 0 0);}}}}""")
    put_foam(case, "constant/dynamicMeshDict", "dictionary", """dynamicFvMesh dynamicMotionSolverFvMesh;
motionSolverLibs (fvMotionSolvers); solver displacementLaplacian;
displacementLaplacianCoeffs{diffusivity inverseDistance (cylinder);}""")
    put_foam(case, "constant/transportProperties", "dictionary", "transportModel Newtonian; nu 0.001;")
    put_foam(case, "constant/turbulenceProperties", "dictionary", "simulationType laminar;")
    put_foam(case, "system/fvSolution", "dictionary", f"""solvers{{"(p|pcorr)"{{solver GAMG;smoother GaussSeidel;tolerance {tolerance};relTol 0.05;}}
"(pFinal|pcorrFinal)"{{$p;relTol 0;}} "U.*"{{solver smoothSolver;smoother symGaussSeidel;tolerance 1e-6;relTol 0;}}
"cellDisplacement.*"{{solver PCG;preconditioner DIC;tolerance 1e-7;relTol 1e-3;}}}}
PIMPLE{{nOuterCorrectors 1;nCorrectors 2;nNonOrthogonalCorrectors 0;correctPhi no;checkMeshCourantNo no;}}""")
    put_foam(case, "system/fvSchemes", "dictionary", """ddtSchemes{default backward;} gradSchemes{default Gauss linear;}
divSchemes{default none;div(phi,U) Gauss linear;div((nuEff*dev2(T(grad(U))))) Gauss linear;}
laplacianSchemes{default Gauss linear corrected;} interpolationSchemes{default linear;} snGradSchemes{default corrected;}""")
    put_foam(case, "system/controlDict", "dictionary", f"""application pimpleFoam; startFrom startTime; startTime 0;
stopAt endTime; endTime {steps * dt:.10g}; deltaT {dt}; writeControl timeStep; writeInterval {steps}; writeFormat binary;
timeFormat general; timePrecision 8; runTimeModifiable false;""")
    return cells
