#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Temperature and stress over the radius against the closed form. Usage: plot.py [PICTURE.png], by default
out/heated-cylinder.png"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "client/python"))
import couplet  # noqa: E402

A, B, HOT, E, NU, ALPHA = 1.0, 1.5, 100.0, 200e9, 0.3, 12e-6


def exact(r):
    """Temperature above the outside [K], radial, hoop and axial stress [Pa]; Timoshenko and Goodier, Theory of Elasticity,
    article 151, ends held."""
    size = np.log(B / A)
    c, g = E * ALPHA * HOT / (2 * (1 - NU) * size), A**2 / (B**2 - A**2) * size
    warm = HOT * np.log(B / r) / size
    radial, hoop = (c * (k - np.log(B / r) - g * (1 - s * B**2 / r**2)) for k, s in ((0, 1), (1, -1)))
    return warm, radial, hoop, NU * (radial + hoop) - E * ALPHA * warm


def main():
    out, picture = couplet.result_of(HERE, "solid")
    series = couplet.find_series(out / "solid")
    last = len(series.times) - 1
    centres = series.centres()
    r = np.hypot(centres[:, 0], centres[:, 1])
    stress = [series.field(last, f"stress-{c}") for c in ("xx", "yy", "zz")]
    warm = series.field(last, "cell-temperature") - 300
    line = np.linspace(A, B, 200)
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), dpi=130, constrained_layout=True)
    left.plot(line, exact(line)[0], "k", r, warm, ".")
    left.set(xlabel="r [m]", ylabel="temperature above the outside [K]")
    for name, ours, wanted in zip(("radial", "hoop", "axial"), stress, exact(line)[1:]):
        right.plot(line, wanted / 1e6, "k")
        right.plot(r, ours / 1e6, ".", label=name)
    right.set(xlabel="r [m]", ylabel="stress [MPa]")
    right.legend()
    for ax in (left, right):
        ax.grid(alpha=0.3)
    figure.savefig(picture)
    size = max(np.abs(s).max() for s in exact(line)[1:])
    for name, ours, wanted in zip(("radial", "hoop", "axial"), stress, exact(r)[1:]):
        print(f"{name} stress of the cells: largest error {100 * np.abs(ours - wanted).max() / size:.3f} % of the largest stress")
    print(f"picture: {picture}")


if __name__ == "__main__":
    main()
