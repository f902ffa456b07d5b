# SPDX-License-Identifier: Apache-2.0
"""Files of an OpenFOAM case: headers, lists, the mesh, results."""
import os
import pathlib
import re

import numpy as np

from couplet import files
from couplet.peers import elements
from couplet.peers.values import refuse
from couplet.runs.process import environment

WORD = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]*")
RANK = {"scalar": 1, "vector": 3, "symmTensor": 6}


def foam_environment():
    """Environment for Debian's package. An installation set up in the shell takes precedence."""
    return dict(environment(), WM_PROJECT_DIR=os.environ.get("WM_PROJECT_DIR", "/usr/share/openfoam"))


def put(folder, path, kind, text, note=""):
    """Writes a file of a case and creates its folder if necessary."""
    files.write(
        folder,
        path,
        f"FoamFile {{version 2.0; format ascii; class {kind}; {note} object {pathlib.PurePath(path).name};}}\n{text}\n",
    )


def one(row):
    return f"{row:.12g}" if np.ndim(row) == 0 else "(" + " ".join(f"{v:.12g}" for v in row) + ")"


def values(rows):
    """Formats an array (n) or (n, 3) as `uniform v` or `nonuniform List<...>`."""
    rows = np.asarray(rows, float)
    if len(rows) == 0 or np.all(rows == rows[0]):
        return f"uniform {one(rows[0] if len(rows) else (0 if rows.ndim == 1 else (0, 0, 0)))}"
    return f"nonuniform List<{'scalar' if rows.ndim == 1 else 'vector'}> {len(rows)}(" + "\n".join(map(one, rows)) + ")"


class PolyMesh:
    """Faces of a first-order 3-D mesh in the order of constant/polyMesh: those between two cells sorted by cells, then
    patch by patch."""

    def __init__(self, mesh, kinds):
        """`kinds` is {patch: its OpenFOAM type}. `front` and `back` of a plane mesh become the patch frontAndBack."""
        self.mesh, self.kinds = mesh, dict(kinds)
        for patch in self.kinds:
            if not WORD.fullmatch(patch):
                refuse(
                    f"boundaries.{patch}",
                    (
                        "this name is not a valid word in OpenFOAM's dictionaries; rename the patch with letters,"
                        " digits, '_', '-' and '.'"
                    ),
                )
        faces, cells, centres = self.all_faces()
        keys = np.sort(faces, axis=1)
        _, first, inverse, counts = np.unique(keys, axis=0, return_index=True, return_inverse=True, return_counts=True)
        inverse = inverse.ravel()
        order = np.lexsort((cells, inverse))
        starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
        self.centres = centres
        inner = np.nonzero(counts == 2)[0]
        a, b = order[starts[inner]], order[starts[inner] + 1]
        sequence = np.lexsort((cells[b], cells[a]))
        self.faces, self.owner, self.neighbour = [faces[a[sequence]]], [cells[a[sequence]]], cells[b[sequence]]
        lone = {tuple(keys[first[k]]): order[starts[k]] for k in np.nonzero(counts == 1)[0]}
        self.patches, self.at = {}, len(inner)
        for patch, kind in self.kinds.items():
            self.add(patch, kind, [patch], faces, cells, lone)
        if "front" in mesh.patches and "front" not in self.kinds:
            self.add("frontAndBack", "empty", ["back", "front"], faces, cells, lone)
        self.faces, self.owner = np.vstack(self.faces), np.concatenate(self.owner)

    def all_faces(self):
        """Returns (faces padded with -1, their cells, centers of all cells). Every face normal points out of its
        cell."""
        faces, cells, centres, count = [], [], [], 0
        for shape, nodes in self.mesh.cells.items():
            middles = self.mesh.points[nodes].mean(axis=1)
            for corners in elements.FACES[shape]:
                face, points = nodes[:, corners], self.mesh.points[nodes[:, corners]]
                normal = (
                    np.cross(points[:, 2] - points[:, 0], points[:, -1] - points[:, 1])
                    if len(corners) == 4
                    else np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
                )
                inward = ((points.mean(axis=1) - middles) * normal).sum(axis=1) < 0
                face = np.where(inward[:, None], face[:, ::-1], face)
                faces.append(np.pad(face, ((0, 0), (0, 4 - len(corners))), constant_values=-1))
                cells.append(count + np.arange(len(nodes)))
            centres.append(middles)
            count += len(nodes)
        return np.vstack(faces), np.concatenate(cells), np.vstack(centres)

    def add(self, name, kind, parts, faces, cells, lone):
        found = []
        for part in parts:
            for nodes in self.mesh.patches[part].values():
                padded = np.sort(np.pad(nodes, ((0, 0), (0, 4 - nodes.shape[1])), constant_values=-1), axis=1)
                found += [lone[tuple(f)] for f in padded]
        found = np.array(sorted(found, key=lambda f: cells[f]), int)
        self.faces.append(faces[found])
        self.owner.append(cells[found])
        self.patches[name] = kind, len(found), self.at
        self.at += len(found)

    def corners_of(self, patch):
        """Corners (faces, 4), padded with -1."""
        _, count, start = self.patches[patch]
        return self.faces[start : start + count]

    def middles_of(self, patch):
        """Face centers (faces, 3): means of their corners."""
        return np.array([self.mesh.points[f[f >= 0]].mean(axis=0) for f in self.corners_of(patch)])

    def normals_of(self, patch):
        """Outward unit normals (faces, 3)."""
        p = self.mesh.points[self.corners_of(patch)[:, :3]]
        n = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
        return n / np.linalg.norm(n, axis=1)[:, None]

    def write(self, folder):
        points = list(map(one, self.mesh.points))
        faces = [
            f"{len(f)}({' '.join(map(str, f))})" for f in ([v for v in row if v >= 0] for row in self.faces.tolist())
        ]
        note = (
            f'note "nPoints:{len(points)} nCells:{len(self.centres)} nFaces:{len(faces)}'
            f' nInternalFaces:{len(self.neighbour)}";'
        )
        patches = [
            f"{name} {{type {kind}; nFaces {count}; startFace {start};}}"
            for name, (kind, count, start) in self.patches.items()
        ]
        for name, kind, entries in (
            ("points", "vectorField", points),
            ("faces", "faceList", faces),
            ("owner", "labelList", self.owner.tolist()),
            ("neighbour", "labelList", self.neighbour.tolist()),
            ("boundary", "polyBoundaryMesh", patches),
        ):
            put(
                folder,
                f"constant/polyMesh/{name}",
                kind,
                f"{len(entries)}\n(\n" + "\n".join(map(str, entries)) + "\n)",
                note,
            )


def last_time(folder):
    """Folder of the last written time."""
    times = [
        f
        for f in pathlib.Path(folder).iterdir()
        if f.is_dir() and re.fullmatch(r"\d+(\.\d+)?(e[+-]?\d+)?", f.name) and float(f.name) > 0
    ]
    if not times:
        raise ValueError("OpenFOAM wrote no result")
    return max(times, key=lambda f: float(f.name))


def read_field(file, count):
    """Values of all cells, (count) or (count, components)."""
    text = pathlib.Path(file).read_text()
    match = re.search(r"internalField\s+(uniform|nonuniform)\s+(?:List<(\w+)>\s*\d+\s*\(\n?)?", text)
    if match[1] == "uniform":
        row = np.array(re.split(r"[()\s;]+", text[match.end() : text.index(";", match.end())].strip("() ")), float)
        return np.broadcast_to(row if len(row) > 1 else row[0], (count, len(row)) if len(row) > 1 else count)
    body = text[match.end() : text.index(";", match.end())]
    found = np.array(body.replace("(", " ").replace(")", " ").split(), float).reshape(count, RANK[match[2]])
    return found[:, 0] if match[2] == "scalar" else found


def read_rows(file):
    """Numbers of a function object's table without brackets: (rows, columns)."""
    lines = pathlib.Path(file).read_text().splitlines()
    return np.array(
        [re.sub(r"[()]", " ", line).split() for line in lines if line.strip() and not line.startswith("#")], float
    )
