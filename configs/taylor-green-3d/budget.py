#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Dissipation of the Taylor-Green vortex from energy.csv. Usage: budget.py [FOLDER of the participant], by default out/fluid."""
import pathlib
import sys

import numpy as np

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parents[1] / "client/python"))
import couplet  # noqa: E402


def budget(folder):
    """Time and height of the peak of -dk/dt, and of the energy lost: the part that the pressure takes, the part that
    viscosity, eddies and pressure leave unexplained."""
    rows = couplet.read_csv(folder / "energy.csv")
    volume = 8 * rows["kinetic energy [J]"][0]  # of the box or of a part of it: the vortex begins with 1/8 m^2/s^2 in the mean
    t, k = rows["time [s]"], rows["kinetic energy [J]"] / volume
    power = (rows["viscous power [W]"] + rows["eddy power [W]"] + rows["pressure power [W]"]) / volume
    work = rows["pressure power [W]"] / volume
    loss = -np.gradient(k, t)
    i = int(np.argmax(loss))
    explained = np.sum(0.5 * (power[1:] + power[:-1]) * np.diff(t))
    return {"peak_time": float(t[i]), "peak": float(loss[i]), "pressure_share": float(np.sum(0.5 * (work[1:] + work[:-1]) * np.diff(t)) / (k[0] - k[-1])),
            "unexplained": float(1 - explained / (k[0] - k[-1]))}


if __name__ == "__main__":
    for name, value in budget(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here / "out" / "fluid").items():
        print(f"{name} = {value:.5f}")
