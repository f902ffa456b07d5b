#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Drag, lift and Strouhal number from forces.csv, pressure difference from probes.csv.
Usage: coefficients.py [FOLDER of the participant] [--mean-speed 1], by default out/fluid."""
import argparse
import pathlib
import sys

import numpy as np

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parents[1] / "client/python"))
import couplet  # noqa: E402

DIAMETER = 0.1


def force(rows, patches, axis):
    return sum(rows[f"{patch} {part} {axis} [N]"] for patch in patches for part in ("pressure", "viscous"))


def rises(t, y):
    """Times at which y passes its mean upwards."""
    y = y - (y.max() + y.min()) / 2
    i = np.nonzero((y[:-1] < 0) & (y[1:] >= 0))[0]
    return t[i] - y[i] * (t[i + 1] - t[i]) / (y[i + 1] - y[i])


def peak(t, y):
    """Largest value, by the parabola through the three points about it."""
    i = int(np.argmax(y))
    if not 0 < i < len(y) - 1:
        return float(y[i])
    a, b, c = np.polyfit(t[i - 1 : i + 2] - t[i], y[i - 1 : i + 2], 2)
    return float(c - b * b / (4 * a)) if a != 0 else float(c)


def mean_and_amplitude(t, y):
    """Returns half of the sum and half of the difference of the largest and the smallest value."""
    high, low = peak(t, y), -peak(t, -y)
    return (high + low) / 2, (high - low) / 2


def frequency(t, y):
    """Returns the frequency at which y rises through its mean [1/s]; 0 if it does so less than twice."""
    z = rises(t, y)
    return (len(z) - 1) / (z[-1] - z[0]) if len(z) > 1 else 0.0


def steady(folder, mean_speed):
    """Last values: drag, lift, pressure difference between front and back [Pa]."""
    rows, probes = couplet.read_csv(folder / "forces.csv"), couplet.read_csv(folder / "probes.csv")
    scale = 2 / (mean_speed**2 * DIAMETER)
    return {"cd": scale * force(rows, ["cylinder"], "x")[-1], "cl": scale * force(rows, ["cylinder"], "y")[-1],
            "dp": float((probes["front pressure [Pa]"] - probes["back pressure [Pa]"])[-1])}


def periodic(folder, mean_speed, last=1.5):
    """Over the whole cycles of the last seconds."""
    rows = couplet.read_csv(folder / "forces.csv")
    t, scale = rows["time [s]"], 2 / (mean_speed**2 * DIAMETER)
    cd, cl = scale * force(rows, ["cylinder"], "x"), scale * force(rows, ["cylinder"], "y")
    end = t > t[-1] - last
    z = rises(t[end], cl[end])
    if len(z) < 2:
        raise ValueError(f"the lift does not oscillate in the last {last} s")
    m = (t > z[0]) & (t <= z[-1] + t[1])
    return {"cd_max": peak(t[m], cd[m]), "cl_max": peak(t[m], cl[m]), "cl_min": -peak(t[m], -cl[m]),
            "St": DIAMETER / (mean_speed * (z[-1] - z[0]) / (len(z) - 1))}


def mean_02(folder):
    """For scripts/couplet study: the steady flow of mean speed 0.2 m/s."""
    return steady(folder, 0.2)


def street(folder):
    """For scripts/couplet study: the vortex street of mean speed 1 m/s."""
    return periodic(folder, 1)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?", type=pathlib.Path, default=here / "out" / "fluid")
    parser.add_argument("--mean-speed", type=float, default=1)
    arguments = parser.parse_args()
    results = steady if arguments.mean_speed < 0.5 else periodic
    for name, value in results(arguments.folder, arguments.mean_speed).items():
        print(f"{name} = {value:.5f}")
