# SPDX-License-Identifier: Apache-2.0
"""CalculiX on the same plate, held in the same strip, for the picture of scripts/couplet study: (processor seconds, error of the stress
at D); omitted where it is not installed."""
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "client/python"), str(ROOT / "benchmarks/peers")]
import calculix_plate  # noqa: E402
from couplet.runs import launch  # noqa: E402
from runs import series  # noqa: E402

STRESS = -5.38e6  # [Pa], yy at D
MESHES = {"C3D8I": ((4, 6, 24), (8, 12, 24), (16, 24, 24)), "C3D20": ((4, 6, 24), (8, 12, 24))}


def calculix(element):
    def run(folder, n):
        calculix_plate.write(folder / "plate.inp", n, element, "SPOOLES", le10=True)
        seconds = launch(["ccx", "plate"], folder / "run.log", folder).cpu
        number, _ = calculix_plate.numbers(n, element)
        return seconds, abs(calculix_plate.stress_at(folder / "plate.frd", number[0, 0, -1], 1) / STRESS - 1)
    return run


def stress(folder):
    return series(folder, [(f"CalculiX {element}", "ccx", calculix(element), meshes) for element, meshes in MESHES.items()])
