#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Axial stress in the wall and along the base against a p-FEM computation. Usage: plot.py [PICTURE.png], by default
out/le11.png"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "client/python"))
import couplet  # noqa: E402


def main():
    out, picture = couplet.result_of(HERE, "solid")
    series = couplet.find_series(out / "solid")
    last = len(series.times) - 1
    points, centres = series.file["mesh/coordinates"][...], series.centres()
    stress = series.field(last, "stress-zz") / 1e6
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.5), dpi=130, constrained_layout=True)
    # the layer of cells at the plane y = 0: their corners in that plane
    cells = np.array(series.cells)
    flat = np.abs(points[cells][:, :, 1]) < 1e-9
    layer = flat.sum(axis=1) == 4
    quads = points[cells[layer][flat[layer]].reshape(-1, 4)][:, :, [0, 2]]
    middle = quads.mean(axis=1, keepdims=True)
    turn = np.argsort(np.arctan2(*np.moveaxis(quads - middle, -1, 0)[::-1]), axis=1)
    quads = np.take_along_axis(quads, turn[:, :, None], axis=1)
    wall = PolyCollection(quads, array=stress[layer], cmap="coolwarm", norm=plt.Normalize(-105, 105))
    left.add_collection(wall)
    left.autoscale()
    left.set(aspect="equal", xlabel="r [m]", ylabel="z [m]")
    figure.colorbar(wall, ax=left, label="axial stress [MPa]")
    base = np.loadtxt(HERE / "reference/base.csv", delimiter=",").T
    low = layer & (centres[:, 2] < centres[:, 2].min() * 1.5)
    probes = couplet.read_csv(out / "solid" / "probes.csv")
    at_a = probes["A stress-zz [Pa]"][-1] / 1e6
    right.plot(base[0], base[1], "k", label="p-FEM, base z = 0")
    right.plot(np.hypot(centres[low, 0], centres[low, 1]), stress[low], "o", fillstyle="none", label="lowest cells")
    right.plot(1, at_a, "s", color="tab:red", label="probe at A")
    right.set(xlabel="r [m]", ylabel="axial stress [MPa]")
    right.grid(alpha=0.3)
    right.legend()
    figure.savefig(picture)
    print(f"axial stress at A {at_a:.2f} MPa; converged -105.67 MPa ({100 * (at_a / -105.67 - 1):+.2f} %), NAFEMS -105 MPa")
    print(f"picture: {picture}")


if __name__ == "__main__":
    main()
