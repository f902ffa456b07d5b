# SPDX-License-Identifier: Apache-2.0
"""Pictures of a study: error against time with the Pareto front, error against size with the observed order, growth of
the cost with its exponent, and cost by phase."""
import itertools
import textwrap

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator

from couplet import files
from couplet.study import fits
from couplet.study.table import series_of

CLOCKS = {
    "cpu": "processor time of the run [s]",
    "wall": "wall-clock time of the run [s]",
    "work": "processor time of all programs without waiting [s]",
}
MARKS = "osD^vP*Xh<>"


WIDEST_Y = 40  # characters per line beside the height of a panel
MOST = 8  # series per panel; a picture with more has several panels
NARROW = 62  # characters per title line in the width of one panel


def differing(rows):
    """Series, and the axes in which they differ with their labels."""
    series = series_of(rows)
    sizes = {
        a for some in series.values() for r in some for a, v in r.point.labels.items() if v not in r.series.split(", ")
    }
    axes = [a for a in next(iter(series.values()))[0].point.labels if a not in sizes] if series else []
    values = {a: list(dict.fromkeys(some[0].point.labels[a] for some in series.values())) for a in axes}
    return series, {a: values[a] for a in axes if len(values[a]) > 1}


def panels(rows):
    """Returns [(heading, {series: its name in the legend})] with at most MOST series each, divided by as few axes and
    into as few panels as possible."""
    series, values = differing(rows)
    if len(series) <= MOST:
        return [("", {name: name for name in series})]
    found = []
    for count in range(1, len(values) + 1):
        for chosen in itertools.combinations(values, count):
            groups = {}
            for name, some in series.items():
                labels = some[0].point.labels
                rest = ", ".join(labels[a] for a in values if a not in chosen) or name
                groups.setdefault(", ".join(labels[a] for a in chosen), {})[name] = rest
            if max(map(len, groups.values())) <= MOST:
                found.append(list(groups.items()))
        if found:
            return min(found, key=len)
    return divided(series)


def divided(names):
    """Panels of names that are only grouped by their order."""
    names = list(names)
    return [("", {n: n for n in names[k : k + MOST]}) for k in range(0, len(names), MOST)]


def looks(found):
    """Returns {name in the legend: keywords of its line}, the same in all panels."""
    names = list(dict.fromkeys(n for _, some in found for n in some.values()))
    return {
        n: {"color": f"C{k % 10}", "marker": MARKS[k % len(MARKS)], "markersize": 4, "lw": 1}
        for k, n in enumerate(names)
    }


def figure(title, count=1):
    """Returns (figure, [axes]) of `count` panels with equal scales, with a title wrapped to the width of the
    picture."""
    columns = min(count, 2 if count in (2, 4) else 3)
    lines = -(-count // columns)
    width, height = (6.6, 4.4) if count == 1 else (4.6 * columns, 4.5 * lines + 0.3)
    made, axes = plt.subplots(
        lines,
        columns,
        figsize=(width, height),
        dpi=130 if count == 1 else 110,
        constrained_layout=True,
        sharex=True,
        sharey=True,
        squeeze=False,
    )
    made.suptitle(textwrap.fill(title, int(NARROW * width / 6.6)), fontsize=10)
    for one in axes.flat[count:]:
        one.remove()
    for column in range(columns):  # numbers are shown below the last panel of a column
        axes[(count - 1 - column) // columns, column].xaxis.set_tick_params(labelbottom=True)
    return made, list(axes.flat[:count])


def plain(axis):
    """Plain numbers for a logarithmic axis with a small range."""
    low, high = axis.get_view_interval()
    if high / max(low, 1e-300) < 30:
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_minor_formatter(FuncFormatter(lambda v, _: ""))
        axis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))


def finish(made, axes, file, xlabel="", ylabel=""):
    for one in axes:
        one.grid(which="both", alpha=0.25)
        plain(one.xaxis), plain(one.yaxis)
        handles, labels = one.get_legend_handles_labels()
        if len(labels) > 1 or labels and len(axes) > 1:  # for several panels below each one, where it hides nothing
            one.legend(
                fontsize=7,
                framealpha=0.7,
                **(
                    {"loc": "upper center", "bbox_to_anchor": (0.5, -0.08), "ncols": 1 + (max(map(len, labels)) < 36)}
                    if len(axes) > 1
                    else {}
                ),
            )
    made.supxlabel(xlabel, fontsize=10), made.supylabel(textwrap.fill(ylabel, WIDEST_Y), fontsize=10)
    with files.part(file.parent, file.name) as new:
        made.savefig(new)
    plt.close(made)
    return file


def error_against_time(title, rows, quantity, clock, file, others=()):
    """`others` are (name, [(cost, error)]) of other programs, in the same panel if there is space. The front is that of
    all, in every panel. of all of them, in every panel."""
    series = {
        name: [
            (getattr(r.record, clock), r.errors[quantity.name], r) for r in some if r.errors.get(quantity.name, 0) > 0
        ]
        for name, some in series_of(rows).items()
    }
    points = [p[:2] for xy in series.values() for p in xy]
    if not points:
        return None
    found, beside = panels(rows), dict(others)
    theirs = [] if len(found) == 1 and len(series) + len(beside) < MOST else divided(beside)
    made, axes = figure(title, len(found) + len(theirs))
    styles, front = looks(found), fits.pareto([*points, *(tuple(p) for xy in beside.values() for p in xy)])
    for one, (heading, some) in zip(axes, found):
        one.set_title(heading, fontsize=8)
        for k, (name, label) in enumerate(some.items()):
            if series[name]:
                one.loglog([p[0] for p in series[name]], [p[1] for p in series[name]], **styles[label], label=label)
            for x, y, row in series[name] if k == 0 else ():
                one.annotate(
                    next((v for a, v in row.point.labels.items() if row.point.size and v not in name.split(", ")), ""),
                    (x, y),
                    fontsize=6,
                    color=styles[label]["color"],
                    xytext=(4, 3),
                    textcoords="offset points",
                )
    for one, some in (
        [(axes[0], beside)] if not theirs else [(one, names) for one, (_, names) in zip(axes[len(found) :], theirs)]
    ):
        if theirs:
            one.set_title("other programs", fontsize=8)
        for k, name in enumerate(some):
            one.loglog(*zip(*beside[name]), f"k{MARKS[k]}--", markersize=4, lw=0.8, label=name)
    for one in axes if len(front) > 1 else ():
        one.step(*zip(*front), where="post", color="0.6", lw=4, alpha=0.4, zorder=0, label="Pareto front")
    return finish(
        made,
        axes,
        file,
        CLOCKS[clock],
        f"error of {quantity.name}"
        + ("" if not quantity.given.get("absolute") else f" [{quantity.given.get('unit', '')}]"),
    )


def over_size(title, rows, value, words):
    """Returns (figure, [axes], points drawn) with a line for each series for which `words`([(size, value), ...])
    returns a legend text."""
    found, series, drawn = panels(rows), series_of(rows), []
    styles = looks(found)
    made, axes = figure(title, len(found))
    for one, (heading, some) in zip(axes, found):
        one.set_title(heading, fontsize=8)
        for name, label in some.items():
            xy = [(r.point.size, value(r)) for r in series[name] if value(r) > 0]
            if len(xy) > 1 and (told := words(xy)):
                drawn += xy
                one.loglog(*zip(*xy), **styles[label], label=f"{label}: {told}")
    return made, axes, drawn


def order(title, rows, quantity, refinement, file):
    def words(xy):
        steep, last = fits.slope(*zip(*xy)), fits.slope(*zip(*xy[-2:]))
        return f"order {-steep:.2f}, last two {-last:.2f}" if steep is not None and last is not None else None

    made, axes, drawn = over_size(title, rows, lambda r: r.errors.get(quantity.name, 0), words)
    if not drawn:
        return plt.close(made)
    low, high, top = min(x for x, _ in drawn), max(x for x, _ in drawn), max(y for _, y in drawn)
    for one in axes:
        for p, style in ((1, ":"), (2, "--")):
            one.plot([low, high], [top, top * (high / low) ** -p], style, color="0.7", lw=0.8, label=f"order {p}")
    return finish(made, axes, file, f"{refinement} (size n, cells or steps per length)", f"error of {quantity.name}")


def growth(title, rows, clock, refinement, file):
    def words(xy):
        exponent = fits.slope(*zip(*xy[-3:]))
        return f"n^{exponent:.2f}" if exponent is not None else None

    made, axes, drawn = over_size(title, rows, lambda r: getattr(r.record, clock), words)
    return finish(made, axes, file, f"{refinement} (size n)", CLOCKS[clock]) if drawn else plt.close(made)


def scatter(title, found, file):
    """`found` contains (estimated, true, name)."""
    made, (axes,) = figure(title)
    estimated, true = np.array([f[0] for f in found]), np.array([f[1] for f in found])
    axes.loglog(true, estimated, "o", markersize=4)
    line = np.array([min(true.min(), estimated.min()), max(true.max(), estimated.max())])
    for factor, style in ((1, "-"), (0.5, "--"), (2, "--")):
        axes.plot(line, factor * line, style, color="0.6", lw=0.8)
    return finish(made, [axes], file, "true error", "estimated error")


def phases(title, rows, file, most=24):
    """Shares of the phases of each run, with its processor seconds. Beyond `most` runs, only the most expensive one of
    each series."""
    good = [r for r in rows if r.good and r.record.phases]
    if len(good) > most:
        good = [some[-1] for some in series_of(good).values()][:most]
    if not good:
        return None
    names = sorted(
        {p for r in good for p in r.record.phases}, key=lambda p: -sum(r.record.phases.get(p, 0) for r in good)
    )
    shown = names[:MOST] if len(names) <= MOST else names[: MOST - 1]
    high = 0.6 + 0.24 * len(good)
    made, (axes, below) = plt.subplots(
        2, 1, figsize=(7.2, 0.8 + high), dpi=130, constrained_layout=True, height_ratios=(high, 0.4)
    )
    left, at = np.zeros(len(good)), np.arange(len(good))
    total = np.array([max(sum(r.record.phases.values()), 1e-12) for r in good])
    for p in [*shown, *(["the rest"] if len(names) > len(shown) else [])]:
        part = np.array(
            [
                (
                    r.record.phases.get(p, 0)
                    if p != "the rest"
                    else sum(r.record.phases.get(o, 0) for o in names[len(shown) :])
                )
                for r in good
            ]
        )
        axes.barh(at, 100 * part / total, left=left, label=p)
        left += 100 * part / total
    axes.set_yticks(at, [f"{r.point.name} ({r.record.cpu:.2g} s)" for r in good], fontsize=6)
    axes.set(xlabel="part of the run [%]; processor seconds in brackets", xlim=(0, 100))
    axes.margins(y=0.01)
    axes.invert_yaxis()
    made.suptitle(textwrap.fill(title, NARROW), fontsize=10)
    below.axis("off")
    below.legend(*axes.get_legend_handles_labels(), fontsize=6, ncols=4, loc="center")
    with files.part(file.parent, file.name) as new:
        made.savefig(new)
    plt.close(made)
    return file
