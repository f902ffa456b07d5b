# SPDX-License-Identifier: Apache-2.0
"""Plots fields with matplotlib: displaced 2-D cells; in 3-D the outer faces, or the cut of a plane; patches over the
arc length or, in 3-D, their faces; shapes of vibration and of buckling."""
from __future__ import annotations

import math
import pathlib

import numpy as np

from couplet import files
from couplet.plots import space
from couplet.runs.case import Wrong, expect, load
from couplet.runs.results import read_csv
from couplet.series import FieldSeries, find_series, find_surface, surface_names

MOST_SHAPES = 6
VISIBLE = 0.02  # of the size of a body: smaller displacements are drawn enlarged
RIGID = 1e-3  # of the largest frequency
SHAPE_TABLES = {  # with the numbers of the shapes in a file
    "mode-shapes.h5": ("modes.csv", "frequency"),
    "modes-shapes.h5": ("frequencies.csv", "frequency"),
    "buckling.h5": ("buckling.csv", "factor"),
}
PREFIXES = {"Pa": ("kPa", "MPa", "GPa"), "m": ("mm", "um", "nm")}  # steps of a thousand


def is_shape(name):
    """File of a shape, such as buckling-1 or mode-1; None for other fields."""
    return {"buckling": "buckling.h5", "mode": "mode-shapes.h5"}.get(name.rpartition("-")[0])


def places_below(folder):
    """A participant's folder, or those of the participants below an output folder."""
    folder = pathlib.Path(folder)
    return [folder, *sorted(p for p in folder.iterdir() if p.is_dir())]


def series_of(folder, name):
    """Series with this field in a participant's folder, or of the first participant with it below an output folder."""
    found = []
    for place in places_below(folder):
        try:
            found.append(find_series(place, is_shape(name) or "*.h5"))
        except FileNotFoundError:
            continue
        if found[-1].steps and name in found[-1].names(-1):
            return found[-1]
    expect(found, f"{folder}: there is no field series (.h5) in it")
    there = dict.fromkeys(n for series in found if series.steps for n in series.names(-1))
    expect(not there, f"there is no field '{name}'; the fields are: {', '.join(there)}")
    return found[0]


def surface_of(folder, patch):
    """Surface of a participant's folder, or of the first participant that wrote this patch below an output folder."""
    places = places_below(folder)
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
    expect(name in series.names(i), f"there is no field '{name}'; the fields are: {', '.join(series.names(i))}")
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


def warp_of(series, i):
    """Round factor that makes a displacement visible: a tenth of the body's size at most, and 1 if it is visible as it
    is."""
    if "displacement" not in series.names(i):
        return 1.0
    most, size = np.abs(series.field(i, "displacement")).max(), np.ptp(series.reference(), axis=0).max()
    if most == 0 or most >= VISIBLE * size:
        return 1.0
    power = 10.0 ** math.floor(math.log10(0.1 * size / most))
    return max(k * power for k in (1, 2, 5) if k * power <= 0.1 * size / most)


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

    if title:
        narrow = figure.get_figwidth() < 6
        figure.axes[0].set_title(title.replace(", displacement", ",\ndisplacement") if narrow else title, fontsize=10)
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
    if plane:
        figure = new_figure(8, 4, dpi)
        along(figure, places_of(surface, i, 0, name), surface, values, i).set_ylabel(label)
    else:
        faces = [(list(map(int, face)), number) for number, face in enumerate(surface.cells)]
        figure = view(places_of(surface, i, warp, name), surface.reference(), faces, values, label, dpi)
    return saved(
        figure,
        f"{patch}, {when(surface, i)}{enlarged(surface, i, warp)}",
        picture,
        folder,
        pathlib.Path(surface.file.filename).with_name(f"{surface.name}-{name}.png"),
    )


def view(points, still, faces, values, label, dpi):
    """Figure of faces in space, with the extent of the body at rest and the color scale where there is room."""
    size, _, side = space.shape_of(points @ space.sight(points).T)
    figure = new_figure(*size, dpi)
    scale = space.in_space(figure.add_subplot(), points, faces, values)
    figure.axes[0].set_xlabel(space.extent_of(still), fontsize=8)
    figure.colorbar(scale, ax=figure.axes[0], shrink=0.8, label=label, location=side)
    return figure


def when(series, i):
    """Time of an output; a static run has a single state."""
    try:
        made = pathlib.Path(series.file.filename).with_name("effective.yaml")
        analysis = load(made.read_text(), made).get("analysis")
    except (OSError, ValueError, AttributeError, Wrong):
        analysis = None  # a program of someone else
    if len(series.times) <= 2 and analysis in ("static", "buckling"):
        return "static"
    return f"t = {series.times[i]:.4g} s"


def enlarged(series, i, warp):
    moves = "displacement" in series.names(i) and series.is_at_points(i, "displacement")
    return f", displacement drawn {warp:g} times as large" if moves and warp != 1 else ""


def with_prefix(values, label):
    """Values and their label in a unit with a prefix, such as MPa."""
    name, _, unit = label.rpartition(" [")
    unit, most = unit.rstrip("]"), np.nanmax(np.abs(values), initial=0)
    factor, steps = 1.0, PREFIXES.get(unit, ())
    for k, other in enumerate(steps, 1):
        if unit == "m" and 0 < most < 0.1 * 1000.0 ** (1 - k) or unit != "m" and most >= 1000.0**k:
            factor, chosen = 1000.0 ** (k if unit == "m" else -k), other
    return factor * values, f"{name.replace('-', ' ')} [{unit if factor == 1 else chosen}]"


def bodies_beside(series):
    """{name: series} of the other participants of a run that are displaced, where this one is not: bodies in a flow."""
    home, found = pathlib.Path(series.file.filename).parent, {}
    if not series.steps or "displacement" in series.names(-1):
        return found
    for place in sorted(p for p in home.parent.iterdir() if p.is_dir() and p != home):
        try:
            other = find_series(place)
        except (OSError, KeyError):
            continue  # without fields, or a run that writes them now
        if other.steps and "displacement" in other.names(-1) and other.is_at_points(-1, "displacement"):
            if other.is_flat() == series.is_flat() or not series.is_flat():
                found[place.name] = other
    return found


def draw(
    folder: str | pathlib.Path,
    name: str,
    picture: str | pathlib.Path | None = None,
    at: float | None = None,
    component: str | None = None,
    warp: float | None = 1.0,
    dpi: int = 110,
    plane: str | None = None,
) -> pathlib.Path:
    """Draws a field of one output (the last, or the one closest to the time `at` [s]), with the arguments of
    draw_surface(); without a number, `warp` makes the displacement visible. `plane` such as "y = 0" cuts a body in 3-D.
    Other participants that are displaced are drawn as bodies in the flow. Returns the picture's path."""
    series = series_of(folder, name)
    i = output_near(series, at)
    warp = warp_of(series, i) if warp is None else warp
    values, points = values_of(series, i, name, component), places_of(series, i, warp, name)
    values, label = with_prefix(values, label_of(series, i, name, component))
    place = pathlib.Path(series.file.filename)
    cut = ""
    expect(plane is None or not series.is_flat(), "--plane: the mesh is two-dimensional")
    if series.is_flat() or plane is not None:
        polygons, cells, ways = space.polygons_of(series, points, plane, "")
        size, inches, side = space.shape_of(np.concatenate(polygons))
        figure = new_figure(*size, dpi)
        axes = figure.add_subplot()
        scale = space.flat_map(axes, polygons, values[cells], lines="black", width=0.2)
        axes.set(xlabel=f"{ways[0]} [m]", ylabel=f"{ways[1]} [m]")
        for other, body in bodies_beside(series).items():
            there = places_of(body, body.nearest(series.times[i]), 1, "")
            space.body_on(axes, body, there, plane and space.plane_of(plane, ""), ways, space.BODY, other)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(fontsize=8)
        axes.autoscale()
        space.ticks_on(axes, inches, [series.reference()[:, "xyz".index(w)] for w in ways])
        figure.colorbar(scale, ax=axes, shrink=0.8, label=label, location=side)
        cut = f", plane {plane} m" if plane else ""
    else:
        figure = view(points, series.reference(), space.outer_faces(series), values, label, dpi)
    return saved(
        figure,
        f"{place.parent.name}, {when(series, i)}{cut}{enlarged(series, i, warp)}",
        picture,
        folder,
        place.with_name(f"{name}.png"),
    )


def shapes_of(series, file):
    """First shapes of a file as ((output, field), frequency or factor, number of the shape), and how many rigid motions
    precede them."""
    table, word = SHAPE_TABLES[file.name]
    numbers = list(read_csv(file.with_name(table)).values())[1]
    names = [n for n in series.names(0) if n.rpartition("-")[0] in ("mode", "buckling")]
    # The shapes of a plate are outputs, those of a solid fields.
    fields = [(0, n) for n in sorted(names, key=lambda n: int(n.rpartition("-")[2]))] or [
        (i, "mode") for i in range(len(series.steps))
    ]
    shapes = list(zip(fields, numbers, range(1, len(fields) + 1)))
    rigid = sum(s[1] < RIGID * numbers.max() for s in shapes) if word == "frequency" else 0
    rigid = 0 if rigid == len(shapes) else rigid
    return shapes[rigid:][:MOST_SHAPES], rigid


def draw_shapes(file: str | pathlib.Path, dpi: int = 110) -> pathlib.Path:
    """Draws the first shapes of vibration or buckling (mode-shapes.h5, modes-shapes.h5, buckling.h5), without rigid
    motions. Returns the picture's path."""
    file = pathlib.Path(file)
    series, word = FieldSeries(file), SHAPE_TABLES[file.name][1]
    shapes, rigid = shapes_of(series, file)
    points = np.array(series.reference(), float)
    flat = series.is_flat() and all(not np.any(series.field(i, n)[:, 2:]) for (i, n), _, _ in shapes)
    corners = points if flat else points @ space.sight(points).T
    size, _, _ = space.shape_of(corners)
    across = 1 if size[0] > 2.5 * size[1] else min(3, len(shapes))
    down = -(-len(shapes) // across)
    shrink = 0.9 if across == 1 else 0.5
    figure = new_figure(max(5.0, shrink * size[0] * across), max(1.2, shrink * size[1]) * down + 0.7, dpi)
    faces = [] if flat else [face for face, _ in space.outer_faces(series)]
    for k, ((i, name), number, count) in enumerate(shapes, 1):
        axes = figure.add_subplot(down, across, k)
        move = np.zeros_like(points)
        field = np.asarray(series.field(i, name), float)[:, : points.shape[1]]
        move[:, : field.shape[1]] = field / max(np.linalg.norm(field, axis=1).max(), 1e-300)
        moved = points + 0.1 * np.ptp(points, axis=0).max() * move
        length = np.linalg.norm(move, axis=1)
        if flat:
            values = np.array([length[cell].mean() for cell in series.cells])
            space.flat_map(axes, [moved[cell][:, :2] for cell in series.cells], values, lines="black")
            space.outline_on(axes, series, points, "gray", 0.5)
            axes.set_axis_off()
        else:
            values = np.array([length[face].mean() for face in faces])
            space.in_space(axes, moved, [(face, n) for n, face in enumerate(faces)], values)
        axes.set_title(
            f"{count}: {number:.4g} Hz" if word == "frequency" else f"{count}: {number:.4g} times the load", fontsize=9
        )
    left = f"; {rigid} rigid-body modes are not drawn" if rigid else ""
    what = "shapes of vibration" if word == "frequency" else "shapes of buckling"
    figure.suptitle(
        (
            f"{file.parent.name}: {what}{left}\n{space.extent_of(points)}; the color shows the displacement, from zero"
            " to the largest"
        ),
        fontsize=9,
    )
    return saved(figure, None, None, file.parent, file.with_suffix(".png"))


def draw_mode(
    folder: str | pathlib.Path, number: int, picture: str | pathlib.Path | None = None, dpi: int = 110
) -> pathlib.Path:
    """Draws a mode of modes.h5 (docs/formats.md) on the surface, with a maximum displacement of a tenth of the size.
    Returns the picture's name."""
    import h5py

    file = next((f for f in (place / "modes.h5" for place in places_below(folder)) if f.exists()), None)
    expect(file, f"{folder}: there is no modes.h5 in it")
    with h5py.File(file) as modes:
        frequency = modes["frequency"][...]
        expect(1 <= number <= len(frequency), f"mode {number} does not exist; the file has {len(frequency)} modes")
        points, ends, corners = (modes[f"surface/{name}"][...] for name in ("vertices", "face-offset", "face-vertex"))
        shape = modes["shape/vertices"][...][:, number - 1].reshape(-1, 3)
    length = np.linalg.norm(shape, axis=1)
    moved = points + 0.1 * np.ptp(points, axis=0).max() / length.max() * shape
    faces = [(corners[a:b].astype(int), k) for k, (a, b) in enumerate(zip(ends[:-1].astype(int), ends[1:].astype(int)))]
    values = np.array([length[f].mean() for f, _ in faces]) / length.max()
    figure = view(moved, points, faces, values, "displacement over its largest [-]", dpi)
    return saved(
        figure, f"mode {number}: {frequency[number - 1]:.4g} Hz", picture, folder, file.with_name(f"mode-{number}.png")
    )
