# SPDX-License-Identifier: Apache-2.0
"""One row per run: its axes, values, errors and costs."""
import csv
import math
import re
import types

from couplet import files
from couplet.study import fits
from couplet.study.axes import Point

COSTS = ("wall", "cpu", "work", "memory", "steps", "iterations", "spread")
HEADS = {
    "wall": "wall [s]",
    "cpu": "processor [s]",
    "work": "work [s]",
    "memory": "memory [MB]",
    "spread": "spread of processor [1]",
}
PARTS = ("mesh", "step", "linear", "coupling")  # of an estimated error, without that of the model
ITSELF = "itself"  # reference of a quantity that is already an error


class Row:
    def __init__(self, point, record, series):
        self.point, self.record, self.series = point, record, series
        self.own = 0.0  # error that the run itself estimates, relative; 0 if unknown
        self.ranges = {}  # of the temperatures of a run, by the quantity
        self.values, self.errors, self.reason = (
            {},
            {},
            re.sub(r" \(see \S+\)$", "", record.reason),
        )  # a log's location is meaningless elsewhere

    @property
    def good(self):
        return not self.reason


def rows_of(axes, quantities, points, tasks, records):
    """Reads every quantity of every run. A failure becomes the reason of its row."""
    rows = []
    for point, task in zip(points, tasks):
        rows.append(value_row(Row(point, records[task], axes.series_of(point)), quantities, task.results))
    return rows


def value_row(row, quantities, results):
    """Row with every quantity read from its results, or with the reason of a failure."""
    if row.good and hasattr(results, "budget"):
        row.own = max(
            (sum(v for part, v in parts.items() if part in PARTS and v > 0) for parts in results.budget().values()),
            default=0.0,
        )
    for quantity in quantities if row.good else ():
        try:
            row.values[quantity.name] = quantity.value(results)
            row.ranges[quantity.name] = quantity.range(results)
            if not math.isfinite(row.values[quantity.name]):
                row.reason = f"{quantity.name} is {row.values[quantity.name]}"
        except (Exception, SystemExit) as error:  # e.g. a missing monitor, or a series that does not oscillate
            row.reason = f"{quantity.name}: {type(error).__name__}: {error}"
    return row


def series_of(rows):
    """Returns {series: successful rows by size}."""
    found = {}
    for row in rows:
        if row.good:
            found.setdefault(row.series, []).append(row)
    return {name: sorted(some, key=lambda r: r.point.size) for name, some in found.items()}


def limits_of(rows, quantity):
    """Returns {series: Limit or None} of a quantity's values over the sizes."""
    return {
        name: fits.limit_of([r.point.size for r in some], [r.values[quantity.name] for r in some])
        for name, some in series_of(rows).items()
    }


def set_errors(rows, quantities, others=()):
    """Computes the errors. Returns {quantity: its reference}. `others` are rows of other programs, which do not affect
    the reference."""
    against = {}
    for quantity in quantities:
        name = quantity.name
        if quantity.is_error:
            for row in (*rows, *others):
                if row.good:
                    row.errors[name] = abs(row.values[name])
            against[name] = ITSELF
            continue
        reference, word = quantity.reference, "the reference"
        good = [r for r in rows if r.good]
        if reference is None or reference == "richardson":
            limits = [
                (some[-1], limit)
                for some, limit in ((series_of(rows)[s], limit) for s, limit in limits_of(rows, quantity).items())
                if limit
            ]
            reference, word = None, "no limit is approached by the values"
            # Coarse series look too certain: take the one with the smallest uncertainty among those with the largest sizes.
            if limits:
                finest, best = min(limits, key=lambda pair: (-pair[0].point.size, pair[1].gci))
                reference = best.value
                word = (
                    f"the extrapolated value {best.value:.6g} (observed order {best.order:.2f}, uncertainty"
                    f" {100 * best.gci / (quantity.size(best.value, finest) or 1):.2g} %)"
                )
        elif reference == "finest":
            finest = max(good, key=lambda r: (r.point.size, r.record.cpu)) if good else None
            reference, word = (
                (finest.values[name], f"the finest run, {finest.point.name}") if finest else (None, "no run succeeded")
            )
        else:
            word = f"the reference value {reference:g}"
        against[name] = word
        for row in (*good, *(r for r in others if r.good)) if reference is not None else ():
            row.errors[name] = abs(row.values[name] - reference) / (quantity.size(reference, row) or 1)
    return against


def read(file, axes, quantities):
    """Rows of a table written by write(). Their records lack the phases."""
    rows = []
    with open(file, newline="") as source:
        heads, count = next(lines := csv.reader(source)), len(axes.all)
        for line in lines:
            labels, cells = dict(zip(heads, line[:count])), dict(
                zip(heads[count:], line[count:])
            )  # an axis may have the name of a cost
            size = float(labels[axes.refining.name]) if axes.refining else 0
            point = Point(labels, {}, {}, size)
            costs = {c: float(cells.get(HEADS.get(c, c)) or 0) for c in COSTS}
            record = types.SimpleNamespace(
                reason=cells["reason"],
                version=cells["version"],
                state="failed" if cells["reason"] else "done",
                phases={},
                **costs,
            )
            row = Row(point, record, axes.series_of(point))
            for q in quantities:
                error = cells[q.name] if q.is_error and q.name in cells else cells[f"error of {q.name}"]
                value = error if q.is_error else cells[q.name]
                if value:
                    row.values[q.name] = float(value)
                if error:
                    row.errors[q.name] = float(error)
            rows.append(row)
    return rows


def write(file, rows, axes, quantities):
    heads = [
        *(a.name for a in axes.all),
        *(n for q in quantities for n in (q.name, f"error of {q.name}") if not (q.is_error and n == q.name)),
        *(HEADS.get(c, c) for c in COSTS),
        "version",
        "reason",
    ]
    with files.part(file.parent, file.name) as made, open(made, "w", newline="") as out:
        writer = csv.writer(out)
        writer.writerow(heads)
        for row in rows:
            cells = [row.point.labels[a.name] for a in axes.all]
            for q in quantities:
                cells += [] if q.is_error else [f"{row.values[q.name]:.8g}" if q.name in row.values else ""]
                cells += [f"{row.errors[q.name]:.4g}" if q.name in row.errors else ""]
            cells += [f"{getattr(row.record, c):.4g}" if row.record.state == "done" else "" for c in COSTS]
            writer.writerow([*cells, row.record.version, row.reason])
