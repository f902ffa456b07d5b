#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Radial and hoop stress over the radius against Lame's solution. Usage: plot.py [PICTURE.png], by default
out/lame-cylinder.png"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "client/python"))
import couplet  # noqa: E402

INNER, OUTER, PRESSURE, E, NU = 7.0, 18.625, 100e6, 10e9, 0.3
A = PRESSURE * INNER**2 / (OUTER**2 - INNER**2)


def exact(r):
    """Radial and hoop stress [Pa], radial displacement in plane strain [m]; Timoshenko and Goodier, Theory of Elasticity."""
    b = A * OUTER**2 / r**2
    return A - b, A + b, (1 + NU) / E * r * ((1 - 2 * NU) * A + b)


def main():
    out, picture = couplet.result_of(HERE, "solid")
    series = couplet.find_series(out / "solid")
    last = len(series.times) - 1
    centres = series.centres()
    r, angle = np.hypot(centres[:, 0], centres[:, 1]), np.arctan2(centres[:, 1], centres[:, 0])
    xx, yy, xy = (series.field(last, f"stress-{c}") for c in ("xx", "yy", "xy"))
    c, s = np.cos(angle), np.sin(angle)
    radial, hoop = c * c * xx + s * s * yy + 2 * c * s * xy, s * s * xx + c * c * yy - 2 * c * s * xy
    figure, ax = plt.subplots(figsize=(6, 4), dpi=130, constrained_layout=True)
    line = np.linspace(INNER, OUTER, 200)
    ax.plot(line, exact(line)[0] / 1e6, "k", label="Lamé")
    ax.plot(line, exact(line)[1] / 1e6, "k")
    ax.plot(r, radial / 1e6, ".", label="radial, cells")
    ax.plot(r, hoop / 1e6, ".", label="hoop, cells")
    ax.set(xlabel="r [m]", ylabel="stress [MPa]")
    ax.grid(alpha=0.3)
    ax.legend()
    figure.savefig(picture)
    probes = couplet.read_csv(out / "solid" / "probes.csv")
    for name, place in (("inside", INNER), ("outside", OUTER)):
        ours, wanted = probes[f"{name} x [m]"][-1], exact(place)[2]
        print(f"radial displacement {name}: {ours:.6f} m, exact {wanted:.6f} m, {100 * (ours / wanted - 1):+.3f} %")
    gap = np.sqrt(np.mean((radial - exact(r)[0]) ** 2 + (hoop - exact(r)[1]) ** 2)) / PRESSURE
    print(f"stress of the cells: root mean square error {100 * gap:.3f} % of the pressure")
    print(f"picture: {picture}")


main()
