# SPDX-License-Identifier: Apache-2.0
"""Reads what a participant wrote: field series (HDF5)."""
import pathlib

import h5py
import numpy as np

from couplet.runs.results import read_csv

WIDTH = {4: 3, 5: 4, 6: 4, 7: 5, 8: 6, 9: 8}  # points of a cell, by XDMF code


class FieldSeries:
    """One <name>.h5 series. Times, cells (lists of point numbers), coordinates and fields by name."""

    def __init__(self, file):
        self.file = h5py.File(file, "r")
        self.steps = sorted(self.file["steps"])
        self.times = np.array([float(self.file["steps"][s].attrs["time"]) for s in self.steps])
        kind = int(self.file.attrs["kind"])
        flat = self.file["mesh/cells"][...]
        if kind:
            self.cells = list(flat)
        else:
            self.cells, at = [], 0
            while at < len(flat):
                width = WIDTH[int(flat[at])]
                self.cells.append(flat[at + 1 : at + 1 + width])
                at += 1 + width

    def nearest(self, time):
        return int(np.abs(self.times - time).argmin())

    def coordinates(self, i):
        step = self.file["steps"][self.steps[i]]
        return step["coordinates"][...] if "coordinates" in step else self.reference()

    def field(self, i, name):
        step = self.file["steps"][self.steps[i]]
        for place in ("cells", "points"):
            if place in step and name in step[place]:
                return step[place][name][...]
        raise KeyError(f"no field '{name}' in {self.file.filename}")

    def is_at_points(self, i, name):
        """field() takes the one of the cells where both have it."""
        step = self.file["steps"][self.steps[i]]
        return not ("cells" in step and name in step["cells"])

    def reference(self):
        """Points of the undeformed mesh."""
        return self.file["mesh/coordinates"][...]

    def shares_of_points(self):
        """Volumes (2-D: areas) of the cells, dealt out evenly to their points."""
        shares = np.zeros(len(self.reference()))
        for cell, volume in zip(self.cells, self.volumes()):
            shares[cell] += volume / len(cell)
        return shares

    def centres(self):
        """Means of the points of each cell in the undeformed mesh."""
        points = self.reference()
        return np.array([points[cell].mean(axis=0) for cell in self.cells])

    def volumes(self):
        """Areas (2-D) of the cells in the undeformed mesh; in 3-D those of hulls, which for planar faces are the volumes."""
        points = self.reference()
        if len(points[0]) == 2 or np.ptp(points[:, 2]) == 0:
            found = []
            for cell in self.cells:
                x, y = points[cell, 0], points[cell, 1]
                found.append(0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))
            return np.array(found)
        from scipy.spatial import ConvexHull
        return np.array([ConvexHull(points[cell]).volume for cell in self.cells])

    def names(self, i):
        step = self.file["steps"][self.steps[i]]
        return [name for place in ("cells", "points") if place in step for name in step[place]]

    def edges_on_boundary(self):
        """Edges (2-D) that belong to one cell only, as pairs of point numbers."""
        count = {}
        for cell in self.cells:
            for a, b in zip(cell, np.roll(cell, -1)):
                count.setdefault(frozenset((int(a), int(b))), []).append((int(a), int(b)))
        return np.array([pair[0] for pair in count.values() if len(pair) == 1])


SHAPES = "buckling.h5"  # of load factors, beside the fields of a run


def find_series(folder, name="*.h5"):
    """The .h5 field series in a participant's output folder: that of the run, not of its shapes, unless they are named."""
    for file in sorted(pathlib.Path(folder).glob(name)):
        if file.name == SHAPES != name:
            continue
        with h5py.File(file, "r") as f:
            if f.attrs.get("format") in (b"couplet fields", "couplet fields"):
                return FieldSeries(file)
    raise FileNotFoundError(f"no field series in {folder}")


def extrema(t, y, window=0.15):
    """Local maxima and minima as (time, value, kind), each the top of a parabola through its three nearest samples and
    the largest (smallest) within `window` seconds either side; the end points do not count."""
    found = []
    for sign, kind in ((1, "max"), (-1, "min")):
        z = sign * y
        for i in range(1, len(z) - 1):
            near = np.abs(t - t[i]) <= window
            if z[i] == z[near].max() and t[i] - t[0] > window and t[-1] - t[i] > window / 2:
                a, b, c = np.polyfit(t[i - 1 : i + 2] - t[i], z[i - 1 : i + 2], 2)
                shift = -b / (2 * a) if a < 0 else 0.0
                if not found or kind != found[-1][2] or t[i] - found[-1][0] > window:
                    found.append((t[i] + shift, sign * (c + b * shift + a * shift * shift), kind))
    return sorted(found)


def passes_a_step(folder):
    """Mean number of passes of the coupling in a step, of a run's output folder."""
    passes = read_csv(folder / "coupler" / "residuals.csv")
    return len(passes["step"]) / len(set(passes["step"]))
