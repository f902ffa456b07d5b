# SPDX-License-Identifier: Apache-2.0
"""The pictures of a study: error against time with the Pareto front, error against size with the observed order, growth of the
cost with its exponent, cost by phase."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator

from couplet.study import convergence
from couplet.study.table import series_of

CLOCKS = {"cpu": "processor time of the run [s]", "wall": "wall time of the run [s]", "work": "processor time of all programs at work, without waiting [s]"}
MARKS = "osD^vP*Xh<>"


LINES = ("-", "--", ":", "-.", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 3)), (0, (8, 2)))
MANY = 16  # series from which on a legend names colours, marks and lines instead of each
BESIDE = 9  # names in a legend from which on it stands beside the picture


def figure(title, series=0):
    """`series`: how many are to be drawn."""
    beside = series >= BESIDE
    made, axes = plt.subplots(figsize=(6.6 + (2.6 if beside else 0), max(4.4, 0.152 * series + 0.1) if beside else 4.4), dpi=130, constrained_layout=True)
    axes.set_title(title, fontsize=10)
    return made, axes


def plain(axis):
    """Numbers where a logarithmic axis spans little."""
    low, high = axis.get_view_interval()
    if high / max(low, 1e-300) < 30:
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_minor_formatter(FuncFormatter(lambda v, _: ""))
        axis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))


def differing(rows):
    """Series, and the axes in which they differ with the labels of each."""
    series = series_of(rows)
    sizes = {a for some in series.values() for r in some for a, v in r.point.labels.items() if v not in r.series.split(", ")}
    axes = [a for a in next(iter(series.values()))[0].point.labels if a not in sizes] if series else []
    values = {a: list(dict.fromkeys(some[0].point.labels[a] for some in series.values())) for a in axes}
    return series, {a: values[a] for a in axes if len(values[a]) > 1}


def styles(rows):
    """{series: keywords of its line}. Where series differ in two things or three, colour, mark and line tell which."""
    (series, values), found = differing(rows), {}
    several = list(values)
    for k, (name, some) in enumerate(series.items()):
        of = [values[a].index(some[0].point.labels[a]) for a in several]
        if len(of) < 2:
            found[name] = {"marker": MARKS[k % len(MARKS)], "linestyle": "-"}
        else:
            found[name] = {"color": f"C{of[0] % 10}", "marker": MARKS[of[1] % len(MARKS)], "linestyle": LINES[of[2] % len(LINES)] if len(of) > 2 else "-"}
        found[name].update(markersize=4, lw=1)
    return found


def common(rows):
    """Legend of many series that differ in two things or three: [(label, keywords)] of a colour, a mark, a line each; else none."""
    series, values = differing(rows)
    if len(series) < MANY or len(values) not in (2, 3):
        return []
    looks = ([{"color": f"C{k % 10}", "lw": 3} for k in range(10)], [{"color": "0.4", "marker": m, "ls": "", "markersize": 4} for m in MARKS],
             [{"color": "0.4", "linestyle": line, "lw": 1} for line in LINES])
    return [(label, look) for some, of in zip(values.values(), looks) for label, look in zip(some, of)]


def finish(made, axes, file):
    axes.grid(which="both", alpha=0.25)
    plain(axes.xaxis), plain(axes.yaxis)
    handles, labels = axes.get_legend_handles_labels()
    if len(labels) >= BESIDE:
        axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.01, 0.5))
    elif len(labels) > 1:
        axes.legend(fontsize=7)
    made.savefig(file)
    plt.close(made)
    return file


def error_against_time(title, rows, quantity, clock, file, others=()):
    """`others`: (name, [(cost, error)]) of other programs."""
    looks, names = styles(rows), common(rows)
    made, axes = figure(title, (len(names) or len(looks)) + len(others) + 1)
    points = []
    for label, look in names:
        axes.plot([], [], **look, label=label)
    for k, (name, some) in enumerate(series_of(rows).items()):
        xy = [(getattr(r.record, clock), r.errors[quantity.name], r) for r in some if r.errors.get(quantity.name, 0) > 0]
        if not xy:
            continue
        line, = axes.loglog([p[0] for p in xy], [p[1] for p in xy], **looks[name], label=None if names else name)
        points += [p[:2] for p in xy]
        if len(points) <= 24 or k == 0:
            for x, y, row in xy:
                size = next((v for a, v in row.point.labels.items() if row.point.size and a not in name and v not in name.split(", ")), "")
                axes.annotate(size, (x, y), fontsize=6, color=line.get_color(), xytext=(4, 3), textcoords="offset points")
    for k, (name, xy) in enumerate(others):
        axes.loglog(*zip(*xy), f"k{MARKS[k]}--", markersize=4, lw=0.8, label=name)
    front = convergence.pareto(points)
    if len(front) > 1:
        axes.step(*zip(*front), where="post", color="0.6", lw=4, alpha=0.4, zorder=0, label="Pareto front")
    axes.set(xlabel=CLOCKS[clock], ylabel=f"error of {quantity.name}" + ("" if not quantity.given.get("absolute") else f" [{quantity.given.get('unit', '')}]"))
    return finish(made, axes, file) if points else plt.close(made)


def order(title, rows, quantity, refinement, file):
    looks, drawn = styles(rows), False
    made, axes = figure(title, len(looks) + 2)
    for name, some in series_of(rows).items():
        xy = [(r.point.size, r.errors[quantity.name]) for r in some if r.errors.get(quantity.name, 0) > 0]
        if len(xy) < 2:
            continue
        steep, last = convergence.slope(*zip(*xy)), convergence.slope(*zip(*xy[-2:]))
        if steep is None or last is None:
            continue
        drawn = True
        axes.loglog(*zip(*xy), **looks[name], label=f"{name}: order {-steep:.2f}, of the last two {-last:.2f}")
    axes.set(xlabel=f"{refinement} (size n, cells or steps a length)", ylabel=f"error of {quantity.name}")
    if not drawn:
        return plt.close(made)
    low, high = axes.get_xlim()
    top = max(max(line.get_ydata()) for line in axes.get_lines())
    for p, style in ((1, ":"), (2, "--")):
        axes.plot([low, high], [top, top * (high / low)**-p], style, color="0.7", lw=0.8, label=f"order {p}")
    return finish(made, axes, file)


def growth(title, rows, clock, refinement, file):
    looks, drawn = styles(rows), False
    made, axes = figure(title, len(looks))
    for name, some in series_of(rows).items():
        xy = [(r.point.size, getattr(r.record, clock)) for r in some]
        if len(xy) < 2:
            continue
        exponent = convergence.slope(*zip(*xy[-3:]))
        if exponent is None:
            continue
        drawn = True
        axes.loglog(*zip(*xy), **looks[name], label=f"{name}: n^{exponent:.2f}")
    axes.set(xlabel=f"{refinement} (size n)", ylabel=CLOCKS[clock])
    return finish(made, axes, file) if drawn else plt.close(made)


def scatter(title, found, file):
    """`found`: (estimated, true, name)."""
    made, axes = figure(title)
    estimated, true = np.array([f[0] for f in found]), np.array([f[1] for f in found])
    axes.loglog(true, estimated, "o", markersize=4)
    line = np.array([min(true.min(), estimated.min()), max(true.max(), estimated.max())])
    for factor, style in ((1, "-"), (0.5, "--"), (2, "--")):
        axes.plot(line, factor * line, style, color="0.6", lw=0.8)
    axes.set(xlabel="true error", ylabel="estimated error")
    return finish(made, axes, file)


def phases(title, rows, file, most=24):
    """Shares of the phases of each run; beyond `most` runs the dearest of each series."""
    good = [r for r in rows if r.good and r.record.phases]
    if len(good) > most:
        good = [some[-1] for some in series_of(good).values()][:most]
    if not good:
        return None
    names = sorted({p for r in good for p in r.record.phases}, key=lambda p: -sum(r.record.phases.get(p, 0) for r in good))
    shown = names[:8]
    made, axes = plt.subplots(figsize=(7.2, 1.2 + 0.24 * len(good)), dpi=130, constrained_layout=True)
    left, at = np.zeros(len(good)), np.arange(len(good))
    total = np.array([max(sum(r.record.phases.values()), 1e-12) for r in good])
    for p in [*shown, *(["the rest"] if len(names) > len(shown) else [])]:
        part = np.array([r.record.phases.get(p, 0) if p != "the rest" else sum(r.record.phases.get(o, 0) for o in names[8:]) for r in good])
        axes.barh(at, 100 * part / total, left=left, label=p)
        left += 100 * part / total
    axes.set_yticks(at, [f"{r.point.name} ({t:.2g} s)" for r, t in zip(good, total)], fontsize=6)
    axes.set(xlabel="share of the run [%]", xlim=(0, 100))
    axes.invert_yaxis()
    axes.set_title(title, fontsize=10)
    axes.legend(fontsize=6, ncols=4, loc="upper center", bbox_to_anchor=(0.45, -0.5 / (0.24 * len(good) + 0.6)))
    made.savefig(file)
    plt.close(made)
    return file
