# SPDX-License-Identifier: Apache-2.0
"""Draws cells of a mesh: a map in two dimensions, the cut of a plane through a body, and a view of its surface."""
import matplotlib
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import offset_copy

from couplet.runs.case import expect

# Faces of a cell by its number of points, as positions in the cell (VTK order).
FACES = {
    4: ((0, 1, 2), (0, 1, 3), (1, 2, 3), (0, 2, 3)),
    5: ((0, 1, 2, 3), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
    6: ((0, 1, 2), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    8: ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
}
EDGES = {
    n: np.array(sorted({tuple(sorted((f[k - 1], f[k]))) for f in faces for k in range(len(f))}))
    for n, faces in FACES.items()
}
SHELLS = (4, 5)  # XDMF codes of triangles and quadrilaterals, which are their own faces
MOST_FACES = 200000
MOST_LINES = 5000  # cells; the lines of a finer mesh would hide its colors
BODY = "#b0b0b0"  # color of a body in a flow
THIN = 0.4  # [inch]; a shorter axis has no room for ticks


def groups(series):
    """Yields (whether they are shells, numbers, points (cells, n)) of cells with the same kind."""
    codes = np.asarray(series.codes)
    for code in np.unique(codes):
        numbers = np.flatnonzero(codes == code)
        yield code in SHELLS, numbers, np.array([series.cells[k] for k in numbers])


def outer_faces(series):
    """Returns [(points, cell)] of the faces that belong to only one cell."""
    found, solid = [], []
    for shell, numbers, cells in groups(series):
        if shell:
            found += [(list(map(int, cell)), int(k)) for cell, k in zip(cells, numbers)]
            continue
        for face in FACES[cells.shape[1]]:
            corners = np.full((len(cells), 4), -1)
            corners[:, : len(face)] = cells[:, face]
            solid.append((corners, numbers))
    if solid:
        corners, numbers = (np.concatenate(part) for part in zip(*solid))
        _, first, count = np.unique(np.sort(corners, axis=1), axis=0, return_index=True, return_counts=True)
        for k in np.sort(first[count == 1]):
            found.append(([int(p) for p in corners[k] if p >= 0], int(numbers[k])))
    return found


def plane_of(text, where):
    """Axis and level of a plane such as `y = 0`."""
    axis, _, level = str(text).replace(" ", "").partition("=")
    try:
        level = float(level)
    except ValueError:
        level = np.nan
    expect(axis in ("x", "y", "z") and np.isfinite(level), f"{where}: '{text}'; expected a plane such as y = 0.")
    return "xyz".index(axis), level


def cut(series, points, axis, level):
    """Polygons in which a plane cuts the cells of the mesh at rest, and their cells. A face in the plane belongs to the
    cell above it, or to that below if there is none."""
    still = series.reference()
    others, height = [k for k in range(3) if k != axis], still[:, axis] - level
    height[np.abs(height) < 1e-6 * np.ptp(still, axis=0).max()] = 0
    found, touching = [], {}
    for shell, numbers, cells in groups(series):
        heights = height[cells]
        is_cut = (heights.min(axis=1) < 0) & (heights.max(axis=1) > 0)
        n = cells.shape[1]
        edges = np.array([(k, (k + 1) % n) for k in range(n)]) if shell else EDGES[n]
        for number, cell in zip(numbers[is_cut], cells[is_cut]):
            on = cell[height[cell] == 0]
            begin, end = cell[edges].T
            through = height[begin] * height[end] < 0
            begin, end = begin[through], end[through]
            share = (height[begin] / (height[begin] - height[end]))[:, None]
            there, here = (np.concatenate([p[begin] + share * (p[end] - p[begin]), p[on]]) for p in (still, points))
            found.append((number, here[around(there[:, others])][:, others]))
        for number, cell in zip(numbers[~is_cut], cells[~is_cut]):
            on = cell[height[cell] == 0]
            key = tuple(sorted(on))
            if len(on) > 2 and (key not in touching or height[cell].sum() > 0):
                touching[key] = (number, points[on[around(still[on][:, others])]][:, others])
    found = sorted([*found, *touching.values()], key=lambda pair: pair[0])
    return [polygon for _, polygon in found], np.array([number for number, _ in found], int)


def around(corners):
    """Order of the corners of a convex polygon around its middle."""
    way = corners - corners.mean(axis=0)
    return np.argsort(np.arctan2(way[:, 1], way[:, 0]))


def polygons_of(series, points, plane, where):
    """Returns (corners, cells, axes) of the cells in two dimensions, or of a plane such as y = 0 through a body in its
    two other axes."""
    if series.is_flat():
        return [points[cell][:, :2] for cell in series.cells], np.arange(len(series.cells)), "xy"
    where = f"{where}.plane" if where else "--plane"
    axis, level = plane_of(plane, where)
    polygons, cells = cut(series, points, axis, level)
    still, name = series.reference()[:, axis], "xyz"[axis]
    expect(
        polygons,
        f"{where}: no cell meets the plane {plane}: {name} goes from {still.min():.4g} to {still.max():.4g} m.",
    )
    return polygons, cells, "xyz".replace(name, "")


def flat_map(axes, polygons, values, colours=None, lines=None, width=0.07):
    """Map of values on polygons. Values of both signs have colors that diverge from zero. `lines` is the color of the
    mesh, which a fine one has not."""
    finite = values[np.isfinite(values)]
    least, most = (finite.min(), finite.max()) if finite.size else (0, 0)
    is_signed = min(-least, most) > 0.1 * max(-least, most)
    drawn = PolyCollection(
        polygons,
        array=values,
        cmap=colours or ("RdBu_r" if is_signed else "viridis"),
        edgecolors="none",
        antialiaseds=False,
    )  # smoothed edges would leave white lines
    if is_signed:
        drawn.set_clim(-max(-least, most), max(-least, most))
    axes.add_collection(drawn)
    if lines and len(polygons) <= MOST_LINES:
        axes.add_collection(PolyCollection(polygons, facecolors="none", edgecolors=lines, linewidths=width, alpha=0.4))
    axes.autoscale()
    axes.set_aspect("equal")
    return drawn


def body_on(axes, body, points, plane, ways, colour, label=None):
    """Draws a body in a flow: its cells, the cut through it, or its shadow where the plane does not meet it."""
    ways = ["xyz".index(w) for w in ways]
    polygons = cut(body, points, *plane)[0] if plane and not body.is_flat() else []
    if not polygons:
        faces = body.cells if body.is_flat() else [face for face, _ in outer_faces(body)]
        polygons = [points[face][:, ways] for face in faces]
    # An edge of the same color closes seams, and shows a shell that is seen from its side.
    axes.add_collection(PolyCollection(polygons, facecolors=colour, edgecolors=colour, linewidths=0.6, label=label))


def outline_on(axes, series, points, colour="black", width=0.8):
    """Draws the boundary of a 2-D mesh."""
    edges = series.edges_on_boundary()
    if len(edges):
        axes.add_collection(LineCollection(points[edges][:, :, :2], colors=colour, linewidths=width))


def sight(points):
    """Directions to the right, upward and toward the observer, with z upward and the longer of x and y to the right."""
    size = np.ptp(points, axis=0)
    turn, up = np.radians(-60 if size[0] >= size[1] else -30), np.radians(30)
    return np.array(
        [
            [-np.sin(turn), np.cos(turn), 0],
            [-np.sin(up) * np.cos(turn), -np.sin(up) * np.sin(turn), np.cos(up)],
            [np.cos(up) * np.cos(turn), np.cos(up) * np.sin(turn), np.sin(up)],
        ]
    )


def in_space(axes, points, faces, values, limits=None, colours=None):
    """Draws faces [(points, number of the value)] of a body in space, from behind to front. Returns the color scale.
    Arrows in the corner show the axes."""
    expect(len(faces) <= MOST_FACES, f"{len(faces)} outer faces are too many for a picture: open the .xdmf in ParaView")
    shown = np.array([values[cell] for _, cell in faces])
    low, high = limits or (np.nanmin(values), np.nanmax(values))
    scale = matplotlib.cm.ScalarMappable(matplotlib.colors.Normalize(low, high), colours or "viridis")
    directions = sight(points)
    seen = points @ directions.T
    corners = [seen[face] for face, _ in faces]
    order = np.argsort([c[:, 2].mean() for c in corners])
    normals = np.array([np.cross(c[1] - c[0], c[-1] - c[0]) for c in corners])
    bright = np.abs(normals @ [0.3, 0.5, 0.8]) / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)
    colors = scale.to_rgba(shown)
    colors[:, :3] *= (0.8 + 0.2 * bright.clip(0, 1))[:, None]
    lines = {"edgecolors": (0, 0, 0, 0.25), "linewidths": 0.2} if len(faces) <= MOST_LINES else {"edgecolors": "face"}
    axes.add_collection(
        PolyCollection([corners[k][:, :2] for k in order], facecolors=colors[order], **{"linewidths": 0.2, **lines})
    )
    axes.autoscale()
    axes.set_aspect("equal")
    axes.set(xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set_visible(False)
    corner = offset_copy(axes.transAxes, axes.figure, x=-14, y=24, units="points")
    for name, way in zip("xyz", directions.T):
        axes.annotate(
            name,
            (0, 0),
            xytext=(26 * way[0], 26 * way[1]),
            xycoords=corner,
            textcoords="offset points",
            arrowprops={"arrowstyle": "<-", "lw": 0.7, "shrinkB": 0, "shrinkA": 0},
            ha="center",
            va="center",
            fontsize=8,
        )
    return scale


def extent_of(points):
    """Text such as "x 0 to 2, y 0 to 0.1 m"."""
    low, high = points.min(axis=0), points.max(axis=0)
    low, high = (np.where(np.abs(v) < 1e-9 * np.ptp(points, axis=0).max(), 0, v) for v in (low, high))
    return ", ".join(f"{name} {a:.4g} to {b:.4g}" for name, a, b in zip("xyz", low, high) if b > a) + " m"


def shape_of(corners):
    """Width and height of the picture [inch] of a body with these corners, the inches of its axes, and on which side
    the color scale has room."""
    width, height = np.maximum(np.ptp(corners, axis=0)[:2], 1e-300)
    ratio = height / width
    if ratio < 0.5:
        inches = (8.0, 8.0 * ratio)
        return (9.2, inches[1] + 1.9), inches, "bottom"
    inches = (6.3, 6.3 * ratio) if ratio < 1 else (6.3 / ratio, 6.3)
    return (max(4.5, inches[0] + 2.2), inches[1] + 1.1), inches, "right"


def ticks_on(axes, inches, still):
    """As many ticks as there is room for. An axis without room has the extent of the body at rest in its label."""
    for axis, room, places in zip((axes.xaxis, axes.yaxis), inches, still):
        if room < THIN:
            name = axis.get_label_text().partition(" [")[0]
            axis.set_ticks([])
            axis.set_label_text(f"{name} {places.min():.4g} to {places.max():.4g} m", fontsize=8)
            if axis is axes.yaxis:
                axis.label.set(rotation=0, horizontalalignment="right", verticalalignment="center")
        else:
            axis.set_major_locator(MaxNLocator(nbins=max(1, int(room * (1.3 if axis is axes.xaxis else 1.8)))))
