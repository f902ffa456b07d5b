#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Drag and lift over time beside the reference values. Usage: plot.py [PICTURE.png], by default out/cylinder.png."""
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import coefficients

here = pathlib.Path(__file__).resolve().parent
out = here / "out"
if not (out / "fluid" / "forces.csv").exists():
    sys.exit(f"There is no result in {out}. Run the case first (see its README).")
rows = coefficients.couplet.read_csv(out / "fluid" / "forces.csv")
with open(here / "reference" / "schaefer_turek.csv", newline="") as file:
    wanted = {r["quantity"]: float(r["accurate"] or r["low"]) for r in csv.DictReader(file) if r["case"] == "2D-2"}
figure, axes = plt.subplots(2, 1, figsize=(8, 6), dpi=130, sharex=True, constrained_layout=True)
for ax, axis, name, lines in ((axes[0], "x", "drag coefficient", ("cd_max", "cd_min")), (axes[1], "y", "lift coefficient", ("cl_max",))):
    ax.plot(rows["time [s]"], 20 * coefficients.force(rows, ["cylinder"], axis), label="Couplet")
    for line in lines:
        ax.axhline(wanted[line], color="k", ls=":", label=f"{line} of the benchmark")
    ax.set_ylabel(name)
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8)
axes[0].set_ylim(2.9, 3.5)
axes[1].set_xlabel("time [s]")
picture = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else out / "cylinder.png"
figure.savefig(picture)
for name, value in coefficients.periodic(out / "fluid", 1).items():
    print(f"{name} = {value:.5f}, benchmark {wanted.get(name, float('nan')):.5f}")
print(f"picture: {picture}")
