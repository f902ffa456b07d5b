# SPDX-License-Identifier: Apache-2.0
"""Differences [K] of the bed's last profile from that of a run of 4000 cells with the scheme of second order, which is made on first use."""
import functools
import pathlib
import subprocess
import tempfile

import numpy as np

from couplet.places import build

SETTINGS = ("simulation.end-time=21600", "simulation.output.interval=21600", *(f"participants.tank.{key}" for key in (
    "bed.cells=4000", "bed.advection=tvd", "bed.courant=0.5", "exchange-step=60")))


def profile(folder):
    rows = np.genfromtxt(pathlib.Path(folder) / "bed.csv", delimiter=",", skip_header=1)
    return rows[rows[:, 0] == rows[-1, 0], 1:3].T


@functools.cache
def reference():
    case = pathlib.Path(__file__).resolve().parent / "case.yaml"
    with tempfile.TemporaryDirectory(prefix="couplet-reference-") as folder:
        subprocess.run([pathlib.Path(build()) / "bin" / "thermocline", case, *(f"--set={s}" for s in (*SETTINGS, f"simulation.output.folder={folder}"))],
                       check=True, capture_output=True)
        return profile(f"{folder}/tank")


def errors(folder):
    z, fluid = profile(folder)
    gap = np.abs(fluid - np.interp(z, *reference()))
    return {"mean": gap.mean(), "largest": gap.max()}
