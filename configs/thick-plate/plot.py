#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Deflection and bending stress at the centre over time against a p-FEM computation. Usage: plot.py [PICTURE.png], by
default out/thick-plate.png"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "client/python"))
import couplet  # noqa: E402

DEFLECTION, STRESS = "centre z [m]", "bottom stress-xx [Pa]"


def peaks(folder):
    """(time [s], deflection downwards [mm]) and (time [s], stress at the bottom [MPa]) of the first maximum of each."""
    probes = couplet.read_csv(pathlib.Path(folder) / "probes.csv")
    found = []
    for values in (-1e3 * probes[DEFLECTION], probes[STRESS] / 1e6):
        i = int(values.argmax())
        t = probes["time [s]"]
        near = slice(max(i - 2, 0), i + 3)
        a, b, c = np.polyfit(t[near] - t[i], values[near], 2)
        found.append((t[i] - b / (2 * a), c - b * b / (4 * a)))
    return found


def main():
    out, picture = couplet.result_of(HERE, "solid")
    probes = couplet.read_csv(out / "solid" / "probes.csv")
    wanted = np.loadtxt(HERE / "reference/rayleigh.csv", delimiter=",").T
    figure, axes = plt.subplots(1, 2, figsize=(11, 4), dpi=130, constrained_layout=True)
    for ax, ours, theirs, name in ((axes[0], -1e3 * probes[DEFLECTION], wanted[1], "deflection of the centre [mm]"),
                                   (axes[1], probes[STRESS] / 1e6, wanted[3], "stress xx at the bottom [MPa]")):
        ax.plot(1e3 * probes["time [s]"], ours, label="Couplet")
        ax.plot(1e3 * wanted[0], theirs, "ok", fillstyle="none", markersize=3, markevery=4, label="p-FEM")
        ax.set(xlabel="time [ms]", ylabel=name, xlim=(0, 1e3 * max(probes["time [s]"][-1], 1e-3)))
        ax.grid(alpha=0.3)
    axes[0].legend()
    figure.savefig(picture)
    (t, w), (_, s) = peaks(out / "solid")
    print(f"peak deflection {w:.3f} mm at {1e3 * t:.2f} ms (4.601 mm at 10.64 ms), peak stress {s:.2f} MPa (61.04 MPa)")
    print(f"picture: {picture}")


if __name__ == "__main__":
    main()
