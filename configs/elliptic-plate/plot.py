#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Deflection and von Mises stress along x = y and on the circle r = 2.1 m at mid-thickness against a converged solution.
Usage: plot.py [PICTURE.png], by default out/elliptic-plate.png"""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from nine_points import HERE, Plate, errors, map_back, von_mises


def reference(file):
    return np.loadtxt(HERE / "reference" / file, delimiter=",").T


def main():
    out = HERE / "out"
    if not (out / "solid").exists():
        sys.exit(f"There is no result in {out}. Run the case first (see its README).")
    picture = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else out / "elliptic-plate.png"
    plate = Plate(out / "solid")
    figure, axes = plt.subplots(1, 3, figsize=(13, 4), dpi=130, constrained_layout=True)
    line, circle, paper = map(reference, ("line_x_equals_y.csv", "circle_2.1.csv", "circle_2.1_demirdzic.csv"))
    x = np.linspace(line[1, 0], line[1, -1], 200)
    s, _ = map_back(x, x)
    inner = x[(s >= plate.first_centre) & (s <= 1 - plate.first_centre)]  # values live at cell centres
    angle = np.linspace(0, 90, 200)
    on_circle = 2.1 * np.cos(np.radians(angle)), 2.1 * np.sin(np.radians(angle))
    curves = ((inner * np.sqrt(2), plate.displacement(inner, inner)[:, 2] * 1e6, line[0], line[4] * 1e6),
              (inner * np.sqrt(2), von_mises(plate.stress(inner, inner)) / 1e6, line[0], line[11]),
              (angle, von_mises(plate.stress(*on_circle)) / 1e6, circle[0], circle[1]))
    for ax, (place, ours, where, wanted) in zip(axes, curves):
        ax.plot(place, ours, label=f"Couplet, {plate.cells} cells")
        ax.plot(where, wanted, "ok", fillstyle="none", markersize=4, label="converged (p-FEM)")
        ax.grid(alpha=0.3)
    axes[2].plot(*paper, "+", color="tab:red", label="Demirdžić et al. 1997")
    axes[0].set(xlabel="r along x = y [m]", ylabel="deflection $u_z$ [µm]")
    axes[1].set(xlabel="r along x = y [m]", ylabel="von Mises stress [MPa]")
    axes[2].set(xlabel="angle on r = 2.1 m [°]", ylabel="von Mises stress [MPa]")
    axes[2].legend(fontsize=8)
    figure.savefig(picture)
    u, stress, cells = errors(out / "solid")
    print(f"{cells} cells: displacement {100 * u:.3f} %, von Mises stress {100 * stress:.3f} % at the nine points")
    print(f"picture: {picture}")


main()
