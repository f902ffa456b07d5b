# SPDX-License-Identifier: Apache-2.0
"""Finite elements by their number of points: shape functions, edges, faces, and positions within them.

Points are corners, then middles of edges in gmsh's order. Shape functions span MONOMIALS; each is 1 at one point and 0
at the others."""
import functools

import numpy as np
from scipy.spatial import cKDTree

CORNERS = {"line": 2, "triangle": 3, "quadrilateral": 4, "tetrahedron": 4, "hexahedron": 8, "prism": 6}
EDGES = {
    "line": ((0, 1),),
    "triangle": ((0, 1), (1, 2), (2, 0)),
    "quadrilateral": ((0, 1), (1, 2), (2, 3), (3, 0)),
    "tetrahedron": ((0, 1), (1, 2), (2, 0), (3, 0), (2, 3), (1, 3)),
    "hexahedron": ((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)),
    "prism": ((0, 1), (0, 2), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5)),
}
FACES = {
    "triangle": ((0, 1), (1, 2), (2, 0)),
    "quadrilateral": ((0, 1), (1, 2), (2, 3), (3, 0)),
    "tetrahedron": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
    "hexahedron": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    "prism": ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
}
NODES = {
    "line": ((-1,), (1,)),
    "triangle": ((0, 0), (1, 0), (0, 1)),
    "quadrilateral": ((-1, -1), (1, -1), (1, 1), (-1, 1)),
    "tetrahedron": ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "hexahedron": ((-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)),
    "prism": ((0, 0, -1), (1, 0, -1), (0, 1, -1), (0, 0, 1), (1, 0, 1), (0, 1, 1)),
}
CENTRES = {
    "line": (0,),
    "triangle": (1 / 3, 1 / 3),
    "quadrilateral": (0, 0),
    "tetrahedron": (0.25, 0.25, 0.25),
    "hexahedron": (0, 0, 0),
    "prism": (1 / 3, 1 / 3, 0),
}


def exponents(shape, order):
    """Monomials of a shape: complete polynomials for simplices, serendipity (at most one square) for others."""
    d, high = len(CENTRES[shape]), order + 1
    every = np.stack(np.meshgrid(*[np.arange(high)] * d, indexing="ij"), axis=-1).reshape(-1, d)
    if shape in ("triangle", "tetrahedron", "line"):
        return every[every.sum(axis=1) <= order]
    if shape == "prism":
        return (
            every[(every[:, :2].sum(axis=1) <= order) & (every[:, :2].sum(axis=1) + every[:, 2] <= order + 1)]
            if order == 2
            else every[every[:, :2].sum(axis=1) <= 1]
        )
    return every[(every == 2).sum(axis=1) <= 1]


@functools.cache
def basis(shape, order):
    """Returns (exponents, coefficients), where column i of the coefficients is shape function i."""
    nodes = np.array(NODES[shape], float)
    if order == 2:
        nodes = np.vstack([nodes, [(nodes[a] + nodes[b]) / 2 for a, b in EDGES[shape]]])
    powers = exponents(shape, order)
    return powers, np.linalg.inv(np.prod(nodes[:, None, :] ** powers, axis=2))


def shape_functions(shape, order, at):
    """Values (n, points) at reference coordinates `at` (n, d)."""
    powers, coefficients = basis(shape, order)
    return np.prod(np.asarray(at, float)[:, None, :] ** powers, axis=2) @ coefficients


def derivatives(shape, order, at):
    """Derivatives (n, d, points) at reference coordinates."""
    powers, coefficients = basis(shape, order)
    at, found = np.asarray(at, float), []
    for axis in range(powers.shape[1]):
        lower = powers.copy()
        lower[:, axis] = np.maximum(lower[:, axis] - 1, 0)
        found.append((powers[:, axis] * np.prod(at[:, None, :] ** lower, axis=2)) @ coefficients)
    return np.stack(found, axis=1)


@functools.cache
def quadrature(shape):
    """Returns (points, weights), exact for the loads of second-order faces."""
    g, w = np.polynomial.legendre.leggauss(3)
    if shape == "line":
        return g[:, None], w
    if shape == "quadrilateral":
        return np.array([(a, b) for a in g for b in g]), np.array([p * q for p in w for q in w])
    s = np.sqrt(15)  # seven points of degree five (Radon 1948)
    a, b = (6 - s) / 21, (6 + s) / 21
    places = [(1 / 3, 1 / 3), *(p for c in (a, b) for p in ((c, c), (1 - 2 * c, c), (c, 1 - 2 * c)))]
    return np.array(places), np.array([9 / 80, *[(155 - s) / 2400] * 3, *[(155 + s) / 2400] * 3])


def excess(shape, at):
    """Distance of positions outside the reference element."""
    at = np.asarray(at)
    if shape in ("quadrilateral", "hexahedron"):
        return np.maximum(np.abs(at).max(axis=1) - 1, 0)
    flat = at[:, :3] if shape == "tetrahedron" else at[:, :2]
    outside = np.maximum(np.maximum(-flat.min(axis=1), flat.sum(axis=1) - 1), 0)
    return np.maximum(outside, np.abs(at[:, 2]) - 1) if shape == "prism" else outside


def inverse(shape, order, points, place):
    """Reference coordinates of a position in the element with these points (n, d), by Newton's method."""
    at = np.array([CENTRES[shape]], float)
    for _ in range(25):
        step = np.linalg.solve(
            (derivatives(shape, order, at)[0] @ points).T, place - shape_functions(shape, order, at)[0] @ points
        )
        at = np.clip(at + step, -3, 3)
        if np.abs(step).max() < 1e-12:
            break
    return at


def weights_at(mesh, place):
    """Returns (points, weights) that interpolate at a position, in the element that contains it or is closest to it."""
    best, place = None, np.asarray(place, float)[: mesh.dimension]
    for shape, cells in mesh.cells.items():
        corners = mesh.points[cells[:, : CORNERS[shape]], : mesh.dimension]
        _, near = cKDTree(corners.mean(axis=1)).query(place, k=min(24, len(cells)))
        for cell in np.atleast_1d(near):
            at = inverse(shape, mesh.order, mesh.points[cells[cell], : mesh.dimension], place)
            out = excess(shape, at)[0]
            if best is None or out < best[0] - 1e-9:
                best = out, cells[cell], shape_functions(shape, mesh.order, at)[0]
    return best[1:]
