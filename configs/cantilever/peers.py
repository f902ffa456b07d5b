# SPDX-License-Identifier: Apache-2.0
"""CalculiX on the same beam for the picture of scripts/study: (processor seconds, error of the deflection); omitted where it is not installed."""
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "client/python"), str(ROOT / "benchmarks/peers")]
import calculix_beam  # noqa: E402
from couplet.runs import launch  # noqa: E402
from runs import series  # noqa: E402

BEAM = calculix_beam.Beam(side=2.0, length=20.0, young=10e6, large=False)
FORCE, CONVERGED = 500.0, 0.10008  # [N]; [m]
LOAD = FORCE / (BEAM.young * BEAM.side**4 / 12 / BEAM.length**2)  # along the diagonal: small deflections of a square section are the same along a side
MESHES = {"C3D8": (2, 4, 8), "C3D8I": (2, 4, 8), "C3D20": (2, 4)}  # across; ten times as many along


def calculix(element):
    def run(folder, across):
        calculix_beam.write(folder / "beam.inp", across, 10 * across, element, LOAD, BEAM)
        seconds = launch(["ccx", "beam"], folder / "run.log", folder).cpu
        return seconds, abs(BEAM.length * calculix_beam.deflection(folder / "beam.dat", BEAM.length) / CONVERGED - 1)
    return run


def tip(folder):
    return series(folder, [(f"CalculiX {element}", "ccx", calculix(element), meshes) for element, meshes in MESHES.items()])
