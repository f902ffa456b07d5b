#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Picture of the run in out/: tip displacement over the published extrema, and the flow when the flap is bent most.
Usage: plot.py [PICTURE.png], by default out/perpendicular-flap.png."""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parents[1] / "client/python"))
import couplet  # noqa: E402


def reference():
    """Extrema of the four published solvers: name -> (times, values)."""
    lines = (here / "reference/flap_precice_digitised.csv").read_text().splitlines()
    rows = [line.split(",") for line in lines if line and not line.startswith("#")]
    curves = {}
    for column in (2, 3, 4):  # SU2 solves another (compressible) set-up
        points = [(float(r[1]), float(r[column])) for r in rows[1:] if r[column]]
        curves[rows[0][column][3:].replace("_", " + ")] = np.array(points).T
    return curves


def draw_tip(axes, time, tip):
    axes.plot(time, tip, color="tab:blue", label="Couplet")
    for (name, (t, x)), marker in zip(reference().items(), "ox+"):
        axes.plot(t, x, marker, color="black", fillstyle="none", label=f"preCICE: {name} (digitised extrema)")
    for t, x, kind in couplet.extrema(time, tip):
        if kind == "max":
            axes.annotate(f"{x:.3f} m\n{t:.2f} s", (t, x), textcoords="offset points", xytext=(0, 16), ha="center",
                          fontsize=7)
    axes.set(xlabel="time [s]", ylabel="tip displacement x [m]", ylim=(-0.03, 0.29), xlim=(0, max(5, time[-1])))
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7, loc="upper right", ncol=1)


def draw_flow(figure, axes, fluid, solid, when):
    i = fluid.nearest(when)
    points, velocity = fluid.coordinates(i), fluid.field(i, "velocity")
    cells = PolyCollection([points[c, :2] for c in fluid.cells], array=np.linalg.norm(velocity, axis=1),
                           cmap="viridis", edgecolors="face", linewidths=0.1)
    axes.add_collection(cells)
    mesh = PolyCollection([points[c, :2] for c in fluid.cells], facecolors="none", edgecolors="black", linewidths=0.05,
                          alpha=0.35)
    axes.add_collection(mesh)
    axes.add_collection(LineCollection(points[fluid.edges_on_boundary()][:, :, :2], colors="black", linewidths=0.8))
    j = solid.nearest(fluid.times[i])
    body = solid.coordinates(j)
    axes.add_collection(PolyCollection([body[c, :2] for c in solid.cells], facecolors="tab:red", edgecolors="none"))
    axes.set(xlim=(-1.5, 3), ylim=(0, 2.5), aspect="equal", xlabel="x [m]", ylabel="y [m]",
             title=f"velocity at t = {fluid.times[i]:.2f} s (about the first maximum)")
    figure.colorbar(cells, ax=axes, label="|u| [m/s]", shrink=0.85)


def main():
    out = here / "out"
    if not (out / "solid" / "probes.csv").exists():
        sys.exit(f"There is no result in {out}. Run the case first: scripts/demo.")
    picture = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else out / "perpendicular-flap.png"
    probes = couplet.read_csv(out / "solid" / "probes.csv")
    time, tip = probes["time [s]"], probes["tip x [m]"]
    first = next((t for t, _, kind in couplet.extrema(time, tip) if kind == "max"), time[-1])
    figure, (left, right) = plt.subplots(1, 2, figsize=(14, 4.6), dpi=130, width_ratios=(1, 1.25),
                                         constrained_layout=True)
    draw_tip(left, time, tip)
    draw_flow(figure, right, couplet.find_series(out / "fluid"), couplet.find_series(out / "solid"), first)
    figure.savefig(picture)
    for t, x, kind in couplet.extrema(time, tip):
        print(f"tip {kind}imum {x:+.4f} m at {t:.3f} s")
    print(f"picture: {picture}")


main()
