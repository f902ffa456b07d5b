# SPDX-License-Identifier: Apache-2.0
"""Mesh of a case for other programs: a .geo through gmsh, or a .msh (4.1 or 2.2, text), of first or second order."""
import pathlib
import re
import subprocess

import numpy as np

from couplet import files
from couplet.peers.elements import CORNERS, EDGES, FACES
from couplet.peers.values import number, refuse
from couplet.runs.case import Wrong, expect

# gmsh's element types: (shape, order, points in the file)
TYPES = {
    1: ("line", 1, 2),
    2: ("triangle", 1, 3),
    3: ("quadrilateral", 1, 4),
    4: ("tetrahedron", 1, 4),
    5: ("hexahedron", 1, 8),
    6: ("prism", 1, 6),
    8: ("line", 2, 3),
    9: ("triangle", 2, 6),
    11: ("tetrahedron", 2, 10),
    16: ("quadrilateral", 2, 8),
    17: ("hexahedron", 2, 20),
    18: ("prism", 2, 15),
}
DIMENSION = {"line": 1, "triangle": 2, "quadrilateral": 2, "tetrahedron": 3, "hexahedron": 3, "prism": 3}
# Words of a .geo by which gmsh runs commands, or reads and writes other files.
DANGER = re.compile(
    r"\b(System|SystemCall|NonBlockingSystemCall|Print|Save|CreateDir|Merge|MergeWithBoundingBox|Include|Plugin|"
    r"OnelabRun|SendToServer|ShapeFromFile|ListFromFile|GetEnv|Exit|Abort|CreateTopology|PostProcessing|General)\b"
)


class Mesh:
    """points: (n, 3); cells: {shape: (m, points)}; patches: {name: {shape: (m, points)}}; order 1 or 2."""

    def __init__(self, dimension, order, points, cells, patches):
        self.dimension, self.order, self.points, self.cells, self.patches = dimension, order, points, cells, patches

    def corners(self):
        """Same mesh without the middles of edges."""
        cells = {s: c[:, : CORNERS[s]] for s, c in self.cells.items()}
        patches = {p: {s: f[:, : CORNERS[s]] for s, f in faces.items()} for p, faces in self.patches.items()}
        return compressed(Mesh(self.dimension, 1, self.points, cells, patches))

    def nodes_of(self, patch):
        return np.unique(np.concatenate([f.ravel() for f in self.patches[patch].values()]))

    def count(self):
        return sum(map(len, self.cells.values()))

    def size(self):
        """Edge of the smallest cell, from its area or volume."""
        return min(float(np.abs(volumes(self.points, s, c)).min()) for s, c in self.cells.items()) ** (
            1 / self.dimension
        )

    def with_middles(self):
        """Second-order mesh with the middles of straight edges."""
        found, count = {}, len(self.points)

        def raised(shape, cells):
            more = [cells]
            for a, b in EDGES[shape]:
                keys = np.sort(cells[:, [a, b]], axis=1)
                more.append(np.array([found.setdefault((p, q), count + len(found)) for p, q in keys.tolist()])[:, None])
            return np.hstack(more)

        cells = {s: raised(s, c) for s, c in self.cells.items()}
        patches = {p: {s: raised(s, f) for s, f in faces.items()} for p, faces in self.patches.items()}
        pairs = np.array(list(found))
        return Mesh(self.dimension, 2, np.vstack([self.points, self.points[pairs].mean(axis=1)]), cells, patches)

    def extruded(self, depth):
        """First-order plane mesh extruded by one cell, with the patches `front` (z = depth) and `back` (z = 0)."""
        n, solid = len(self.points), {"triangle": "prism", "quadrilateral": "hexahedron"}
        points = np.vstack([self.points, self.points + (0, 0, depth)])
        cells = {solid[s]: np.hstack([c, c + n]) for s, c in self.cells.items()}
        patches = {
            p: {"quadrilateral": np.hstack([f["line"], f["line"][:, ::-1] + n])} for p, f in self.patches.items()
        }
        return Mesh(
            3,
            1,
            points,
            cells,
            {**patches, "back": dict(self.cells), "front": {s: c + n for s, c in self.cells.items()}},
        )

    def outward(self, patch):
        """Returns {shape: (m) +1 if the point order of a face gives an outward normal, else -1}."""
        if not hasattr(self, "_owners"):
            self._owners = {}
            for shape, cells in self.cells.items():
                middles = self.points[cells[:, : CORNERS[shape]]].mean(axis=1)
                for face in FACES[shape]:
                    self._owners.update(zip(map(frozenset, cells[:, face].tolist()), middles))
        found = {}
        for shape, faces in self.patches[patch].items():
            corners = self.points[faces[:, : CORNERS[shape]]]
            inside = np.array([self._owners[frozenset(f)] for f in faces[:, : CORNERS[shape]].tolist()])
            found[shape] = np.sign(((corners.mean(axis=1) - inside) * normals(corners)).sum(axis=1))
        return found


def check_patches(mesh, boundaries, where):
    """Checks that every patch has an entry and every entry a patch."""
    for patch in mesh.patches:
        expect(patch in boundaries, f"{where}.boundaries.{patch}: is missing")
    for patch in boundaries:
        expect(
            patch in mesh.patches,
            f"{where}.boundaries.{patch}: the mesh has no such patch; it has {', '.join(mesh.patches)}",
        )


def normals(corners):
    """Normals (m, 3) without normalization; for 2-D edges to the right of their direction."""
    if corners.shape[1] == 2:
        along = corners[:, 1] - corners[:, 0]
        return np.stack([along[:, 1], -along[:, 0], 0 * along[:, 0]], axis=1)
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, -1] - corners[:, 0])


def volumes(points, shape, cells):
    """Signed areas or volumes from the corners."""
    corners = points[cells[:, : CORNERS[shape]]]
    if DIMENSION[shape] == 2:
        x, y = corners[..., 0], corners[..., 1]
        return 0.5 * (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    middle, total = corners.mean(axis=1), 0
    for face in FACES[shape]:
        c = corners[:, face] - middle[:, None]
        for k in range(1, len(face) - 1):
            total = total + np.einsum("ij,ij->i", c[:, 0], np.cross(c[:, k], c[:, k + 1])) / 6
    return total


def compressed(mesh):
    """Mesh without unused points."""
    used = np.unique(np.concatenate([c.ravel() for c in mesh.cells.values()]))
    number_of = np.full(len(mesh.points), -1)
    number_of[used] = np.arange(len(used))
    patches = {p: {s: number_of[f] for s, f in faces.items()} for p, faces in mesh.patches.items()}
    return Mesh(
        mesh.dimension, mesh.order, mesh.points[used], {s: number_of[c] for s, c in mesh.cells.items()}, patches
    )


def turned(shape, order, cells):
    """Reverses the orientation of plane cells."""
    n = CORNERS[shape]
    first = [0, *range(n - 1, 0, -1)]
    return cells[:, first + (list(range(2 * n - 1, n - 1, -1)) if order == 2 else [])]


def sections(text):
    return {name: body for name, body in re.findall(r"\$(\w+)\s*\n(.*?)\n\$End\1", text, re.S)}


def entities(body, names):
    """Returns {(dimension, entity): name of its physical group} in format 4.1."""
    lines = iter(body.splitlines())
    counts, found = list(map(int, next(lines).split())), {}
    for dimension, count in enumerate(counts):
        for _ in range(count):
            words = next(lines).split()
            skip = 4 if dimension == 0 else 7
            groups = [abs(int(w)) for w in words[skip + 1 : skip + 1 + int(words[skip])]]
            found[dimension, int(words[0])] = next(
                (names[dimension, g] for g in groups if (dimension, g) in names), None
            )
    return found


def read_41(parts, names):
    """Returns (tags, points, [(type, name of the group, rows)])."""
    groups, blocks = entities(parts["Entities"], names), []
    words = parts["Nodes"].split()
    at, tags, points = 4, [], []
    for _ in range(int(words[0])):
        n = int(words[at + 3])
        tags += words[at + 4 : at + 4 + n]
        points += words[at + 4 + n : at + 4 + 4 * n]
        at += 4 + 4 * n
    words = parts["Elements"].split()
    at = 4
    for _ in range(int(words[0])):
        dimension, entity, kind, n = map(int, words[at : at + 4])
        width = 1 + (
            1
            if kind == 15
            else TYPES[kind][2] if kind in TYPES else refuse("mesh", f"cells of gmsh's type {kind} cannot be exported")
        )
        if kind != 15:
            rows = np.array(words[at + 4 : at + 4 + n * width], int).reshape(n, width)[:, 1:]
            blocks.append((kind, groups.get((dimension, entity)), rows))
        at += 4 + n * width
    return np.array(tags, int), np.array(points, float).reshape(-1, 3), blocks


def read_22(parts, names):
    rows = np.array([line.split() for line in parts["Nodes"].splitlines()[1:]], float)
    found = {}
    for line in parts["Elements"].splitlines()[1:]:
        words = list(map(int, line.split()))
        kind = words[1]
        if kind == 15:
            continue
        if kind not in TYPES:
            refuse("mesh", f"cells of gmsh's type {kind} cannot be exported")
        group = names.get((DIMENSION[TYPES[kind][0]], words[3]))
        found.setdefault((kind, group), []).append(words[3 + words[2] :])
    return (
        rows[:, 0].astype(int),
        rows[:, 1:4],
        [(kind, group, np.array(nodes)) for (kind, group), nodes in found.items()],
    )


def read(file, dimension, scale=1.0):
    """Reads the mesh of a .msh. Raises Refused for other formats and kinds of cells."""
    parts = sections(pathlib.Path(file).read_text(errors="replace"))
    version = parts.get("MeshFormat", "?").split()
    if version[:2] not in (["4.1", "0"], ["2.2", "0"]):
        refuse(file, "only .msh files of version 4.1 or 2.2 as text can be exported")
    names = {
        (int(d), int(tag)): name
        for d, tag, name in re.findall(r"^(\d) (\d+) \"(.*)\"", parts.get("PhysicalNames", ""), re.M)
    }
    tags, points, blocks = (read_41 if version[0] == "4.1" else read_22)(parts, names)
    number_of = np.full(tags.max() + 1, -1)
    number_of[tags] = np.arange(len(tags))
    cells, patches, orders = {}, {}, set()
    for kind, group, rows in blocks:
        shape, order, _ = TYPES[kind]
        orders.add(order)
        where = (
            cells
            if DIMENSION[shape] == dimension
            else patches.setdefault(group, {}) if DIMENSION[shape] == dimension - 1 and group else None
        )
        if where is not None:
            where.setdefault(shape, []).append(number_of[rows])
    expect(cells, f"{file}: there are no cells of dimension {dimension} in it")
    expect(len(orders) == 1, f"{file}: a mix of cells of first and second order cannot be exported")
    cells = {s: np.vstack(c) for s, c in cells.items()}
    patches = {p: {s: np.vstack(f) for s, f in faces.items()} for p, faces in patches.items()}
    order = orders.pop()
    for shape in cells if dimension == 2 else ():
        wrong = volumes(points, shape, cells[shape]) < 0
        cells[shape][wrong] = turned(shape, order, cells[shape][wrong])
    return compressed(Mesh(dimension, order, points * scale, cells, patches))


def of_participant(section, folder, where, work, order=1, trusted=False):
    """Mesh named in a participant's section, relative to `folder`. gmsh works in the folder `work`."""
    dimension, scale = int(section.get("dimension", 3)), number(section.get("mesh-scale", 1), f"{where}.mesh-scale")
    file = folder / str(section.get("mesh", ""))
    expect(file.is_file(), f"{where}.mesh: {file} does not exist")
    if file.suffix == ".msh":
        found = read(file, dimension, scale)
        return (
            found.with_middles()
            if order == 2 and found.order == 1
            else found.corners() if order == 1 and found.order == 2 else found
        )
    if file.suffix != ".geo":
        refuse(f"{where}.mesh", f"'{file.name}' cannot be exported, only .geo and .msh")
    danger = DANGER.search(re.sub(r"//.*|/\*.*?\*/", "", file.read_text()))
    if danger and not trusted:
        refuse(
            f"{where}.mesh",
            f"'{danger[0]}' in {file.name} may run commands or write files; --allow-commands permits it",
        )
    made = files.folder(work, ".") / f"mesh-{order}.msh"
    made.unlink(missing_ok=True)
    options = [
        w
        for name, value in (section.get("mesh-parameters") or {}).items()
        for w in ("-setnumber", name, repr(number(value, f"{where}.mesh-parameters.{name}")))
    ]
    try:
        done = subprocess.run(
            [
                "gmsh",
                "-nopopup",
                "-v",
                "2",
                f"-{dimension}",
                "-order",
                str(order),
                "-setnumber",
                "Mesh.SecondOrderIncomplete",
                "1",
                *options,
                "-format",
                "msh41",
                "-o",
                str(made.absolute()),
                str(file.absolute()),
            ],
            capture_output=True,
            text=True,
        )
    except FileNotFoundError:
        raise Wrong(f"{where}.mesh: gmsh makes the mesh of a .geo, and is not installed") from None
    expect(
        done.returncode == 0 and made.exists(),
        f"{where}.mesh: gmsh could not mesh '{file}': {(done.stdout + done.stderr).strip()[-300:]}",
    )
    return read(made, dimension, scale)
