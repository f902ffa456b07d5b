# SPDX-License-Identifier: Apache-2.0
"""Schumann's closed form beside a run: theta_s = int_0^eta exp(-xi - s) I0(2 sqrt(xi s)) ds, theta_f = theta_s +
exp(-xi - eta) I0(2 sqrt(xi eta)), T. E. W. Schumann, J. Franklin Inst. 208 (1929) 405."""
import pathlib

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.special import i0e

POROSITY, FLUID, GRAINS, SPECIFIC_HEAT, TRANSFER, FLUX = 0.4, 1800.0, 2500.0 * 900.0, 1500.0, 6000.0, 1.0
COLD, HOT = 300.0, 400.0


def kernel(xi, s):
    """exp(-xi - s) I0(2 sqrt(xi s))."""
    root = 2 * np.sqrt(xi * s)
    return i0e(root) * np.exp(root - xi - s)


def fluid(z, time):
    """Temperature of the fluid [K] at heights z [m] and a time [s]."""
    xi = TRANSFER * z / (FLUX * SPECIFIC_HEAT)
    eta = TRANSFER * (time - POROSITY * FLUID * z / FLUX) / ((1 - POROSITY) * GRAINS)
    theta = np.zeros_like(z)
    for i in np.nonzero(eta > 0)[0]:
        s = np.linspace(0, 1, 4001) ** 2 * eta[i]  # finer at 0, where sqrt(s) bends
        theta[i] = cumulative_trapezoid(kernel(xi[i], s), s)[-1] + kernel(xi[i], eta[i])
    return COLD + (HOT - COLD) * theta


def errors(folder):
    """Mean and largest difference of the fluid's last profile over the inlet's jump."""
    rows = np.genfromtxt(pathlib.Path(folder) / "bed.csv", delimiter=",", skip_header=1)
    last = rows[rows[:, 0] == rows[-1, 0]]
    gap = np.abs(last[:, 2] + 273.15 - fluid(last[:, 1], last[0, 0])) / (HOT - COLD)
    return {"fluid": gap.mean(), "largest": gap.max()}
