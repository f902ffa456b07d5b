# SPDX-License-Identifier: Apache-2.0
"""Runs for scripts/couplet accuracy: schemes, cells and steps of the bed after six hours of the first charge, against 4000 cells
of the scheme of second order."""
import functools
import pathlib
import subprocess
import tempfile

import numpy as np

PROGRAM = "thermocline"
TITLE = "Solar One, bed after 6 h of the first charge"
HERE = pathlib.Path(__file__).resolve().parent
TANK = "participants.tank."


def run(cells, advection, exchange=60, courant=0.5):
    return {TANK + "bed.cells": cells, TANK + "bed.advection": advection, TANK + "bed.courant": courant,
            TANK + "exchange-step": exchange, "simulation.end-time": 21600, "simulation.output.interval": 21600}


CELLS = (125, 250, 500, 1000)
SERIES = {
    "upwind, half the limit": {f"{n} cells": run(n, "upwind") for n in CELLS},
    "upwind, 0.28 of the limit (thesis)": {f"{n} cells": run(n, "upwind", courant=0.28) for n in CELLS},
    "tvd": {f"{n} cells": run(n, "tvd") for n in CELLS},
    "implicit, 60 s": {f"{n} cells": run(n, "implicit") for n in CELLS},
    "implicit, as long as gas and ground allow": {f"{n} cells": run(n, "implicit", 900) for n in CELLS},
}


def profile(folder):
    rows = np.genfromtxt(pathlib.Path(folder) / "tank" / "bed.csv", delimiter=",", skip_header=1)
    last = rows[rows[:, 0] == rows[-1, 0]]
    return last[:, 1], last[:, 2]


@functools.cache
def reference():
    program = next(p for p in (HERE.parents[1] / "build" / "bin").glob(PROGRAM))
    with tempfile.TemporaryDirectory(prefix="couplet-reference-") as folder:
        settings = run(4000, "tvd") | {"simulation.output.folder": folder}
        subprocess.run([program, HERE / "case.yaml", *(f"--set={k}={v}" for k, v in settings.items())], check=True,
                       capture_output=True)
        return profile(folder)


def errors(folder):
    z, fluid = profile(folder)
    gap = np.abs(fluid - np.interp(z, *reference()))
    return {"mean difference [K]": gap.mean(), "largest difference [K]": gap.max()}
