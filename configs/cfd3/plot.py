#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Drag and lift of cylinder and plate against Turek and Hron.
Usage: plot.py [PICTURE.png], by default out/cfd3.png; summary(FOLDER) for scripts."""
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

here = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(here.parents[1] / "client/python"), str(here.parent / "cylinder")]
import coefficients  # noqa: E402

PATCHES = ["cylinder", "plate"]


def summary(folder, last=1):
    """Mean and amplitude (half of largest plus and minus least) of drag and lift [N], frequency of the lift [1/s]."""
    rows = coefficients.couplet.read_csv(folder / "forces.csv")
    t = rows["time [s]"]
    end = t > t[-1] - last
    found = {}
    for name, axis in (("drag", "x"), ("lift", "y")):
        y = coefficients.force(rows, PATCHES, axis)[end]
        high, low = coefficients.peak(t[end], y), -coefficients.peak(t[end], -y)
        found[f"{name}_mean"], found[f"{name}_amp"] = (high + low) / 2, (high - low) / 2
    z = coefficients.rises(t[end], coefficients.force(rows, PATCHES, "y")[end])
    found["lift_f"] = (len(z) - 1) / (z[-1] - z[0]) if len(z) > 1 else 0.0
    return found


def reference():
    with open(here / "reference" / "turek_hron.csv", newline="") as file:
        lines = [line for line in file if not line.startswith("#")]
    row = next(r for r in csv.DictReader(lines) if r["case"] == "CFD3")
    return {name: float(row[name]) for name in ("drag_mean", "drag_amp", "lift_mean", "lift_amp", "lift_f")}


def main():
    out = here / "out"
    if not (out / "fluid" / "forces.csv").exists():
        sys.exit(f"There is no result in {out}. Run the case first (see its README).")
    rows, wanted = coefficients.couplet.read_csv(out / "fluid" / "forces.csv"), reference()
    figure, axes = plt.subplots(2, 1, figsize=(8, 6), dpi=130, sharex=True, constrained_layout=True)
    for ax, name, axis in ((axes[0], "drag", "x"), (axes[1], "lift", "y")):
        y = coefficients.force(rows, PATCHES, axis)
        ax.plot(rows["time [s]"], y, label="Couplet")
        mean, amplitude = wanted[f"{name}_mean"], wanted[f"{name}_amp"]
        for value in (mean - amplitude, mean + amplitude):
            ax.axhline(value, color="k", ls=":")
        ax.set(ylabel=f"{name} [N]", ylim=(mean - 3 * amplitude, mean + 3 * amplitude))
        ax.grid(alpha=0.3)
    axes[1].set_xlabel("time [s]")
    picture = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else out / "cfd3.png"
    figure.savefig(picture)
    for name, value in summary(out / "fluid").items():
        print(f"{name} = {value:.4f}, Turek and Hron {wanted[name]:.4f}")
    print(f"picture: {picture}")


if __name__ == "__main__":
    main()
