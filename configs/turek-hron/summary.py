#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""summary.py fsi1|fsi2|fsi3 [FOLDER]: displacement of A, drag and lift of cylinder and plate beside Turek and Hron; summary(FOLDER) for
scripts."""
import csv
import pathlib
import sys

import numpy as np

here = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(here.parents[1] / "client/python"), str(here.parent / "cylinder")]
import coefficients  # noqa: E402

PATCHES = ["cylinder", "plate"]


def harmonic(t, values, frequency):
    """Returns the amplitude of the first harmonic of values with this frequency, fitted together with the mean and three further
    harmonics. Half of the range is larger where the values have ripples."""
    phase = 2 * np.pi * frequency * np.outer(t, range(5))
    fit = np.linalg.lstsq(np.hstack([np.cos(phase), np.sin(phase[:, 1:])]), values, rcond=None)[0]
    return float(np.hypot(fit[1], fit[5]))


def summary(folder, last=1.2):
    """Mean and amplitude (half of largest plus and minus least) over the last `last` s of displacement [m], drag and lift [N], the
    frequency of the displacement [1/s] (0 at rest), and the first harmonic of the lift at this frequency."""
    folder, found = pathlib.Path(folder), {}
    probes = coefficients.couplet.read_csv(folder / "solid" / "probes.csv")
    forces = coefficients.couplet.read_csv(folder / "fluid" / "forces.csv")
    for name, rows, values in (("ux", probes, probes["A x [m]"]), ("uy", probes, probes["A y [m]"]),
                               ("drag", forces, coefficients.force(forces, PATCHES, "x")),
                               ("lift", forces, coefficients.force(forces, PATCHES, "y"))):
        t = rows["time [s]"]
        end = t > t[-1] - last
        mean, amplitude = found[f"{name}_mean"], found[f"{name}_amp"] = coefficients.mean_and_amplitude(t[end], values[end])
        if name == "uy":
            found["uy_f"] = coefficients.frequency(t[end], values[end]) if amplitude > 0.1 * abs(mean) else 0.0
        if name == "lift" and found["uy_f"] > 0:
            found["lift_harmonic"] = harmonic(t[end], values[end], found["uy_f"])
    return found


def rows(case):
    """What others publish of 'FSI1', 'FSI2' or 'FSI3', by source."""
    with open(here / "reference" / "turek_hron.csv", newline="") as file:
        return [row for row in csv.DictReader(line for line in file if not line.startswith("#")) if row["case"] == case]


def reference(case):
    """Returns the values of Turek and Hron for 'FSI1', 'FSI2' or 'FSI3'."""
    row = next(row for row in rows(case) if row["source"] == "FF")
    return {name: float(value) for name, value in row.items() if name not in ("case", "source") and value}


if __name__ == "__main__":
    case = sys.argv[1] if len(sys.argv) > 1 else ""
    if case not in ("fsi1", "fsi2", "fsi3"):
        sys.exit("usage: summary.py fsi1|fsi2|fsi3 [FOLDER]")
    out = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else here / f"out-{case}"
    if not (out / "fluid" / "forces.csv").exists():
        sys.exit(f"There is no result in {out}. Run the case first (see its README).")
    wanted = reference(case.upper())
    for name, value in summary(out).items():
        print(f"{name} = {value:.5g}" + (f", Turek and Hron {wanted[name]:.5g}" if wanted.get(name) else ""))
