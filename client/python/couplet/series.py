# SPDX-License-Identifier: Apache-2.0
"""Reads the fields of a participant (HDF5): in the volume, and on patches (surface-<patch>.h5 of `output.surfaces`)."""
from __future__ import annotations

import pathlib

import h5py
import numpy as np

WIDTH = {4: 3, 5: 4, 6: 4, 7: 5, 8: 6, 9: 8}  # points of a cell, by XDMF code


class FieldSeries:
    """One <name>.h5 series: times, cells (lists of point numbers), coordinates and fields by name.

    `times` (outputs,) [s], `cells`: an array of point numbers per cell, `codes`: its XDMF code. Outputs are numbered
    from 0; -1 is the last."""

    def __init__(self, file: str | pathlib.Path):
        self.file = h5py.File(file, "r")
        self.steps = sorted(self.file["steps"])
        self.times = np.array([float(self.file["steps"][s].attrs["time"]) for s in self.steps])
        kind = int(self.file.attrs["kind"])
        flat = self.file["mesh/cells"][...]
        if kind:
            self.cells, self.codes = list(flat), [kind] * len(flat)  # kinds of cells, by XDMF code
        else:
            self.cells, self.codes, at = [], [], 0
            while at < len(flat):
                self.codes.append(int(flat[at]))
                width = WIDTH[int(flat[at])]
                self.cells.append(flat[at + 1 : at + 1 + width])
                at += 1 + width

    def nearest(self, time: float) -> int:
        """Number of the output nearest to a time [s]."""
        return int(np.abs(self.times - time).argmin())

    def coordinates(self, i: int) -> np.ndarray:
        """Points (points, 2 or 3) [m] where they are at output `i`."""
        step = self.file["steps"][self.steps[i]]
        return step["coordinates"][...] if "coordinates" in step else self.reference()

    def field(self, i: int, name: str) -> np.ndarray:
        """Values (cells or points, components) of a field at output `i`, in its SI unit. Raises KeyError if there is
        none of this name."""
        step = self.file["steps"][self.steps[i]]
        for place in ("cells", "points"):
            if place in step and name in step[place]:
                return step[place][name][...]
        raise KeyError(f"no field '{name}' in {self.file.filename}")

    def is_at_points(self, i: int, name: str) -> bool:
        """Returns true if the field exists only at points. field() prefers cells if both have it."""
        step = self.file["steps"][self.steps[i]]
        return not ("cells" in step and name in step["cells"])

    def reference(self) -> np.ndarray:
        """Points (points, 2 or 3) [m] of the undeformed mesh."""
        return self.file["mesh/coordinates"][...]

    def is_flat(self) -> bool:
        """Returns true if the mesh is two-dimensional."""
        points = self.reference()
        return points.shape[1] == 2 or np.ptp(points[:, 2]) == 0

    def shares_of_points(self) -> np.ndarray:
        """Volumes [m^3] (2-D: areas [m^2]) of the cells, distributed evenly to their points: (points,)."""
        shares = np.zeros(len(self.reference()))
        for cell, volume in zip(self.cells, self.volumes()):
            shares[cell] += volume / len(cell)
        return shares

    def centres(self) -> np.ndarray:
        """Cell centers (cells, 2 or 3) [m], means of the points, in the undeformed mesh."""
        points = self.reference()
        return np.array([points[cell].mean(axis=0) for cell in self.cells])

    def volumes(self) -> np.ndarray:
        """Areas [m^2] (2-D) of the cells in the undeformed mesh; in 3-D volumes [m^3] of hulls, exact for planar
        faces."""
        points = self.reference()
        if self.is_flat():
            found = []
            for cell in self.cells:
                x, y = points[cell, 0], points[cell, 1]
                found.append(0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))
            return np.array(found)
        from scipy.spatial import ConvexHull

        return np.array([ConvexHull(points[cell]).volume for cell in self.cells])

    def names(self, i: int) -> list[str]:
        """Names of the fields at output `i`."""
        step = self.file["steps"][self.steps[i]]
        return [name for place in ("cells", "points") if place in step for name in step[place]]

    def edges_on_boundary(self) -> np.ndarray:
        """Edges (2-D) that belong to only one cell, as pairs of point numbers."""
        count = {}
        for cell in self.cells:
            for a, b in zip(cell, np.roll(cell, -1)):
                count.setdefault(frozenset((int(a), int(b))), []).append((int(a), int(b)))
        return np.array([pair[0] for pair in count.values() if len(pair) == 1])


SHAPES = ("buckling.h5", "mode-shapes.h5")  # beside the fields of a run


def find_series(folder: str | pathlib.Path, name: str = "*.h5") -> FieldSeries:
    """The .h5 field series in a participant's output folder: that of the run, not that of its shapes, unless they are
    named."""
    for file in sorted(pathlib.Path(folder).glob(name)):
        if file.name in SHAPES and file.name != name:
            continue
        with h5py.File(file, "r") as f:
            if f.attrs.get("format") in (b"couplet fields", "couplet fields"):
                return FieldSeries(file)
    raise FileNotFoundError(f"no field series in {folder}")


class Surface(FieldSeries):
    """Patch over time. Its cells are faces with two points in 2-D, and three or four in 3-D.

    field(i, name) has one row per face, or per point for fields at points; 2-D vectors are padded to three components.
    """

    def __init__(self, file):
        super().__init__(file)
        form = self.file.attrs.get("format")
        if form not in (b"couplet surface", "couplet surface"):
            raise ValueError(f"{file}: is not a surface file; its format is {form!r}")
        self.name = pathlib.Path(file).stem.removeprefix("surface-")

    def is_plane(self) -> bool:
        """Returns true if the faces are edges (2-D), with values per meter of depth."""
        return len(self.cells[0]) == 2

    def places(self, i: int = -1) -> np.ndarray:
        """Face centers (faces, 2 or 3) [m]: means of their points."""
        points = self.coordinates(i)
        return np.array([points[face].mean(axis=0) for face in self.cells])

    def areas(self, i: int = -1) -> np.ndarray:
        """Face areas [m^2]. Edges count as length times 1 m. Quadrilaterals use half the cross product of the diagonals
        (planar faces)."""
        points = self.coordinates(i)
        if self.is_plane():
            return np.array([np.linalg.norm(points[b] - points[a]) for a, b in self.cells])
        last = [(f[1], f[-1], f[0], f[2]) for f in self.cells]
        ends = [
            (
                (points[b] - points[d], points[c] - points[a])
                if len(f) == 4
                else (points[f[1]] - points[f[0]], points[f[2]] - points[f[0]])
            )
            for f, (b, d, a, c) in zip(self.cells, last)
        ]
        return np.array([0.5 * np.linalg.norm(np.cross(u, v)) for u, v in ends])

    def integral(self, name: str, i: int = -1) -> np.ndarray:
        """Sum over the faces of the field times the area: for a traction [Pa] the force [N]. Point fields use the mean
        over each face."""
        field = np.asarray(self.field(i, name), float)
        if self.is_at_points(i, name):
            field = np.array([field[face].mean(axis=0) for face in self.cells])
        return np.tensordot(self.areas(i), field, axes=1)

    def chains(self, i: int = -1) -> list[tuple[np.ndarray, np.ndarray]]:
        """Returns [(ordered edge numbers, ordered points)] in 2-D. An open part starts at its end with the lowest
        number, a closed one at its point with the largest x. Both have the body on the same side as the edges."""
        points, after = self.coordinates(i), {}
        for number, (a, b) in enumerate(self.cells):
            after.setdefault(int(a), []).append((number, int(b)))
        ends = {int(b) for _, b in self.cells}
        found = []
        while after:
            open_ends = [a for a in after if a not in ends]
            at = min(open_ends) if open_ends else max(after, key=lambda a: (points[a][0], -a))
            edges, corners = [], [at]
            while at in after:
                number, b = after[at].pop()
                if not after[at]:
                    del after[at]
                edges.append(number)
                corners.append(b)
                at = b
            found.append((np.array(edges), np.array(corners)))
        return found


def surface_names(folder: str | pathlib.Path) -> list[str]:
    """Patches with a surface in a participant's folder."""
    return [
        file.stem.removeprefix("surface-")
        for file in sorted(pathlib.Path(folder).glob("surface-*.h5"))
        if h5py.is_hdf5(file)
    ]


def find_surface(folder: str | pathlib.Path, patch: str) -> Surface:
    """Surface of a patch in a participant's folder. Raises FileNotFoundError with the names that there are."""
    file = pathlib.Path(folder) / f"surface-{patch.replace('/', '_')}.h5"
    if not file.exists():
        there = surface_names(folder)
        raise FileNotFoundError(
            f"{folder}: there is no surface '{patch}'; "
            + (f"there is: {', '.join(there)}" if there else "`output.surfaces` names what is written")
        )
    return Surface(file)


def extrema(t: np.ndarray, y: np.ndarray, window: float = 0.15) -> list[tuple[float, float, str]]:
    """Local maxima and minima as (time, value, kind), from the parabola through three samples, that are extreme within
    `window` seconds on either side. End points are excluded."""
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


def extremum(place: np.ndarray, values: np.ndarray, sign: int) -> float:
    """Extremum along a line of the quartic through the five points around the largest sign * value."""
    from scipy.interpolate import barycentric_interpolate

    i = int(np.clip(np.argmax(sign * values), 2, len(values) - 3))
    near = slice(i - 2, i + 3)
    return sign * float(
        np.max(sign * barycentric_interpolate(place[near], values[near], np.linspace(place[i - 1], place[i + 1], 401)))
    )
