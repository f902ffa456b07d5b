#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Coefficients of Morison's equation, F = -rho D c_d |U| U / 2 - pi rho D^2 c_m dU/dt / 4, fitted to the force in line over the last
periods (U: velocity of the cylinder, x = -A sin(2 pi f t)). Usage: morison.py [FOLDER of the participant], by default out/fluid."""
import pathlib
import sys

import numpy as np

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parents[1] / "client/python"))
import couplet  # noqa: E402

FREQUENCY, PERIODS = 0.2, 2


def last_periods(folder):
    """Phase 2 pi f t in the middle of each step of the last periods, and F / (rho U^2 D) with U = A omega = D = 1."""
    rows = couplet.read_csv(folder / "coefficients.csv")
    t = rows["time [s]"]
    last = t > t[-1] - PERIODS / FREQUENCY + 1e-9
    return 2 * np.pi * FREQUENCY * (t[last] - (t[1] - t[0]) / 2), rows["cylinder drag [-]"][last] / 2


def averages(folder):
    """c_d, c_m by Fourier averages (Keulegan and Carpenter): 3/4 and 2 KC / pi^3 times the integrals of F / (rho U^2 D) against the
    phases of velocity and acceleration over a period."""
    phase, force = last_periods(folder)
    step = 2 * np.pi * PERIODS / len(phase) / PERIODS
    return 0.75 * float(np.sum(force * np.cos(phase)) * step), -2 * 5 / np.pi**3 * float(np.sum(force * np.sin(phase)) * step)


def fit(folder):
    """c_d, c_m by least squares, and what the fit leaves of the force (root mean square over its own)."""
    phase, force = last_periods(folder)
    speed, omega = -np.cos(phase), 2 * np.pi * FREQUENCY
    columns = np.column_stack([-np.abs(speed) * speed / 2, -np.pi / 4 * omega * np.sin(phase)])
    values, *_ = np.linalg.lstsq(columns, force, rcond=None)
    return float(values[0]), float(values[1]), float(np.linalg.norm(columns @ values - force) / np.linalg.norm(force))


if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here / "out" / "fluid"
    print("Fourier averages: c_d = {:.4f} (2.09), c_m = {:.4f} (1.45)".format(*averages(folder)))
    print("least squares:    c_d = {:.4f}, c_m = {:.4f}, leaving {:.3f} of the force".format(*fit(folder)))
