# SPDX-License-Identifier: Apache-2.0
"""CalculiX and OpenFOAM on the same plate for the picture of scripts/study: (processor seconds, error of the displacement);
programs that are not installed are omitted."""
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "client/python"), str(ROOT / "benchmarks/peers")]
import calculix_plate  # noqa: E402
import openfoam_plate  # noqa: E402
from couplet.runs import launch  # noqa: E402
from runs import foam_environment, series  # noqa: E402

MESHES = ((4, 6, 3), (8, 12, 6), (16, 24, 12))


def foam(folder, n):
    openfoam_plate.write(folder, n, 1e-5, "GAMG", 0.9)
    env = foam_environment()
    cost = launch(["solidDisplacementFoam"], folder / "run.log", folder, env=env)
    return cost.cpu, float(openfoam_plate.plate_error(folder, n))


def calculix(element, solver):
    def run(folder, n):
        calculix_plate.write(folder / "plate.inp", n, element, solver)
        cost = launch(["ccx", "plate"], folder / "run.log", folder)
        return cost.cpu, float(calculix_plate.plate_error(folder / "plate.frd", n, element))
    return run


PEERS = (("CalculiX C3D8I", "ccx", calculix("C3D8I", "ITERATIVE CHOLESKY"), MESHES), ("CalculiX C3D20", "ccx", calculix("C3D20", "SPOOLES"), MESHES[:2]),
         ("solidDisplacementFoam", "solidDisplacementFoam", foam, MESHES))


def displacement(folder):
    return series(folder, PEERS)
