#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Writes a tetrahedral mesh of a porous body like trabecular bone: a gyroid's network cut from a cube of 4 mm.
Usage: generate.py N [FILE]     N: lattice cells along the cube (21: 42 k tetrahedra, 28: 96 k, 69: 1.3 million)
                                FILE: by default porous-N.cache.msh beside this script

Isosurface stuffing (Labelle, Shewchuk 2007): a body-centred cubic lattice; vertices nearer to the surface than a quarter of
the lattice constant are moved onto it, the lattice tetrahedra that still cross it are cut. No edge is cut close to its
end then, so there are no slivers. Vertices on the faces of the cube stay in their face."""
import pathlib
import sys

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

SIDE = 4e-3  # [m]
PERIODS = 2  # of the gyroid along the cube
LEVEL = 0.6  # the body is where the gyroid function exceeds it
SHIFT = np.array([0.31, 0.17, 0.23])  # so that no strut lies on a face of the cube
NEAR = 0.25  # vertices nearer to the surface than this share of the lattice constant move onto it
PATCHES = ("bottom", "top", "sides", "pores")


def gyroid(x):
    s, c = np.sin(2 * np.pi * PERIODS * (x / SIDE + SHIFT)), np.cos(2 * np.pi * PERIODS * (x / SIDE + SHIFT))
    return (s * np.roll(c, -1, axis=-1)).sum(axis=-1) - LEVEL


def gyroid_gradient(x):
    k = 2 * np.pi * PERIODS / SIDE
    s, c = np.sin(k * x + k * SIDE * SHIFT), np.cos(k * x + k * SIDE * SHIFT)
    return k * (c * np.roll(c, -1, axis=-1) - np.roll(s, 1, axis=-1) * s)


def lattice(n):
    """Points of the body-centred cubic lattice in the cube and its tetrahedra that may hold some of the body."""
    corners = np.stack(np.meshgrid(*[np.arange(n + 1)] * 3, indexing="ij"), -1).reshape(-1, 3)
    centres = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), -1).reshape(-1, 3) + 0.5
    points = np.concatenate([corners, centres]) * (SIDE / n)
    corner = np.arange((n + 1) ** 3).reshape([n + 1] * 3)
    centre = (n + 1) ** 3 + np.arange(n**3).reshape([n] * 3)
    solid = gyroid(points) > 0
    kept = []

    def keep(*vertices):
        tets = np.stack([v.ravel() for v in vertices], axis=-1)
        kept.append(tets[solid[tets].any(axis=1)])

    for axis in range(3):
        at = np.moveaxis(corner, axis, 0)
        inside = np.moveaxis(centre, axis, 0)
        ring = [at[:, :-1, :-1], at[:, 1:, :-1], at[:, 1:, 1:], at[:, :-1, 1:]]  # of every face normal to the axis
        for i in range(4):  # two neighbouring centres and an edge of the face between them
            keep(inside[:-1], inside[1:], ring[i][1:-1], ring[(i + 1) % 4][1:-1])
        even = np.add.outer(np.arange(n), np.arange(n)) % 2 == 0
        for face, cell in ((0, 0), (-1, -1)):  # on the cube: two tetrahedra, diagonals alternate
            a, b, c, d = (r[face] for r in ring)
            p, q, r, s = (np.where(even, *pair) for pair in ((a, b), (b, c), (c, d), (d, a)))
            keep(inside[cell], p, q, r)
            keep(inside[cell], p, r, s)
    return points, np.concatenate(kept)


def snap(points, spacing):
    """Moves vertices near the surface onto it; gives the class of each: 1 in the body, 0 on its surface, -1 outside.
    Vertices in a face of the cube move within it; where the surface runs along the face, they stay and count as on it."""
    f, gradient = gyroid(points), gyroid_gradient(points)
    near = np.flatnonzero(np.abs(f) < NEAR * spacing * np.linalg.norm(gradient, axis=1))
    free = ~((points[near] == 0) | (points[near] == points.max()))
    x = points[near].copy()
    for _ in range(8):
        g = gyroid_gradient(x) * free
        length = np.maximum((g**2).sum(axis=1), 1e-30)
        x -= (gyroid(x) / length)[:, None] * g
    good = (np.linalg.norm(x - points[near], axis=1) < 1.3 * NEAR * spacing) & (np.abs(gyroid(x)) < 1e-9)
    points[near[good]] = x[good]
    kind = np.where(f > 0, 1, -1)
    kind[near] = 0
    return kind


def prism_tetrahedra(p):
    """Three tetrahedra of each prism (triangles 012 and 345): every side is cut from its lowest vertex number, so that
    neighbours agree (Dompierre et al. 1999)."""
    turns = np.array([[0, 1, 2, 3, 4, 5], [1, 2, 0, 4, 5, 3], [2, 0, 1, 5, 3, 4],
                      [3, 5, 4, 0, 2, 1], [4, 3, 5, 1, 0, 2], [5, 4, 3, 2, 1, 0]])
    p = np.take_along_axis(p, turns[p.argmin(axis=1)], axis=1)
    one = np.minimum(p[:, 1], p[:, 5]) < np.minimum(p[:, 2], p[:, 4])
    return np.concatenate([p[one][:, t] for t in ([0, 1, 2, 5], [0, 1, 5, 4], [0, 4, 5, 3])] +
                          [p[~one][:, t] for t in ([0, 1, 2, 4], [0, 4, 2, 5], [0, 4, 5, 3])])


def pyramid_tetrahedra(p):
    """Two tetrahedra of each pyramid with base 0123 and tip 4, cut from the lowest vertex number of the base."""
    one = np.minimum(p[:, 0], p[:, 2]) < np.minimum(p[:, 1], p[:, 3])
    return np.concatenate([p[one][:, t] for t in ([0, 1, 2, 4], [0, 2, 3, 4])] +
                          [p[~one][:, t] for t in ([0, 1, 3, 4], [1, 2, 3, 4])])


class Cuts:
    """The points where edges between a vertex in the body and one outside meet the surface, each made once."""

    def __init__(self, points, tets, kind):
        pairs = np.concatenate([tets[:, [i, j]] for i in range(4) for j in range(i)])
        pairs = np.sort(pairs[kind[pairs].prod(axis=1) < 0], axis=1)
        self.n = len(points)
        self.keys = np.unique(pairs[:, 0] * self.n + pairs[:, 1])
        a, b = points[self.keys // self.n], points[self.keys % self.n]
        inside = gyroid(a) > 0
        low, high = np.where(inside[:, None], a, b), np.where(inside[:, None], b, a)
        for _ in range(40):
            middle = (low + high) / 2
            solid = (gyroid(middle) > 0)[:, None]
            low, high = np.where(solid, middle, low), np.where(solid, high, middle)
        self.points = np.where(a == b, a, (low + high) / 2)  # a face of the cube is kept to the last bit

    def at(self, a, b):
        return self.n + np.searchsorted(self.keys, np.minimum(a, b) * self.n + np.maximum(a, b))


def cut(points, tets, kind):
    """The part of the lattice tetrahedra inside the body."""
    order = np.argsort(-kind[tets], axis=1, kind="stable")
    tets = np.take_along_axis(tets, order, axis=1)  # in the body first, outside last
    k = kind[tets]
    inside, outside = (k > 0).sum(axis=1), (k < 0).sum(axis=1)
    cuts = Cuts(points, tets, kind)
    parts = [tets[(outside == 0) & (inside > 0)]]
    tip = tets[(inside == 1) & (outside > 0)]
    out = kind[tip] < 0
    parts.append(np.where(out, cuts.at(np.where(out, tip[:, :1], cuts.keys[0] // cuts.n),
                                       np.where(out, tip, cuts.keys[0] % cuts.n)), tip))
    a, b, z, m = tets[(inside == 2) & (outside == 1)].T
    parts.append(pyramid_tetrahedra(np.stack([a, b, cuts.at(b, m), cuts.at(a, m), z], axis=1)))
    a, b, m, n = tets[(inside == 2) & (outside == 2)].T
    parts.append(prism_tetrahedra(np.stack([a, cuts.at(a, m), cuts.at(a, n), b, cuts.at(b, m), cuts.at(b, n)], axis=1)))
    a, b, c, m = tets[(inside == 3) & (outside == 1)].T
    parts.append(prism_tetrahedra(np.stack([a, b, c, cuts.at(a, m), cuts.at(b, m), cuts.at(c, m)], axis=1)))
    return np.concatenate([points, cuts.points]), np.concatenate(parts)


def faces_of(tets):
    """All faces, sorted vertices, and which are the same: (faces, number of the face, times it is there)."""
    faces = np.sort(np.concatenate([tets[:, t] for t in ([1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2])]), axis=1)
    n = np.int64(tets.max()) + 1
    key = (faces[:, 0] * n + faces[:, 1]).astype(np.int64)
    order = np.lexsort((faces[:, 2], key))
    new = np.ones(len(faces), bool)
    new[1:] = (np.diff(key[order]) != 0) | (np.diff(faces[order, 2]) != 0)
    number = np.empty(len(faces), np.int64)
    number[order] = np.cumsum(new) - 1
    return faces, number, np.bincount(number)


def largest_piece(tets):
    """Returns the mesh without the pieces that the faces of the cube cut off from the body."""
    _, number, count = faces_of(tets)
    cell = np.tile(np.arange(len(tets)), 4)
    shared = np.flatnonzero(count[number] == 2)
    pairs = cell[shared[np.argsort(number[shared], kind="stable")]].reshape(-1, 2)
    graph = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(tets), len(tets)))
    _, label = connected_components(graph, directed=False)
    return tets[label == np.bincount(label).argmax()]


def volumes(points, tets):
    a, b, c, d = (points[tets[:, i]] for i in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


def smallest_angles(points, tets):
    """Smallest and largest angle between two faces of each tetrahedron [degrees]."""
    normals = []
    for t in ([1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]):
        n = np.cross(points[tets[:, t[1]]] - points[tets[:, t[0]]], points[tets[:, t[2]]] - points[tets[:, t[0]]])
        normals.append(n / np.linalg.norm(n, axis=1)[:, None])
    cosines = np.stack([-np.einsum("ij,ij->i", normals[i], normals[j]) for i in range(4) for j in range(i)])
    return np.degrees(np.arccos(np.clip(cosines.max(axis=0), -1, 1))), np.degrees(np.arccos(np.clip(cosines.min(axis=0), -1, 1)))


def make(n):
    """Returns (points, tetrahedra, boundary triangles, patch of each triangle)"""
    points, tets = lattice(n)
    kind = snap(points, SIDE / n)
    points, tets = cut(points, tets, kind)
    tets = largest_piece(tets)
    used, tets = np.unique(tets, return_inverse=True)
    points, tets = points[used], tets.reshape(-1, 4)
    negative = volumes(points, tets) < 0
    tets[negative] = tets[negative][:, [0, 1, 3, 2]]
    faces, number, count = faces_of(tets)
    outside = faces[count[number] == 1]
    at = points[outside]
    low, high = (at == 0).all(axis=1), (at == SIDE).all(axis=1)
    patch = np.select([low[:, 2], high[:, 2], (low | high)[:, :2].any(axis=1)], [0, 1, 2], 3)
    return points, tets, outside, patch


def write_msh(file, points, tets, triangles, patch):
    """gmsh 2.2, binary."""
    names = [f'2 {i + 1} "{name}"' for i, name in enumerate(PATCHES)] + ['3 5 "body"']
    nodes = np.empty(len(points), dtype=[("id", "<i4"), ("x", "<f8", 3)])
    nodes["id"], nodes["x"] = np.arange(1, len(points) + 1), points

    def elements(kind, vertices, tag, first):
        rows = np.empty((len(vertices), 3 + vertices.shape[1]), "<i4")
        rows[:, 0] = np.arange(first, first + len(vertices))
        rows[:, 1] = rows[:, 2] = tag
        rows[:, 3:] = vertices + 1
        return np.array([kind, len(vertices), 2], "<i4").tobytes() + rows.tobytes()

    with open(file, "wb") as f:
        f.write(b"$MeshFormat\n2.2 1 8\n" + np.array(1, "<i4").tobytes() + b"\n$EndMeshFormat\n")
        f.write("\n".join(["$PhysicalNames", str(len(names)), *names, "$EndPhysicalNames", ""]).encode())
        f.write(f"$Nodes\n{len(points)}\n".encode() + nodes.tobytes() + b"\n$EndNodes\n")
        f.write(f"$Elements\n{len(triangles) + len(tets)}\n".encode())
        f.write(elements(2, triangles, patch + 1, 1))
        f.write(elements(4, tets, 5, 1 + len(triangles)))
        f.write(b"\n$EndElements\n")


def main():
    if len(sys.argv) not in (2, 3) or not sys.argv[1].isdigit() or int(sys.argv[1]) < 8:
        sys.exit(__doc__)
    n = int(sys.argv[1])
    file = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else pathlib.Path(__file__).resolve().parent / f"porous-{n}.cache.msh")
    points, tets, triangles, patch = make(n)
    write_msh(file, points, tets, triangles, patch)
    volume = volumes(points, tets)
    least, most = smallest_angles(points, tets)
    print(f"{len(tets)} tetrahedra, {len(triangles)} boundary faces ({', '.join(f'{name} {(patch == i).sum()}' for i, name in enumerate(PATCHES))}), "
          f"{len(points)} points; solid fraction {volume.sum() / SIDE**3:.4f}; angles between faces {least.min():.1f} to "
          f"{most.max():.1f} degrees; smallest volume {volume.min() / volume.mean():.1e} of the mean: {file}")


if __name__ == "__main__":
    main()
