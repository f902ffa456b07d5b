#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Frequency and decay of a spring-mounted cylinder let go in fluid at rest, beside Stokes' solution of an oscillating cylinder.
Usage: decay.py body.csv [MASS STIFFNESS DENSITY VISCOSITY]

On a cylinder of radius a that moves as exp(s t) in fluid without boundaries acts, a metre of depth (Stokes 1851; Rosenhead,
Laminar Boundary Layers, VII.8), F = -rho pi a^2 s^2 y (1 + 4 K_1(z) / (z K_0(z))), z = a sqrt(s / nu); so s is the root of
m s^2 + k + rho pi a^2 s^2 (1 + 4 K_1(z) / (z K_0(z))) = 0."""
import sys

import numpy as np
from scipy.optimize import least_squares
from scipy.special import kv


def stokes(mass, stiffness, density, viscosity, radius=0.5):
    """Returns (circular frequency [rad/s], rate of decay [1/s]) of the free motion."""
    def residual(x):
        s = complex(-x[1], x[0])
        z = radius * np.sqrt(s * density / viscosity)
        fluid = density * np.pi * radius**2 * (1 + 4 * kv(1, z) / (z * kv(0, z)))
        value = (mass + fluid) * s * s + stiffness
        return [value.real, value.imag]
    start = np.sqrt(stiffness / (mass + density * np.pi * radius**2))
    return least_squares(residual, [start, 0.1 * start], xtol=1e-14, ftol=1e-14, gtol=1e-14).x


def fitted(time, y, omega, decay):
    """Fits a record y(t) = exp(-decay t) (A cos omega t + B sin omega t) + C."""
    def parts(x):
        e = np.exp(-x[1] * (time - time[0]))
        basis = np.column_stack([e * np.cos(x[0] * time), e * np.sin(x[0] * time), np.ones_like(time)])
        return basis @ np.linalg.lstsq(basis, y, rcond=None)[0] - y
    return least_squares(lambda x: parts(x) / np.abs(y).max(), [omega, decay]).x


if __name__ == "__main__":
    numbers = [float(a) for a in sys.argv[2:]] or [2, 4, 1, 0.01]
    omega, decay = stokes(*numbers)
    time, y = np.loadtxt(sys.argv[1], delimiter=",", usecols=(0, 1), unpack=True)
    late = time > 2 * np.pi / omega  # the first period remembers how it was let go
    w, d = fitted(time[late], y[late], omega, decay)
    print(f"frequency {w:.5f} rad/s, Stokes {omega:.5f}: {100 * (w / omega - 1):+.2f} %")
    print(f"decay     {d:.5f} 1/s, Stokes {decay:.5f}: {100 * (d / decay - 1):+.2f} %")
