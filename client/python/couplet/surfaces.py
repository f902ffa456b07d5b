# SPDX-License-Identifier: Apache-2.0
"""Fields on patches, surface-<patch>.h5 of `output.surfaces`: faces, their areas, in 2-D the arc length."""
import pathlib

import h5py
import numpy as np

from couplet.series import FieldSeries


class Surface(FieldSeries):
    """One patch over time. Its cells are faces: two points each in 2-D, three or four in 3-D.

    field(i, name) has one row per face, or per point for fields at points; 2-D vectors are padded to three components."""

    def __init__(self, file):
        super().__init__(file)
        form = self.file.attrs.get("format")
        if form not in (b"couplet surface", "couplet surface"):
            raise ValueError(f"{file}: is no surface; its format is {form!r}")
        self.name = pathlib.Path(file).stem.removeprefix("surface-")

    def is_plane(self):
        """2-D: the faces are edges, per metre of depth."""
        return len(self.cells[0]) == 2

    def places(self, i=-1):
        """Centres of the faces [m]: means of their points."""
        points = self.coordinates(i)
        return np.array([points[face].mean(axis=0) for face in self.cells])

    def areas(self, i=-1):
        """Of the faces [m^2]; edges count as length times 1 m. Quadrilaterals: half the cross product of the diagonals (plane faces)."""
        points = self.coordinates(i)
        if self.is_plane():
            return np.array([np.linalg.norm(points[b] - points[a]) for a, b in self.cells])
        last = [(f[1], f[-1], f[0], f[2]) for f in self.cells]
        ends = [(points[b] - points[d], points[c] - points[a]) if len(f) == 4 else (points[f[1]] - points[f[0]], points[f[2]] - points[f[0]])
                for f, (b, d, a, c) in zip(self.cells, last)]
        return np.array([0.5 * np.linalg.norm(np.cross(u, v)) for u, v in ends])

    def integral(self, name, i=-1):
        """Sum over the faces of the field times the area: of a traction [Pa] the force [N]; of points the mean over the face."""
        field = np.asarray(self.field(i, name), float)
        if self.is_at_points(i, name):
            field = np.array([field[face].mean(axis=0) for face in self.cells])
        return np.tensordot(self.areas(i), field, axes=1)

    def chains(self, i=-1):
        """[(numbers of the edges in order, their points in order)], 2-D: an open part from its end of the lowest number on, a
        closed one from its point of the largest x on, both with the body to the same side as the edges have it."""
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


def surface_names(folder):
    """Patches with a surface in a participant's folder."""
    return [file.stem.removeprefix("surface-") for file in sorted(pathlib.Path(folder).glob("surface-*.h5")) if h5py.is_hdf5(file)]


def find_surface(folder, patch):
    """The surface of a patch in a participant's folder."""
    file = pathlib.Path(folder) / f"surface-{patch.replace('/', '_')}.h5"
    if not file.exists():
        there = surface_names(folder)
        raise FileNotFoundError(f"{folder}: there is no surface '{patch}'; " + (f"there is: {', '.join(there)}" if there else "`output.surfaces` names what is written"))
    return Surface(file)
