# SPDX-License-Identifier: Apache-2.0
"""Runs for scripts/couplet accuracy: schemes, cells and steps through the first five days of case A, against 3200 cells of the scheme
of second order. Long exchange steps also show what the plant's and the wall's explicit coupling costs."""
import csv
import functools
import pathlib
import subprocess
import tempfile

import numpy as np

PROGRAM = "thermocline"
TITLE = "Case A, bed after five days under the plant"
HERE = pathlib.Path(__file__).resolve().parent
TANK = "participants.tank."
DAYS = 5


def run(cells, advection, exchange=900, courant=0.5):
    return {TANK + "bed.cells": cells, TANK + "bed.advection": advection, TANK + "bed.courant": courant,
            TANK + "exchange-step": exchange, TANK + "report.run-in": "1 day", "simulation.end-time": f"{DAYS} day",
            "simulation.output.interval": f"{DAYS} day"}


CELLS = (200, 400, 800, 1600)
SERIES = {
    "upwind (thesis: 800 cells)": {f"{n} cells": run(n, "upwind") for n in CELLS},
    "tvd": {f"{n} cells": run(n, "tvd") for n in CELLS},
    "implicit, 60 s": {f"{n} cells": run(n, "implicit", 60) for n in CELLS},
    "implicit, plant asked every 120 s": {f"{n} cells": run(n, "implicit") for n in CELLS},
}


def results(folder):
    """Heights and fluid of the last profile, thermal efficiency [%]."""
    tank = pathlib.Path(folder) / "tank"
    rows = np.genfromtxt(tank / "bed.csv", delimiter=",", skip_header=1)
    last = rows[rows[:, 0] == rows[-1, 0]]
    with open(tank / "summary.csv", newline="") as file:
        summary = {row["quantity"]: float(row["value"]) for row in csv.DictReader(file)}
    return last[:, 1], last[:, 2], summary["eta_th"]


@functools.cache
def reference():
    program = HERE.parents[1] / "build" / "bin" / PROGRAM
    with tempfile.TemporaryDirectory(prefix="couplet-reference-") as folder:
        settings = run(3200, "tvd", 60) | {"simulation.output.folder": folder}
        subprocess.run([program, HERE / "case.yaml", *(f"--set={k}={v}" for k, v in settings.items())], check=True,
                       capture_output=True)
        return results(folder)


def errors(folder):
    z, fluid, eta = results(folder)
    z0, fluid0, eta0 = reference()
    return {"mean difference [K]": np.abs(fluid - np.interp(z, z0, fluid0)).mean(), "efficiency off by [points]": abs(eta - eta0)}
