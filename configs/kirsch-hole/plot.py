#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Stress around the hole against Kirsch's solution. Usage: plot.py [PICTURE.png], by default out/kirsch-hole.png"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "client/python"))
import couplet  # noqa: E402

RADIUS, LOAD = 0.5, 1e6


def exact(x, y):
    """Stress xx, yy, xy [Pa]; Timoshenko and Goodier, Theory of Elasticity."""
    q, angle = RADIUS**2 / (x**2 + y**2), np.arctan2(y, x)
    c2, c4, s2, s4 = np.cos(2 * angle), np.cos(4 * angle), np.sin(2 * angle), np.sin(4 * angle)
    return LOAD * np.array([1 - q * (1.5 * c2 + c4) + 1.5 * q * q * c4, -q * (0.5 * c2 - c4) - 1.5 * q * q * c4,
                            -q * (0.5 * s2 + s4) + 1.5 * q * q * s4])


def main():
    out, picture = couplet.result_of(HERE, "solid")
    series = couplet.find_series(out / "solid")
    last = len(series.times) - 1
    points, centres = series.file["mesh/coordinates"][...], series.centres()
    stress = np.array([series.field(last, f"stress-{c}") for c in ("xx", "yy", "xy")])
    wanted = exact(centres[:, 0], centres[:, 1])
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), dpi=130, constrained_layout=True)
    map_ = PolyCollection([points[cell][:, :2] for cell in series.cells], array=stress[0] / 1e6, cmap="viridis")
    left.add_collection(map_)
    left.set(xlim=(0, 2), ylim=(0, 2), aspect="equal", xlabel="x [m]", ylabel="y [m]")
    figure.colorbar(map_, ax=left, label="stress xx [MPa]")
    edge = np.sort(np.unique(np.round(points[np.abs(points[:, 0]) < 1e-9][:, 1], 9)))
    near = centres[:, 0] < 0.06 * centres[:, 1]
    line = np.linspace(RADIUS, 2, 200)
    right.plot(line, exact(0 * line, line)[0] / 1e6, "k", label="Kirsch, x = 0")
    right.plot(centres[near, 1], stress[0, near] / 1e6, ".", label=f"cells along x = 0 ({len(edge) - 1} in a row)")
    right.set(xlabel="y [m]", ylabel="stress xx [MPa]")
    right.grid(alpha=0.3)
    right.legend()
    figure.savefig(picture)
    print(f"largest stress xx in a cell {stress[0].max() / LOAD:.3f} of the load (3 at the edge of the hole)")
    print(f"stress of the cells: root mean square error {100 * np.sqrt(np.mean((stress - wanted) ** 2)) / LOAD:.3f} % of the load")
    print(f"picture: {picture}")


main()
