# SPDX-License-Identifier: Apache-2.0
"""Static solid as an OpenFOAM case for solidDisplacementFoam, and its results."""
import pathlib

import numpy as np

from couplet.peers.foam_files import PolyMesh, foam_environment, last_time, one, put, read_field, values
from couplet.peers.results import of_cells, write_solid
from couplet.peers.values import field, refuse, vector

SIGMA = [0, 3, 5, 1, 4, 2]  # xx yy zz xy yz xz of OpenFOAM's xx xy xz yy yz zz
TOLERANCE = 1e-6  # of the outer iteration, relative


class SolidFoam:
    """OpenFOAM case of one solid (couplet.peers.solid)."""

    environment = staticmethod(foam_environment)

    def __init__(self, solid):
        self.solid = solid
        for patch, given in solid.boundaries.items():
            where = f"{solid.where}.boundaries.{patch}"
            if given.get("components"):
                refuse(f"{where}.components", "has no counterpart in solidDisplacementFoam")
            if given.get("traction"):
                refuse(f"{where}.traction", "has no counterpart in solidDisplacementFoam")
        if np.any(solid.gravity()):
            refuse(f"{solid.where}.gravity", "has no counterpart in solidDisplacementFoam")
        self.flat = solid.mesh(1)
        self.body = self.flat.extruded(self.flat.size()) if solid.dimension == 2 else self.flat
        for patch, given in solid.boundaries.items():  # only planes normal to an axis
            given["type"] in ("symmetry", "frictionless") and solid.normal_axis(self.flat, patch)
        self.faces = PolyMesh(
            self.body,
            {
                p: "symmetryPlane" if g["type"] in ("symmetry", "frictionless") else "patch"
                for p, g in solid.boundaries.items()
            },
        )

    def condition(self, patch, given):
        solid, middles = self.solid, self.faces.middles_of(patch) * ((1, 1, 0) if self.solid.dimension == 2 else 1)
        where, kind = f"{solid.where}.boundaries.{patch}.value", given["type"]
        if kind in ("symmetry", "frictionless"):
            return "type symmetryPlane;"
        if kind == "fixed-displacement":
            wanted = given.get('value') or [0] * solid.dimension
            return f"type fixedValue; value {values(vector(wanted, where, middles, solid.time, solid.dimension))};"
        pull, pressure = np.zeros((len(middles), 3)), np.zeros(len(middles))
        if kind == "pressure":
            pressure = field(given["value"], where, middles, solid.time)
        elif kind in ("traction", "force"):
            pull = vector(given["value"], where, middles, solid.time, solid.dimension)
            if kind == "force":
                pull = pull / sum(np.sum(q[2]) for q in solid.integrals(self.flat, patch))
        return (
            f"type tractionDisplacement; traction {values(pull)}; pressure {values(pressure)}; value uniform (0 0 0);"
        )

    def write(self, folder):
        """Writes all files of the case. Run it there with solidDisplacementFoam."""
        solid = self.solid
        self.faces.write(folder)
        patches = "\n".join(f"{p}{{{self.condition(p, g)}}}" for p, g in solid.boundaries.items()) + (
            " frontAndBack{type empty;}" if solid.dimension == 2 else ""
        )
        put(
            folder,
            "0/D",
            "volVectorField",
            f"dimensions [0 1 0 0 0 0 0]; internalField uniform (0 0 0);\nboundaryField{{{patches}}}",
        )
        put(
            folder,
            "constant/mechanicalProperties",
            "dictionary",
            "".join(
                f"{name}{{type uniform; value {one(v)};}} "
                for name, v in (("rho", solid.density), ("nu", solid.poisson), ("E", solid.young))
            )
            + f"planeStress {'yes' if solid.dimension == 2 and solid.plane == 'stress' else 'no'};",
        )
        put(
            folder,
            "constant/thermalProperties",
            "dictionary",
            (
                "C{type uniform; value 434;} k{type uniform; value 60.5;} alpha{type uniform; value 1e-5;}"
                " thermalStress no;"
            ),
        )
        put(
            folder,
            "system/fvSolution",
            "dictionary",
            (
                'solvers{"(D|T)"{solver GAMG; smoother GaussSeidel; nCellsInCoarsestLevel 20; tolerance 1e-12;'
                f' relTol 0.9;}}}}\nstressAnalysis{{compactNormalStress yes; nCorrectors 100000; D {TOLERANCE};}}'
            ),
        )
        put(
            folder,
            "system/fvSchemes",
            "dictionary",
            (
                "d2dt2Schemes{default steadyState;} ddtSchemes{default Euler;} gradSchemes{default"
                " leastSquares;}\ndivSchemes{default none; div(sigmaD) Gauss linear;} laplacianSchemes{default none;"
                " laplacian(DD,D) Gauss linear corrected; laplacian(DT,T) Gauss linear"
                " corrected;}\ninterpolationSchemes{default linear;} snGradSchemes{default none;}"
            ),
        )
        put(
            folder,
            "system/controlDict",
            "dictionary",
            (
                "application solidDisplacementFoam; startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT"
                " 1; writeControl timeStep; writeInterval 1; writeFormat ascii; writePrecision 10; timeFormat general;"
            ),
        )
        return ["solidDisplacementFoam"]

    def read(self, folder, out):
        """Writes the results in `folder` to the participant's folder `out` in the format of our programs."""
        last, count = last_time(folder), self.flat.count()
        u = np.array(read_field(last / "D", count))
        if (last / "sigma").exists():
            s = np.array(read_field(last / "sigma", count))[:, SIGMA]
        else:
            s = np.stack([read_field(last / f"sigma{c}", count) for c in ("xx", "yy", "zz", "xy", "yz", "xz")], axis=1)
        if not np.isfinite(u).all():
            raise ValueError("solidDisplacementFoam diverged: displacements are not finite")
        both = np.hstack([u, s])
        write_solid(pathlib.Path(out), self.flat, self.solid, both, of_cells(self.flat, both))
