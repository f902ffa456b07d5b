#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The moved mesh, coloured by the edge ratio of its cells. Usage: plot.py [FOLDER of the participant] [PICTURE], by default out/mover."""
import pathlib
import sys

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

here = pathlib.Path(__file__).resolve().parent


def draw(axes, folder):
    """The last mesh of a series, triangles."""
    with h5py.File(next(folder.glob("*.h5"))) as file:
        last = file["steps"][sorted(file["steps"])[-1]]
        points, cells = last["coordinates"][...], file["mesh/cells"][...]
        ratio = last["cells/edge-ratio"][...].ravel()
    drawn = axes.tripcolor(points[:, 0], points[:, 1], cells.reshape(-1, 3), facecolors=ratio, cmap="viridis", vmin=1, vmax=4,
                           edgecolors="white", linewidth=0.15)
    axes.set_aspect("equal")
    axes.set_axis_off()
    return drawn, float(np.max(ratio))


if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here / "out" / "mover"
    picture = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else folder / "mesh.png"
    figure, axes = plt.subplots(figsize=(5, 5), dpi=150)
    drawn, worst = draw(axes, folder)
    figure.colorbar(drawn, ax=axes, label=f"edge ratio [-] (largest {worst:.2f})", shrink=0.8)
    figure.savefig(picture, bbox_inches="tight")
    print(picture)
