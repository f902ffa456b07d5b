# SPDX-License-Identifier: Apache-2.0
"""Draws the section `plot` of a case from the output folder of a run, and prints the quantities that it names."""
import pathlib
import shlex

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from couplet import fields, files
from couplet.plots import space
from couplet.plots.section import check, seconds
from couplet.plots.sources import columns_of, points_of, series_in
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


def draw_bodies(axes, panel, out, series, i, ways, plane):
    """Draws the outline of a 2-D flow and the bodies in it: those that are named, or all that are displaced."""
    if "bodies" in panel:
        bodies = {name: series_in(out, name) for name in panel["bodies"]}
    else:
        bodies = fields.bodies_beside(series)
    if bodies and series.is_flat():
        space.outline_on(axes, series, np.array(series.coordinates(i)))
    for body in bodies.values():
        corners = fields.places_of(body, body.nearest(series.times[i]), panel.get("warp", 1), "")
        space.body_on(axes, body, corners, plane, ways, "tab:red" if "bodies" in panel else space.BODY)


def draw_field(figure, axes, panel, case, out, where):
    """Draws a map of 2-D cells or of a plane through a body, else the outer faces in 3-D."""
    participant = panel.get("participant", next(iter(case.participants)))
    series, at = series_in(out, participant), time_of(panel, out, f"{where}.at")
    i = len(series.times) - 1 if at is None else series.nearest(at)
    values = panel.get("factor", 1) * fields.values_of(series, i, panel["field"], panel.get("component"))
    points = fields.places_of(series, i, panel.get("warp", 1), panel["field"])
    if series.is_flat() or "plane" in panel:
        polygons, cells, ways = space.polygons_of(series, points, panel.get("plane"), where)
        drawn = space.flat_map(axes, polygons, values[cells], panel.get("colours"), panel.get("mesh"))
        axes.set(xlabel=f"{ways[0]} [m]", ylabel=f"{ways[1]} [m]")
        draw_bodies(axes, panel, out, series, i, ways, None if series.is_flat() else space.plane_of(panel["plane"], ""))
        if "range" in panel:
            drawn.set_clim(*panel["range"])
    else:
        drawn = space.in_space(
            axes, points, space.outer_faces(series), values, panel.get("range"), panel.get("colours")
        )
    axes.set_title(f"{panel['field']} at t = {series.times[i]:.4g} s")
    if not panel.get("axes", True):
        axes.set_axis_off()
    figure.colorbar(
        drawn,
        ax=axes,
        label=panel.get("label", fields.label_of(series, i, panel["field"], panel.get("component"))),
        shrink=0.85,
    )


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
                draw_field(figure, axes, panel, case, out, where)
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
