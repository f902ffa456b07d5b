# SPDX-License-Identifier: Apache-2.0
"""Faces that the conditions of a deck act on, and the patches that have the same conditions."""
import dataclasses
import itertools
import re

import numpy as np

from couplet.deck.blocks import Block, script


@dataclasses.dataclass(eq=False)
class Condition:
    """Acts on boundary faces, given by their sorted points. `value` has keys of a case, or numbers of a load in units of
    the deck; `block` has their *AMPLITUDE."""

    kind: str
    name: str
    block: Block
    faces: set
    value: object


class Faces:
    """Boundary faces of a mesh by the sets, surfaces and elements of its deck. Lengths are those of the deck."""

    def __init__(self, mesh, is_axisymmetric):
        self.mesh, self.deck, self.is_axisymmetric = mesh, mesh.deck, is_axisymmetric
        self.points = np.array([self.deck.points[label] for label in mesh.point_of])
        self.labels = {label: label for label in self.deck.points}
        self.keys = {key: points for key, points in mesh.outer.items() if points}
        self.at_point = {}
        for key in self.keys:
            for point in key:
                self.at_point.setdefault(point, []).append(key)
        self.key_of = script()["key_of"]

    def members(self, word, sets):
        """Ranges of numbers in a set, or of the number itself. None if there is neither."""
        if number := script()["whole"](word):
            return [range(number, number + 1)]
        found = sets.get(self.key_of(word))
        return found and list(found.all())

    def nodes(self, word):
        """Numbers of the nodes in a set. None without such a set."""
        ranges = self.members(word, self.deck.node_sets)
        return None if ranges is None else set(self.mesh.visit(ranges, self.labels))

    def corners(self, nodes):
        """Points of the mesh among nodes. The others are midside nodes, or those of no cell."""
        return {self.mesh.point_of[node] for node in nodes if node in self.mesh.point_of}

    def between(self, points):
        """Faces all of whose points are among these."""
        return {key for p in points for key in self.at_point.get(p, ()) if points.issuperset(key)}

    def cells(self, word):
        ranges = self.members(word, self.deck.element_sets)
        return None if ranges is None else set(self.mesh.visit(ranges, self.mesh.cell_of))

    def of_cells(self, cells, face):
        """Boundary faces with this number, from 1, of these cells."""
        found = set()
        for c in cells:
            corners = script()["KINDS"][self.mesh.cells[c][2]][2]
            if 0 < face <= len(corners):
                found.add(tuple(sorted(self.mesh.points[c][k] for k in corners[face - 1])))
        return found & self.keys.keys()

    def of_surface(self, word):
        found = set()
        for name, parts, nodes in self.deck.surfaces:
            if name.upper() == self.key_of(word):
                for part, face, _ in parts:
                    found |= self.of_cells(self.mesh.visit(part.all(), self.mesh.cell_of), face + 1)
                found |= self.between(set(self.mesh.visit(nodes.all(), self.mesh.point_of)))
        return found

    def areas(self, faces):
        """Outward area vectors, in two dimensions for unit depth or the whole circumference."""
        areas = []
        for key in faces:
            x = self.points[self.keys[key]]
            if len(key) == 2:
                (dx, dy, _) = x[1] - x[0]
                areas.append(np.array([dy, -dx, 0]) * (np.pi * (x[0, 0] + x[1, 0]) if self.is_axisymmetric else 1))
            else:
                areas.append(sum(np.cross(x[i] - x[0], x[i + 1] - x[0]) for i in range(1, len(x) - 1)) / 2)
        return np.array(areas)

    def area(self, faces):
        return float(np.linalg.norm(self.areas(faces), axis=1).sum())

    def normal(self, faces):
        """Outward normal of a plane patch. None for others."""
        areas = self.areas(faces)
        normals = areas / np.linalg.norm(areas, axis=1)[:, None]
        return normals[0] if np.abs(normals - normals[0]).max() < 1e-6 else None


def divide(faces, conditions):
    """Returns {patch: (conditions, faces)}, and True if these are the patches of the deck itself. Otherwise renames the
    patches of the mesh."""
    mesh = faces.mesh
    of_face = {key: [] for key in faces.keys}
    for condition in conditions:
        for key in condition.faces:
            of_face[key].append(condition)
    groups = {}
    for key, acting in of_face.items():
        groups.setdefault((mesh.patch_of[key], tuple(map(id, acting))), (acting, set()))[1].add(key)
    if len({patch for patch, _ in groups}) == len(groups) and not mesh.has_overlaps:
        return {patch: group for (patch, _), group in groups.items()}, True
    merged = {}
    for (_, acting), (found, keys) in groups.items():
        merged.setdefault(acting, (found, set()))[1].update(keys)
    patches = {}
    for found, keys in merged.values():
        name = re.sub(r"[^\w+-]", "_", "+".join(dict.fromkeys(c.name for c in found)))[:80] or "rest"
        name = next(n for n in itertools.chain([name], (f"{name}-{i}" for i in itertools.count(2))) if n not in patches)
        patches[name] = (found, keys)
        mesh.patch_of.update(dict.fromkeys(keys, name))
    mesh.patches = list(patches)
    return patches, False
