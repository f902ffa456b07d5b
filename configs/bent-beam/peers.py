# SPDX-License-Identifier: Apache-2.0
"""CalculiX on the same beam for the picture of scripts/couplet study: (processor seconds, error of the deflection); omitted where it is not installed."""
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "client/python"), str(ROOT / "benchmarks/peers")]
import calculix_beam  # noqa: E402
from couplet.runs import launch  # noqa: E402
from runs import series  # noqa: E402

LOAD, CONVERGED = 1.6, 0.431338  # K; deflection over the length
MESHES = {"C3D8": ((2, 20), (4, 40), (8, 80)), "C3D8I": ((2, 20), (4, 40), (8, 80)), "C3D20": ((2, 10), (2, 20), (4, 40))}


def median_of(run, times=3):
    """Returns the run with the median time, for short runs."""
    first = run()
    return first if first[0] > 0.6 else sorted([first, *(run() for _ in range(times - 1))])[times // 2]


def calculix(element):
    def run(folder, mesh):
        calculix_beam.write(folder / "beam.inp", *mesh, element, LOAD)

        def one():
            seconds = launch(["ccx", "beam"], folder / "run.log", folder).cpu
            return seconds, abs(calculix_beam.deflection(folder / "beam.dat") / CONVERGED - 1)
        return median_of(one)
    return run


def deflection(folder):
    return series(folder, [(f"CalculiX {element}", "ccx", calculix(element), meshes) for element, meshes in MESHES.items()])
