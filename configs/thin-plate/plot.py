#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Tip of the thin plate as modes (out/plate) and as a volume (out/solid), and the flow about it when it is bent most.
Usage: plot.py [PICTURE.png], by default out/thin-plate.png."""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parents[1] / "client/python"))
import couplet  # noqa: E402


def draw_flow(figure, axes, fluid, plate, when):
    """Speed in the cells that the plane z = 0 cuts, and the skin of the plate."""
    i = fluid.nearest(when)
    points, velocity = fluid.coordinates(i), fluid.field(i, "velocity")
    reference = fluid.centres()
    layer = np.abs(reference[:, 2]).min() + 1e-9
    polygons, speed = [], []
    for c, cell in enumerate(fluid.cells):
        if not 0 <= reference[c, 2] <= layer:
            continue
        corners = points[cell]
        near = corners[np.argsort(corners[:, 2])[:4], :2]
        middle = near.mean(axis=0)
        polygons.append(near[np.argsort(np.arctan2(near[:, 1] - middle[1], near[:, 0] - middle[0]))])
        speed.append(np.linalg.norm(velocity[c]))
    cells = PolyCollection(polygons, array=np.array(speed), cmap="viridis", edgecolors="black", linewidths=0.15)
    axes.add_collection(cells)
    skin = plate.coordinates(plate.nearest(fluid.times[i]))
    axes.add_collection(PolyCollection([skin[c, :2] for c in plate.cells], facecolors="tab:red", edgecolors="none"))
    axes.set(xlim=(-1.5, 3), ylim=(0, 2.5), aspect="equal", xlabel="x [m]", ylabel="y [m]",
             title=f"speed in the middle plane at t = {fluid.times[i]:.2f} s")
    figure.colorbar(cells, ax=axes, label="|u| [m/s]", shrink=0.8)


def main():
    out = here / "out" / "plate"
    if not (out / "structure" / "probes.csv").exists():
        sys.exit(f"There is no result in {out}. Run the case first: configs/thin-plate/run plate.")
    picture = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here / "out" / "thin-plate.png"
    figure, (left, right) = plt.subplots(1, 2, figsize=(13, 4.4), dpi=130, constrained_layout=True)
    first = None
    for folder, label, style in ((out, "plate_modal, 15 modes", "-"), (here / "out" / "solid", "solid_solver", "--")):
        if not (folder / "structure" / "probes.csv").exists():
            continue
        rows = couplet.read_csv(folder / "structure" / "probes.csv")
        left.plot(rows["time [s]"], rows["tip x [m]"], style, label=label)
        tops = [(t, x) for t, x, kind in couplet.extrema(rows["time [s]"], rows["tip x [m]"]) if kind == "max"]
        print(f"{label}: maxima of the tip", ", ".join(f"{x:.4f} m at {t:.3f} s" for t, x in tops))
        first = first or (tops[0][0] if tops else rows["time [s]"][-1])
    left.set(xlabel="time [s]", ylabel="displacement x of the tip [m]")
    left.grid(alpha=0.3)
    left.legend(fontsize=8)
    draw_flow(figure, right, couplet.find_series(out / "fluid"), couplet.find_series(out / "structure"), first)
    figure.savefig(picture)
    print(f"picture: {picture}")


main()
