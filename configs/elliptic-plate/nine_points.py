#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Error of a run at the nine points of reference/nine_points.csv: relative L2 norm over the points of the displacement vector
and of the von Mises stress. The values of the cells (of the two prisms or six tetrahedra that fill one place of the grid: their
mean) are interpolated by cubic splines in (s, phi) and by four points over the thickness, so that the error is the
discretisation's, not the interpolation's.
Usage: nine_points.py [FOLDER]     FOLDER: output of the solid, by default out/solid beside this file"""
import pathlib
import sys

import numpy as np
from scipy.interpolate import RectBivariateSpline

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "client/python"))
import couplet  # noqa: E402

THICKNESS = 0.6
STRESS = [f"stress-{c}" for c in ("xx", "yy", "zz", "xy", "yz", "xz")]


def map_back(x, y):
    """Returns (s, phi) with x = (2 + 1.25 s) cos(phi), y = (1 + 1.75 s) sin(phi); the left side falls as s grows."""
    low, high = np.zeros_like(x), np.ones_like(x)
    for _ in range(60):
        s = (low + high) / 2
        outside = (x / (2 + 1.25 * s)) ** 2 + (y / (1 + 1.75 * s)) ** 2 > 1
        low, high = np.where(outside, s, low), np.where(outside, high, s)
    return s, np.arctan2(y * (2 + 1.25 * s), x * (1 + 1.75 * s))


def von_mises(s):
    """Returns the von Mises stress of an array whose last axis is xx, yy, zz, xy, yz, xz."""
    xx, yy, zz, xy, yz, xz = np.moveaxis(s, -1, 0)
    return np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * (xy**2 + yz**2 + xz**2))


def grid(centres, shape):
    """Place of each cell in a grid of `shape` places in (s, phi, z), and how many share it: one hexahedron, two prisms, six tetrahedra."""
    s, phi = map_back(centres[:, 0], centres[:, 1])
    ranks = [np.floor(v / end * n).astype(int) for v, end, n in zip((s, phi, centres[:, 2]), (1, np.pi / 2, THICKNESS), shape)]
    place = np.ravel_multi_index(ranks, shape)
    share = np.bincount(place, minlength=np.prod(shape))
    if share.min() != share.max():
        raise ValueError(f"the cells do not fill a {shape} grid in (s, phi, z) evenly")
    return place, share[0]


def means(values, place, share, shape):
    """Returns the means of the cells at each point of the grid."""
    columns = values.reshape(len(values), -1).T
    return np.stack([np.bincount(place, column) for column in columns], axis=-1).reshape(*shape, len(columns)) / share


def at_middle(values, z):
    """Values of four (fewer: all) places over the thickness around its middle, as one: Lagrange's polynomial."""
    n = min(4 - len(z) % 2, len(z))
    first = (len(z) - n) // 2
    z, weights = z[first : first + n], []
    for i in range(n):
        others = np.delete(z, i)
        weights.append(np.prod((THICKNESS / 2 - others) / (z[i] - others)))
    return np.tensordot(values[:, :, first : first + n], weights, axes=(2, 0))


class Plate:
    """The last result of a run, callable anywhere in the plane z = 0.3."""

    def __init__(self, folder):
        series = couplet.find_series(folder)
        last = len(series.times) - 1
        points = series.file["mesh/coordinates"][...]
        cells = np.array(series.cells)
        nodes = [len(np.unique(np.round(v, 9))) for v in (*map_back(points[:, 0], points[:, 1]), points[:, 2])]
        cell_shape = [n - 1 for n in nodes]
        self.cells = len(cells)
        by_place = (*grid(points[cells].mean(axis=1), cell_shape), cell_shape)
        axes = [np.linspace(0, end, n) for end, n in zip((1, np.pi / 2, THICKNESS), nodes)]
        centres = [(a[1:] + a[:-1]) / 2 for a in axes]
        u = means(series.field(last, "cell-displacement"), *by_place)
        stress = means(np.stack([series.field(last, name) for name in STRESS], axis=-1), *by_place)
        self.first_centre = centres[0][0]
        self.u = self.splines(centres, at_middle(u, centres[2]))
        self.stress_ = self.splines(centres, at_middle(stress, centres[2]))

    @staticmethod
    def splines(axes, values):
        degree = [min(3, len(a) - 1) for a in axes[:2]]
        return [RectBivariateSpline(*axes[:2], values[..., k], kx=degree[0], ky=degree[1])
                for k in range(values.shape[-1])]

    def displacement(self, x, y):
        return np.stack([f.ev(*map_back(x, y)) for f in self.u], axis=-1)

    def stress(self, x, y):
        return np.stack([f.ev(*map_back(x, y)) for f in self.stress_], axis=-1)


def line(folder):
    """Along x = y, where values live: from the first centres to the last."""
    plate = Plate(folder)
    x = np.linspace(1 / np.hypot(0.5, 1), 1 / np.hypot(1 / 3.25, 1 / 2.75), 200)
    s, _ = map_back(x, x)
    x = x[(s >= plate.first_centre) & (s <= 1 - plate.first_centre)]
    return {"r [m]": x * np.sqrt(2), "uz [m]": plate.displacement(x, x)[:, 2], "von Mises [MPa]": von_mises(plate.stress(x, x)) / 1e6}


def circle(folder):
    """On r = 2.1 m."""
    angle = np.linspace(0, 90, 200)
    on = 2.1 * np.cos(np.radians(angle)), 2.1 * np.sin(np.radians(angle))
    stress = Plate(folder).stress(*on) / 1e6
    return {"angle [deg]": angle, "von Mises [MPa]": von_mises(stress), "sxx [MPa]": stress[:, 0], "syy [MPa]": stress[:, 1]}


def stresses(folder):
    """Largest errors of the stresses xx and yy on r = 2.1 m against the p-FEM computation, over the largest stress."""
    angle, _, *wanted = np.loadtxt(HERE / "reference/circle_2.1.csv", delimiter=",").T[:4]
    found, most = circle(folder), np.abs(wanted).max()
    return {name: np.abs(np.interp(angle, found["angle [deg]"], found[f"s{name} [MPa]"]) - one).max() / most for name, one in zip(("xx", "yy"), wanted)}


def reference():
    return np.loadtxt(HERE / "reference/nine_points.csv", delimiter=",").T


def errors(folder):
    """Returns (relative L2 error of the displacement, of the von Mises stress, number of cells)"""
    _, x, ux, uy, uz, wanted = reference()
    plate = Plate(folder)
    u = np.stack([ux, uy, uz], axis=-1)
    gap = np.linalg.norm(plate.displacement(x, x) - u) / np.linalg.norm(u)
    return gap, np.linalg.norm(von_mises(plate.stress(x, x)) - wanted) / np.linalg.norm(wanted), plate.cells


if __name__ == "__main__":
    u, stress, cells = errors(sys.argv[1] if len(sys.argv) > 1 else HERE / "out/solid")
    print(f"{cells} cells: displacement {100 * u:.3f} %, von Mises stress {100 * stress:.3f} %")
