# SPDX-License-Identifier: Apache-2.0
"""The plane mesh of one of our cases for other programs: read from the file that gmsh made for us (format 4.1, ASCII), one cell
thick for OpenFOAM."""
import pathlib

import numpy as np

from runs import foam_header


class PlaneMesh:
    """points: (n, 2); cells: lists of corners, counter-clockwise; edges: {patch: [(a, b), ...]}."""

    def __init__(self, file):
        words = iter(pathlib.Path(file).read_text().split())
        self.points, self.cells, self.edges = None, [], {}
        names, of_curve = {}, {}
        for word in words:
            if word == "$PhysicalNames":
                for _ in range(int(next(words))):
                    dimension, tag, name = int(next(words)), int(next(words)), next(words).strip('"')
                    names[dimension, tag] = name
            elif word == "$Entities":
                of_curve = self.curves(words, names)
            elif word == "$Nodes":
                numbers = self.nodes(words)
            elif word == "$Elements":
                self.elements(words, of_curve, numbers)
        self.cells = [c if self.area(c) > 0 else c[::-1] for c in self.cells]

    def curves(self, words, names):
        """{curve: name of its physical group}."""
        counts, found = [int(next(words)) for _ in range(4)], {}
        for _ in range(counts[0]):
            [next(words) for _ in range(4)]
            [next(words) for _ in range(int(next(words)))]
        for _ in range(counts[1]):
            tag = int(next(words))
            [next(words) for _ in range(6)]
            groups = [int(next(words)) for _ in range(int(next(words)))]
            [next(words) for _ in range(int(next(words)))]
            if groups:
                found[tag] = names[1, groups[0]]
        return found

    def nodes(self, words):
        blocks, count = int(next(words)), int(next(words))
        next(words), next(words)
        self.points, numbers = np.zeros((count, 2)), {}
        for _ in range(blocks):
            [next(words) for _ in range(3)]
            tags = [int(next(words)) for _ in range(int(next(words)))]
            for tag in tags:
                numbers[tag] = len(numbers)
                self.points[numbers[tag]] = float(next(words)), float(next(words))
                next(words)
        return numbers

    def elements(self, words, of_curve, numbers):
        blocks = int(next(words))
        [next(words) for _ in range(3)]
        for _ in range(blocks):
            next(words)
            entity, kind, count = int(next(words)), int(next(words)), int(next(words))
            corners = {1: 2, 2: 3, 3: 4, 15: 1}[kind]
            for _ in range(count):
                next(words)
                nodes = [numbers[int(next(words))] for _ in range(corners)]
                if kind == 1 and entity in of_curve:
                    self.edges.setdefault(of_curve[entity], []).append(tuple(nodes))
                elif kind in (2, 3):
                    self.cells.append(nodes)

    def area(self, cell):
        x, y = self.points[cell].T
        return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))

    def centres(self):
        return np.array([self.points[c].mean(axis=0) for c in self.cells])

    def write_foam(self, folder, depth, kinds):
        """constant/polyMesh of an OpenFOAM case; `kinds`: {patch: its type}, in the order of the patches. Gives {patch: (n, 2) middles of its
        faces}, in their order there."""
        folder = pathlib.Path(folder) / "constant/polyMesh"
        folder.mkdir(parents=True, exist_ok=True)
        n, beside = len(self.points), {}
        for c, corners in enumerate(self.cells):
            for a, b in zip(corners, corners[1:] + corners[:1]):
                beside.setdefault(frozenset((a, b)), []).append((c, a, b))

        def face(a, b):  # out of the cell that has the edge a, b in its order
            return f"4({a} {b} {b + n} {a + n})"
        inner = sorted((sorted(two) for two in beside.values() if len(two) == 2), key=lambda two: (two[0][0], two[1][0]))
        faces = [face(a, b) for (_, a, b), _ in inner]
        owner, neighbour = [two[0][0] for two in inner], [two[1][0] for two in inner]
        patches, middles = [], {}
        for name, kind in kinds.items():
            start = len(faces)
            edges = sorted(self.edges[name], key=lambda e: beside[frozenset(e)][0][0])
            middles[name] = np.array([self.points[list(e)].mean(axis=0) for e in edges])
            for edge in edges:
                (c, a, b), = beside[frozenset(edge)]
                faces.append(face(a, b))
                owner.append(c)
            patches.append((name, kind, len(faces) - start, start))
        start = len(faces)
        for offset in (0, n):
            for c, corners in enumerate(self.cells):
                turned = corners if offset else corners[::-1]
                faces.append(f"{len(corners)}({' '.join(str(p + offset) for p in turned)})")
                owner.append(c)
        patches.append(("frontAndBack", "empty", len(faces) - start, start))
        points = [f"({x:.15g} {y:.15g} {z:.15g})" for z in (0, depth) for x, y in self.points]
        note = f'note "nPoints:{len(points)} nCells:{len(self.cells)} nFaces:{len(faces)} nInternalFaces:{len(inner)}";'

        def put(name, kind, entries):
            text = foam_header(kind, name, note) + f"{len(entries)}\n(\n"
            (folder / name).write_text(text + "\n".join(str(e) for e in entries) + "\n)\n")
        put("points", "vectorField", points)
        put("faces", "faceList", faces)
        put("owner", "labelList", owner)
        put("neighbour", "labelList", neighbour)
        put("boundary", "polyBoundaryMesh", [f"{name} {{type {kind}; nFaces {count}; startFace {first};}}" for name, kind, count, first in patches])
        return middles
