# SPDX-License-Identifier: Apache-2.0
"""Plots fields with matplotlib: displaced 2-D cells or, in 3-D, outer faces; patches over the arc length or, in 3-D,
their faces."""
from __future__ import annotations

import pathlib

import numpy as np

from couplet import files
from couplet.runs.case import Wrong, expect
from couplet.series import find_series, find_surface, surface_names

# Faces of a cell by its number of points, as positions in the cell (VTK order).
FACES = {
    4: ((0, 1, 2), (0, 1, 3), (1, 2, 3), (0, 2, 3)),
    5: ((0, 1, 2, 3), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
    6: ((0, 1, 2), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    8: ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
}
MOST_FACES = 60000


def is_shape(name):
    """File of a shape, such as buckling-1 or mode-1; None for other fields."""
    return {"buckling": "buckling.h5", "mode": "mode-shapes.h5"}.get(name.rpartition("-")[0])


def series_of(folder, name):
    """Series with this field in a participant's folder, or of the first participant with fields below an output
    folder."""
    for place in (folder, *sorted(p for p in folder.iterdir() if p.is_dir())):
        try:
            return find_series(place, is_shape(name) or "*.h5")
        except FileNotFoundError:
            continue
    raise Wrong(f"{folder}: there is no field series (.h5) in it")


def surface_of(folder, patch):
    """Surface of a participant's folder, or of the first participant that wrote this patch below an output folder."""
    places = [folder, *sorted(p for p in folder.iterdir() if p.is_dir())]
    for place in places:
        if patch in surface_names(place):
            return find_surface(place, patch)
    there = sorted({name for place in places for name in surface_names(place)})
    raise Wrong(
        f"{folder}: there is no surface '{patch}'; "
        + (f"there is: {', '.join(there)}" if there else "`output.surfaces` of a case names what is written")
    )


def values_of(series, i, name, component):
    """One number per cell: a component or the magnitude of a vector; for points the mean over the cell."""
    expect(name in series.names(i), f"there is no field '{name}'; there are: {', '.join(series.names(i))}")
    field = np.asarray(series.field(i, name), float)
    field = field[:, None] if field.ndim == 1 else field
    if component is None:
        field = field[:, 0] if field.shape[1] == 1 else np.linalg.norm(field[:, :3], axis=1)
    else:
        expect(component in "xyz" and "xyz".index(component) < field.shape[1], f"'{name}' has no component {component}")
        field = field[:, "xyz".index(component)]
    return np.array([field[cell].mean() for cell in series.cells]) if series.is_at_points(i, name) else field


def places_of(series, i, warp, name):
    """Positions of the points: as written; for a displacement the reference points plus `warp` times it; for a shape
    displaced by a tenth of the body's size."""
    points = np.array(series.coordinates(i), float)
    if is_shape(name):
        move = np.asarray(series.field(i, name), float)[:, : points.shape[1]]
        points[:, : move.shape[1]] += (
            0.1 * warp * np.ptp(points, axis=0).max() / np.linalg.norm(move, axis=1).max() * move
        )
    elif "displacement" in series.names(i) and series.is_at_points(i, "displacement"):
        points = np.array(series.reference(), float)  # the written points already include the displacement
        move = np.asarray(series.field(i, "displacement"), float)
        points[:, : move.shape[1]] += warp * move[:, : points.shape[1]]
    return points


def outer_faces(series):
    """Returns [(points, cell)] of the faces that belong to only one cell."""
    seen = {}
    for number, cell in enumerate(series.cells):
        for face in FACES[len(cell)]:
            points = [int(cell[k]) for k in face]
            key = tuple(sorted(points))
            seen[key] = None if key in seen else (points, number)
    return [face for face in seen.values() if face]


def in_plane(figure, points, series, values):
    from matplotlib.collections import PolyCollection

    axes = figure.add_subplot()
    drawn = PolyCollection(
        [points[cell][:, :2] for cell in series.cells], array=values, cmap="viridis", edgecolors="face", linewidths=0.2
    )
    axes.add_collection(drawn)
    axes.autoscale()
    axes.set_aspect("equal")
    axes.set(xlabel="x [m]", ylabel="y [m]")
    return drawn


def along(figure, points, surface, values, i):
    """Plots over the arc length of the patch, with one line per part."""
    axes = figure.add_subplot()
    begin = 0.0
    for edges, corners in surface.chains(i):
        way = begin + np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points[corners], axis=0), axis=1))])
        axes.plot(0.5 * (way[1:] + way[:-1]), values[edges], lw=1.2, marker="." if len(edges) < 60 else None)
        begin = way[-1]
    axes.set(xlabel=f"arc length along {surface.name} [m]")
    axes.grid(alpha=0.3)
    return axes


def in_space(figure, points, series, values, faces=None, place=(1, 1, 1)):
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    faces = faces or outer_faces(series)
    expect(
        len(faces) <= MOST_FACES, f"{len(faces)} outer faces are too many for matplotlib: open the .xdmf in ParaView"
    )
    import matplotlib

    shown = np.array([values[cell] for _, cell in faces])
    scale = matplotlib.cm.ScalarMappable(matplotlib.colors.Normalize(np.nanmin(values), np.nanmax(values)), "viridis")
    axes = figure.add_subplot(*place, projection="3d")
    axes.add_collection3d(
        Poly3DCollection(
            [points[face] for face, _ in faces],
            facecolors=scale.to_rgba(shown),
            edgecolors=(0, 0, 0, 0.15),
            linewidths=0.2,
        )
    )
    low, high = points.min(axis=0), points.max(axis=0)
    axes.set(
        xlim=(low[0], high[0]),
        ylim=(low[1], high[1]),
        zlim=(low[2], high[2]),
        xlabel="x [m]",
        ylabel="y [m]",
        zlabel="z [m]",
    )
    axes.set_box_aspect(np.maximum(high - low, 0.05 * (high - low).max()))
    return scale


def label_of(series, i, name, component):
    place = "cells" if not series.is_at_points(i, name) else "points"
    unit = series.file["steps"][series.steps[i]][place][name].attrs.get("unit", "")
    unit = unit.decode() if isinstance(unit, bytes) else unit
    return f"{name}{f' {component}' if component else ''} [{unit or '-'}]"


def new_figure(width, height, dpi):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    return plt.figure(figsize=(width, height), dpi=dpi, constrained_layout=True)


def saved(figure, title, picture, folder, usual):
    """Adds the title and writes the picture, which has its usual name below `folder` if none is given. Returns its
    path."""
    import matplotlib.pyplot as plt

    figure.axes[0].set_title(title, fontsize=10)
    base, picture = (pathlib.Path(picture).parent, pathlib.Path(picture)) if picture else (pathlib.Path(folder), usual)
    with files.part(base, picture.relative_to(base)) as made:
        figure.savefig(made)
    plt.close(figure)
    return picture


def output_near(series, at):
    expect(series.steps, f"{series.file.filename}: there is no output in it yet")
    return len(series.times) - 1 if at is None else series.nearest(at)


def draw_surface(
    folder: str | pathlib.Path,
    name: str,
    patch: str,
    picture: str | pathlib.Path | None = None,
    at: float | None = None,
    component: str | None = None,
    warp: float = 1.0,
    dpi: int = 110,
) -> pathlib.Path:
    """Draws a field on a patch (`output.surfaces`) at one output: in 2-D over the arc length, in 3-D on its faces. `at`
    is a time [s]; `component` is "x", "y" or "z", without which a vector is drawn by its magnitude; displacements are
    drawn `warp` times as large. Returns the picture's path."""
    surface = surface_of(pathlib.Path(folder), patch)
    i = output_near(surface, at)
    values, label, plane = (
        values_of(surface, i, name, component),
        label_of(surface, i, name, component),
        surface.is_plane(),
    )
    figure = new_figure(8, 4 if plane else 6, dpi)
    if plane:
        along(figure, places_of(surface, i, 0, name), surface, values, i).set_ylabel(label)
    else:
        faces = [(list(map(int, face)), number) for number, face in enumerate(surface.cells)]
        scale = in_space(figure, places_of(surface, i, warp, name), surface, values, faces)
        figure.colorbar(scale, ax=figure.axes[0], shrink=0.8, label=label)
    return saved(
        figure,
        f"{patch}, t = {surface.times[i]:.4g} s",
        picture,
        folder,
        pathlib.Path(surface.file.filename).with_name(f"{surface.name}-{name}.png"),
    )


def draw(
    folder: str | pathlib.Path,
    name: str,
    picture: str | pathlib.Path | None = None,
    at: float | None = None,
    component: str | None = None,
    warp: float = 1.0,
    dpi: int = 110,
) -> pathlib.Path:
    """Draws a field of one output (the last, or the one closest to the time `at` [s]), with the arguments of
    draw_surface(). Returns the picture's path."""
    series = series_of(pathlib.Path(folder), name)
    i = output_near(series, at)
    values, points = values_of(series, i, name, component), places_of(series, i, warp, name)
    flat, size = series.is_flat(), np.ptp(points, axis=0)
    figure = new_figure(8, min(8, max(2.4, 1.2 + 7 * size[1] / size[0])) if flat else 6, dpi)
    drawn = (in_plane if flat else in_space)(figure, points, series, values)
    figure.colorbar(drawn, ax=figure.axes[0], shrink=0.8, label=label_of(series, i, name, component))
    return saved(
        figure,
        f"t = {series.times[i]:.4g} s",
        picture,
        folder,
        pathlib.Path(series.file.filename).with_name(f"{name}.png"),
    )


def draw_mode(
    folder: str | pathlib.Path, number: int, picture: str | pathlib.Path | None = None, dpi: int = 110
) -> pathlib.Path:
    """Draws a mode of modes.h5 (docs/formats.md) on the surface, with a maximum displacement of a tenth of the size.
    Returns the picture's name."""
    import h5py

    file = next(
        (
            f
            for f in (pathlib.Path(folder) / "modes.h5", *sorted(pathlib.Path(folder).glob("*/modes.h5")))
            if f.exists()
        ),
        None,
    )
    expect(file, f"{folder}: there is no modes.h5 in it")
    with h5py.File(file) as modes:
        frequency = modes["frequency"][...]
        expect(1 <= number <= len(frequency), f"mode {number} does not exist; the file has {len(frequency)} modes")
        points, ends, corners = (modes[f"surface/{name}"][...] for name in ("vertices", "face-offset", "face-vertex"))
        shape = modes["shape/vertices"][...][:, number - 1].reshape(-1, 3)
    length = np.linalg.norm(shape, axis=1)
    moved = points + 0.1 * np.ptp(points, axis=0).max() / length.max() * shape
    faces = [(corners[a:b].astype(int), k) for k, (a, b) in enumerate(zip(ends[:-1].astype(int), ends[1:].astype(int)))]
    figure = new_figure(8, 6, dpi)
    in_space(figure, moved, None, np.array([length[f].mean() for f, _ in faces]) / length.max(), faces)
    return saved(
        figure, f"mode {number}: {frequency[number - 1]:.4g} Hz", picture, folder, file.with_name(f"mode-{number}.png")
    )
