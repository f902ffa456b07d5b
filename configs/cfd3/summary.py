#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Drag and lift of cylinder and plate in out/, the last second, against Turek and Hron; summary(FOLDER) for scripts."""
import csv
import pathlib
import sys

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
        found[f"{name}_mean"], found[f"{name}_amp"] = coefficients.mean_and_amplitude(t[end], y)
        if name == "lift":
            found["lift_f"] = coefficients.frequency(t[end], y)
    return found


def reference():
    with open(here / "reference" / "turek_hron.csv", newline="") as file:
        lines = [line for line in file if not line.startswith("#")]
    row = next(r for r in csv.DictReader(lines) if r["case"] == "CFD3")
    return {name: float(row[name]) for name in ("drag_mean", "drag_amp", "lift_mean", "lift_amp", "lift_f")}


if __name__ == "__main__":
    out, wanted = here / "out" / "fluid", reference()
    if not (out / "forces.csv").exists():
        sys.exit(f"There is no result in {out}. Run the case first (see its README).")
    for name, value in summary(out).items():
        print(f"{name} = {value:.4f}, Turek and Hron {wanted[name]:.4f}")
