#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Shapes of the first modes of a plate, seen from above, with their frequencies.
Usage: plot.py [PICTURE.png [FOLDER]], by default out/plate-reed.png of the run in out/reed."""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parents[1] / "client/python"))
import couplet  # noqa: E402

TABLE_4_1 = [30.57, 129.3, 319.7, 980.6, 1039, 1545, 2039, 2288, 2702, 3738, 3828, 3925, 4147, 5412, 5443]  # thesis, Hz


def main():
    picture = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here / "out" / "plate-reed.png"
    folder = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else here / "out" / "reed"
    if not (folder / "modes-shapes.h5").exists():
        sys.exit(f"There are no modes in {folder}. Run the case first (see its README).")
    shapes = couplet.FieldSeries(folder / "modes-shapes.h5")
    frequency = couplet.read_csv(folder / "frequencies.csv")["frequency [Hz]"]
    points = shapes.coordinates(0)
    upper = points[:, 2] > 0.5 * points[:, 2].max()
    triangles = [c for c in shapes.cells if upper[c].all()]
    triangles = np.array([t for c in triangles for t in ([c[0], c[1], c[2]], *([[c[0], c[2], c[3]]] if len(c) == 4 else []))])
    n = min(15, len(frequency))
    figure, all_axes = plt.subplots(3, 5, figsize=(13, 6.4), dpi=120, constrained_layout=True)
    for axes in all_axes.flat[n:]:
        axes.axis("off")
    for i, axes in zip(range(n), all_axes.flat):
        w = shapes.field(i, "mode")[:, 2]
        axes.tripcolor(1e3 * points[:, 0], 1e3 * points[:, 1], triangles, w, cmap="RdBu_r", vmin=-1, vmax=1, shading="gouraud")
        axes.tricontour(1e3 * points[:, 0], 1e3 * points[:, 1], triangles, w, levels=[0], colors="black", linewidths=0.8)
        axes.set(aspect="equal")
        axes.set_title(f"{i + 1}: {frequency[i]:.1f} Hz (thesis {TABLE_4_1[i]:g})", fontsize=8)
        axes.tick_params(labelsize=6)
    figure.suptitle("modes of the reed valve: deflection over its largest value; black: nodal lines; mm", fontsize=10)
    figure.savefig(picture)
    error = frequency[:n] / np.array(TABLE_4_1[:n]) - 1
    print(f"against table 4.1: rms {100 * np.sqrt(np.mean(error ** 2)):.2f} %, worst {100 * np.abs(error).max():.2f} %")
    print(f"picture: {picture}")


main()
