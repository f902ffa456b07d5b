# SPDX-License-Identifier: Apache-2.0
"""Values of the curves in a section `plot`: from monitors, tables beside the case, fields of the last output, and
functions."""
import re

import numpy as np

from couplet import fields
from couplet.plots.section import seconds
from couplet.runs.case import Wrong, expect
from couplet.runs.folder import warn_if_older
from couplet.runs.results import read_csv
from couplet.series import find_series
from couplet.study.axes import evaluate
from couplet.study.quantities import FUNCTIONS, module

POINTS_OF_A_FUNCTION = 200


def number(text):
    try:
        return float(text)
    except ValueError:
        return np.nan


def columns_of(file):
    """Returns {head: numbers} with NaN for other values. The head is the first line without #, or the last comment if
    that is a row of numbers."""
    warn_if_older(file)
    try:
        lines = [line for line in file.read_text().splitlines() if line.strip()]
    except OSError as problem:
        raise Wrong(f"{file}: {problem.strerror}.") from None
    except UnicodeDecodeError:
        raise Wrong(
            f"{file}: the file is not a text file; to plot fields, use couplet plot FOLDER --field NAME"
        ) from None
    comments, rows = [line for line in lines if line.startswith("#")], [
        line for line in lines if not line.startswith("#")
    ]
    expect(rows, f"{file}: the file contains no rows.")
    is_bare = comments and all(np.isfinite(number(cell)) for cell in rows[0].split(","))
    columns = read_csv(file, [cell.strip() for cell in comments[-1].lstrip("# ").split(",")] if is_bare else None)
    expect(
        len(next(iter(columns.values()))),
        f"{file}: no row contains values for all {len(columns)} columns of the header.",
    )
    return {
        name: values if values.dtype == float else np.array([number(v) for v in values])
        for name, values in columns.items()
    }


class Source:
    """Named values of equal length. `order` lists the names of a table's columns."""

    def __init__(self, columns, names, place):
        self.columns, self.names, self.place = columns, {"pi": np.pi, **names}, place

    def column(self, name, where):
        expect(name in self.columns, f"{where}: {self.place} has no '{name}'; it has: {', '.join(self.columns)}.")
        return self.columns[name]

    def value(self, text, where, functions=()):
        """Value of a column, or of an expression of columns."""
        if str(text) in self.columns:
            return self.columns[str(text)]
        try:
            size = len(next(iter(self.columns.values())))
            with np.errstate(all="ignore"):  # other values are not drawn
                return np.broadcast_to(evaluate(text, self.names, {**FUNCTIONS, **dict(functions)}), size).astype(float)
        except ValueError as error:
            raise Wrong(f"{where}: {error}; {self.place} has: {', '.join(self.columns)}.") from None


def component_of(series, i, name, where):
    """Field, or its component for names such as `velocity x`; for points the mean over each cell."""
    field, axis = (name[:-2], name[-1]) if re.search(r" [xyz]$", name) else (name, None)
    try:
        return fields.values_of(series, i, field, axis)
    except Wrong as problem:
        raise Wrong(f"{where}: {problem}") from None


def series_in(out, participant):
    try:
        return find_series(out / participant)
    except FileNotFoundError:
        raise Wrong(f"{out / participant}: there are no fields. Run the case first.") from None


def of_fields(curve, out, where):
    series = series_in(out, curve["fields"])
    at = seconds(curve.get("at"), f"{where}.at")
    i = len(series.times) - 1 if at is None else series.nearest(at)
    centres = series.centres()
    names = {n: centres[:, k] if k < centres.shape[1] else 0 * centres[:, 0] for k, n in enumerate("xyz")}
    names |= {
        short: component_of(series, i, name, f"{where}.with.{short}") for short, name in curve.get("with", {}).items()
    }
    return Source(dict(names), {**names, "t": series.times[i]}, f"{curve['fields']}'s fields")


def source_of(curve, case, out, where):
    if "fields" in curve:
        return of_fields(curve, out, where)
    if "function" in curve:
        x = np.linspace(curve["from"], curve["to"], POINTS_OF_A_FUNCTION)
        return Source({"x": x}, {"x": x}, "a function")
    if "points" in curve:
        return Source(
            {"x": np.array(curve["points"], float)[:, 0], "y": np.array(curve["points"], float)[:, 1]},
            {},
            "a list of points",
        )
    if "python" in curve:
        expect(
            case.trusted,
            f"{where}.python: a function beside the case draws this curve. If you trust it, add --allow-commands",
        )
        file, function = (part.strip() for part in curve["python"].split(":"))
        found = getattr(module(str(case.file.parent / file)), function, None)
        expect(found, f"{where}.python: {file} has no function '{function}'.")
        columns = {
            name: np.asarray(values, float) for name, values in found(out / next(iter(case.participants))).items()
        }
        return Source(
            columns,
            {
                "t": next(iter(columns.values())),
                **{short: columns[name] for short, name in curve.get("with", {}).items()},
            },
            curve["python"],
        )
    kind = "monitor" if "monitor" in curve else "table"
    file = (out if kind == "monitor" else case.file.parent) / curve[kind]
    expect(
        file.is_file(), f"{where}.{kind}: there is no {file}." + (" Run the case first." if kind == "monitor" else "")
    )
    columns = columns_of(file)
    if "at" in curve:
        time, at = next(iter(columns.values())), seconds(curve["at"], f"{where}.at")
        columns = {
            name: values[time == (time[-1] if at is None else time[np.abs(time - at).argmin()])]
            for name, values in columns.items()
        }
    found = Source(columns, {}, str(file))
    found.names |= {short: found.column(name, f"{where}.with.{short}") for short, name in curve.get("with", {}).items()}
    first = next(iter(columns.values()))
    found.names |= {"t": first, "row": np.arange(len(first), dtype=float)}
    return found


def points_of(curve, case, out, where):
    """Returns [(x, y, value of `each` or None)]: one curve, or one per value of `each`. Empty for an optional run that
    does not exist."""
    if curve.get("optional") and not (out / curve["monitor"]).is_file():
        return []
    source = source_of(curve, case, out, where)
    x = source.value(curve.get("x", next(iter(source.columns))), f"{where}.x")

    def mean(values):
        """Averages rows of equal x (to round-off)."""
        order = np.argsort(x, kind="stable")
        group = np.empty(len(x), int)
        group[order] = np.concatenate([[0], np.cumsum(np.diff(x[order]) > 1e-6 * np.ptp(x))])
        return (np.bincount(group, values) / np.bincount(group))[group]

    y = source.value(
        curve.get("y", curve.get("function", "y")),
        f"{where}.{'function' if 'function' in curve else 'y'}",
        {"mean": mean},
    )
    keep = np.isfinite(x) & np.isfinite(y)
    if "where" in curve:
        keep &= source.value(curve["where"], f"{where}.where", {"min": np.min, "max": np.max}) != 0
    expect(keep.any(), f"{where}: no row of {source.place} is left to draw.")
    if "each" not in curve:
        return [(x[keep], y[keep], None)]
    each = source.value(curve["each"], f"{where}.each")
    return [(x[keep & (each == value)], y[keep & (each == value)], value) for value in np.unique(each[keep])]
