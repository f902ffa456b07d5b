# SPDX-License-Identifier: Apache-2.0
"""Draws the section `plot` of a case from the output folder of a run, and prints the quantities that it names."""
import pathlib
import shlex

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection

from couplet import fields, files
from couplet.plots.section import check, seconds
from couplet.plots.sources import columns_of, number, points_of, series_in
from couplet.runs.case import Wrong, expect
from couplet.runs.results import Results
from couplet.series import extrema

LOOK = {
    "line": {"ls": "-", "lw": 1.2},
    "points": {"ls": "", "marker": "o", "fillstyle": "none", "color": "black", "markersize": 4},
    "dots": {"ls": "", "marker": "."},
    "crosses": {"ls": "", "marker": "x", "color": "black", "markersize": 5},
    "pluses": {"ls": "", "marker": "+", "color": "black", "markersize": 6},
    "squares": {"ls": "", "marker": "s", "color": "black", "markersize": 6},
    "dashed": {"ls": "--", "lw": 1.2},
    "dotted": {"ls": ":"},
}
LABELS = 12  # per legend


def look_of(curve):
    style = dict(LOOK[curve.get("style", "line" if "levels" not in curve else "dotted")])
    return {
        **style,
        **({"color": curve["colour"]} if "colour" in curve else {}),
        **({"markevery": curve["every"]} if "every" in curve else {}),
    }


def draw_curve(axes, curve, case, out, where):
    if "levels" in curve:
        for i, level in enumerate(curve["levels"]):
            axes.axhline(level, **{"color": "black", **look_of(curve)}, label=curve.get("label") if i == 0 else None)
        return
    found = points_of(curve, case, out, where)
    for i, (x, y, value) in enumerate(found):
        label = curve.get("label") if value is None else curve.get("label", "<each>").replace("<each>", f"{value:.4g}")
        shade = {} if value is None else {"color": plt.get_cmap("viridis")(0.9 * i / max(1, len(found) - 1))}
        order = np.argsort(x, kind="stable") if curve.get("sorted") else slice(None)
        axes.plot(x[order], y[order], **{**look_of(curve), **shade}, label=label)
        for t, top, kind in extrema(x, y) if curve.get("extrema") else ():
            if kind == "max":
                axes.annotate(
                    f"{top:.3f}\nat {t:.2f}",
                    (t, top),
                    textcoords="offset points",
                    xytext=(0, 16),
                    ha="center",
                    fontsize=7,
                )


def draw_curves(axes, panel, case, out, where):
    for j, curve in enumerate(panel["curves"]):
        draw_curve(axes, curve, case, out, f"{where}.curves[{j}]")
    axes.grid(alpha=0.3)
    labels = axes.get_legend_handles_labels()[0]
    if labels and panel.get("legend", True) and len(labels) <= max(LABELS, 2 * len(panel["curves"])):
        axes.legend(fontsize=7, ncol=max(1, int(panel.get("legend", 1))))


def time_of(panel, out, where):
    """Time of a map: given, or that of a first maximum."""
    at = panel.get("at")
    if not isinstance(at, dict):
        return seconds(at, where)
    table = columns_of(out / at["monitor"])
    expect(
        at["first-maximum"] in table,
        f"{where}: {out / at['monitor']} has no column '{at['first-maximum']}'; it has: {', '.join(table)}.",
    )
    time, values = next(iter(table.values())), table[at["first-maximum"]]
    return next((t for t, _, kind in extrema(time, values) if kind == "max"), time[-1])


def polygons_of(series, points, plane, where):
    """Returns (corners, cells) of 2-D cells, or of cells above a plane such as y = 0 with a face in it (below it if
    there are none), in its two other axes."""
    if series.is_flat():
        return [points[cell][:, :2] for cell in series.cells], np.arange(len(series.cells)), "xy"
    axis, _, level = plane.replace(" ", "").partition("=")
    expect(
        axis in ("x", "y", "z") and np.isfinite(number(level or "x")),
        f"{where}.plane: '{plane}'; expected such as y = 0.",
    )
    k, still, size = "xyz".index(axis), series.reference(), np.ptp(series.reference(), axis=0).max()
    others, sides = [i for i in range(3) if i != k], {1: [], -1: []}
    for number_, cell in enumerate(series.cells):
        height = still[cell][:, k] - float(level)
        on = np.abs(height) < 1e-6 * size
        if np.count_nonzero(on) > 2:
            face = np.asarray(cell)[on]
            way = still[face][:, others] - still[face][:, others].mean(axis=0)
            sides[1 if height.mean() > 0 else -1].append((face[np.argsort(np.arctan2(way[:, 1], way[:, 0]))], number_))
    faces = sides[1] or sides[-1]
    expect(faces, f"{where}.plane: no face of a cell lies in {plane}.")
    return (
        [points[face][:, others] for face, _ in faces],
        np.array([cell for _, cell in faces]),
        "xyz".replace(axis, ""),
    )


def draw_bodies(axes, panel, out, series, i, ways):
    """Draws outlines of a 2-D mesh and of bodies in it."""
    ways = ["xyz".index(w) for w in ways]
    if series.is_flat():
        edges = np.array(series.coordinates(i))[series.edges_on_boundary()][:, :, :2]
        axes.add_collection(LineCollection(edges, colors="black", linewidths=0.8))
    for name in panel["bodies"]:
        body = series_in(out, name)
        corners = fields.places_of(body, body.nearest(series.times[i]), panel.get("warp", 1), "")
        faces = (
            [face for face, _ in fields.outer_faces(body)] if max(map(len, body.cells)) > 4 else body.cells
        )  # plates consist only of their surface
        axes.add_collection(
            PolyCollection([corners[face][:, ways] for face in faces], facecolors="tab:red", edgecolors="none")
        )


def draw_map(axes, panel, polygons, values):
    finite = values[np.isfinite(values)]
    least, most = (finite.min(), finite.max()) if finite.size else (0, 0)
    is_signed = min(-least, most) > 0.1 * max(-least, most)  # colors that diverge from zero
    drawn = PolyCollection(
        polygons,
        array=values,
        cmap=panel.get("colours", "RdBu_r" if is_signed else "viridis"),
        edgecolors="none",
        antialiaseds=False,
    )  # smoothed edges would leave white lines
    if is_signed:
        drawn.set_clim(-max(-least, most), max(-least, most))
    axes.add_collection(drawn)
    if "mesh" in panel:
        axes.add_collection(
            PolyCollection(polygons, facecolors="none", edgecolors=panel["mesh"], linewidths=0.07, alpha=0.4)
        )
    axes.autoscale()
    axes.set_aspect("equal")
    return drawn


def draw_field(figure, axes, panel, case, out, where):
    """Draws a map of 2-D cells or of an outer plane, else the outer faces in 3-D. Returns its axes."""
    participant = panel.get("participant", next(iter(case.participants)))
    series, at = series_in(out, participant), time_of(panel, out, f"{where}.at")
    i = len(series.times) - 1 if at is None else series.nearest(at)
    values = panel.get("factor", 1) * fields.values_of(series, i, panel["field"], panel.get("component"))
    points = fields.places_of(series, i, panel.get("warp", 1), panel["field"])
    if series.is_flat() or "plane" in panel:
        polygons, cells, ways = polygons_of(series, points, panel.get("plane"), where)
        drawn = draw_map(axes, panel, polygons, values[cells])
        axes.set(xlabel=f"{ways[0]} [m]", ylabel=f"{ways[1]} [m]")
        if "bodies" in panel:
            draw_bodies(axes, panel, out, series, i, ways)
    else:
        place = axes.get_subplotspec()
        axes.remove()
        drawn = fields.in_space(
            figure, points, series, np.clip(values, *panel.get("range", (None, None))), place=(place,)
        )
        axes = figure.axes[-1]
    if "range" in panel:
        drawn.set_clim(*panel["range"])
    axes.set_title(f"{panel['field']} at t = {series.times[i]:.4g} s")
    if not panel.get("axes", True):
        axes.set_axis_off()
    figure.colorbar(
        drawn,
        ax=axes,
        label=panel.get("label", fields.label_of(series, i, panel["field"], panel.get("component"))),
        shrink=0.85,
    )
    return axes


def usual_labels(axes, panel):
    """Default labels of columns plotted without change: that of x, and that of a single y."""
    files = [c for c in panel.get("curves", ()) if "monitor" in c or "table" in c]
    if files and "label" not in panel.get("x", {}):
        axes.set_xlabel(files[0].get("x", "time [s]" if "monitor" in files[0] else ""))
    if len(files) == 1 and "label" not in panel.get("y", {}):
        axes.set_ylabel(files[0]["y"])


def finish(axes, panel):
    for way in "xy":
        given = panel.get(way, {})
        if given.get("log"):
            axes.set(**{f"{way}scale": "log"})
        if "label" in given:
            axes.set(**{f"{way}label": given["label"]})
        low, high = given.get("from"), given.get("to")
        if low is not None or high is not None:
            axes.set(**{f"{way}lim": (low, high)})
    if "title" in panel:
        axes.set_title(panel["title"])
    axes.title.set_fontsize(9)


def print_quantities(section, case, out):
    from couplet.study.quantities import quantities_of

    for quantity in quantities_of(case, section, next(iter(case.participants)), "plot"):
        try:
            value = quantity.value(Results(out))
        except (LookupError, OSError) as problem:
            raise Wrong(f"{case.file}: plot.quantities.{quantity.name}: {problem}") from None
        wanted = quantity.reference
        beside = (
            f", reference {wanted:.5g} ({100 * (value / wanted - 1):+.2f} %)"
            if isinstance(wanted, (int, float)) and wanted
            else ""
        )
        print(f"{quantity.name}: {value:.5g}{' ' + quantity.given['unit'] if 'unit' in quantity.given else ''}{beside}")


def across_of(section):
    """Number of panels side by side."""
    return min(section.get("columns", min(3, len(section["panels"]))), len(section["panels"]))


def size_of(section):
    """Width and height of the picture [inch]."""
    return section.get(
        "size", (min(14, 5.5 * across_of(section)), 4.2 * -(-len(section["panels"]) // across_of(section)))
    )


def draw(case, out, picture=None, section=None):
    """Draws the picture of the run in the folder `out`, optionally with another section (a frame of a film). Returns
    its path."""
    section, out = section or check(case), pathlib.Path(out)
    expect(
        out.is_dir(), f"{out}: there is no such folder; run the case first: couplet run {shlex.quote(str(case.file))}"
    )
    panels, across = section["panels"], across_of(section)
    down = -(-len(panels) // across)
    figure, grid = plt.subplots(
        down,
        across,
        figsize=size_of(section),
        dpi=130,
        squeeze=False,
        constrained_layout=True,
        sharex=section.get("share-x", False),
    )
    for axes in grid.flat[len(panels) :]:
        axes.axis("off")
    where = f"{case.file}: plot"
    try:
        for k, (axes, panel) in enumerate(zip(grid.flat, panels)):
            where = f"{case.file}: plot.panels[{k}]"
            if "field" in panel:
                axes = draw_field(figure, axes, panel, case, out, where)
            else:
                draw_curves(axes, panel, case, out, where)
            if not section.get("share-x"):
                usual_labels(axes, panel)
            finish(axes, panel)
        where = f"{case.file}: plot"
        if "title" in section:
            figure.suptitle(section["title"], fontsize=10)
        picture = pathlib.Path(picture or out / section.get("file", f"{case.file.resolve().parent.name}.png"))
        with files.part(picture.parent, picture.name) as made:
            figure.savefig(made)
    except ValueError as problem:  # a color or a title formula that matplotlib does not know
        raise Wrong(f"{where}: {' '.join(str(problem).split())[:300]}") from None
    finally:
        plt.close(figure)
    if "quantities" in section:
        print_quantities(section, case, out)
    return picture
