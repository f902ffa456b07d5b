# SPDX-License-Identifier: Apache-2.0
"""Quantities of interest: what is read from a run, and what its error is measured against.

quantities:
  tip: {probe: "tip y [m]", at: last, reference: 0.10008}            # a column of probes.csv
  drag: {file: forces.csv, column: "cylinder pressure x [N]", at: mean, from: 4 s}
  efficiency: {summary: eta_th}                                      # a row of a tank's summary.csv
  u: {python: "nine_points.py: errors", item: 0, is: error}          # what a function of a file beside the case returns
  velocity: {field: velocity, exact: ["sin(x)*cos(y)*exp(-2*t)", ...]}  # relative L2 norm over the cells; is an error
                                                                        itself
  profile: {file: bed.csv, column: T, over: z, against: reference.csv}  # relative L2 norm against a table
at: last (default), first, maximum, minimum, mean, amplitude, period, or a time; reference: a number, or finest,
richardson; good-to: 5.0e-4, what a number given as reference is itself uncertain by, over its size (for the estimate of
errors); orders: {upwind: 1} where a series is of another order than 2 (for the estimate of errors); absolute: true
where the error is not to be divided by the reference The error of a temperature (unit K or degC) is relative to the
range of temperatures of the run, not to kelvin."""
import dataclasses
import functools
import importlib.util
import pathlib
import re
import sys

import numpy as np

from couplet.runs import expect
from couplet.study.axes import evaluate

FUNCTIONS = {
    name: getattr(np, name)
    for name in ("sin", "cos", "tan", "exp", "log", "sqrt", "tanh", "abs", "sinh", "cosh", "where")
}
KEYS = {
    "probe",
    "file",
    "column",
    "summary",
    "python",
    "item",
    "field",
    "exact",
    "over",
    "against",
    "at",
    "from",
    "reference",
    "absolute",
    "is",
    "participant",
    "unit",
    "orders",
    "good-to",
}


@functools.cache
def module(file):
    sys.path.insert(0, str(pathlib.Path(file).parent))
    spec = importlib.util.spec_from_file_location(pathlib.Path(file).stem, file)
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


def function_of(folder, text):
    """Function of 'FILE.py: FUNCTION', a file beside the case."""
    file, function = (part.strip() for part in text.split(":"))
    return getattr(module(str(folder / file)), function)


def seconds(value):
    return float(re.sub(r"\s*s$", "", str(value)))


def maxima(t, y):
    """Times of the maxima, from the parabola through three samples."""
    i = 1 + np.nonzero((y[1:-1] > y[:-2]) & (y[1:-1] >= y[2:]))[0]
    bend = y[i - 1] - 2 * y[i] + y[i + 1]
    return t[i] - np.where(bend < 0, 0.5 * (t[i + 1] - t[i]) * (y[i + 1] - y[i - 1]) / np.where(bend < 0, bend, -1), 0)


def top(t, y):
    """Returns (time, value) of the largest value, from the parabola through three samples unless it is at an end."""
    i = int(np.argmax(y))
    if not 0 < i < len(y) - 1:
        return t[i], y[i]
    a, b, c = np.polyfit(t[i - 1 : i + 2] - t[i], y[i - 1 : i + 2], 2)
    return (t[i] - b / (2 * a), c - b * b / (4 * a)) if a != 0 else (t[i], c)


def reduced(t, y, at):
    """Reduces a series to one number."""
    if at == "last":
        return y[-1]
    if at == "first":
        return y[0]
    if at in ("maximum", "minimum"):
        sign = 1 if at == "maximum" else -1
        return sign * top(t, sign * y)[1]
    if at == "mean":
        return np.trapezoid(y, t) / (t[-1] - t[0]) if hasattr(np, "trapezoid") else np.trapz(y, t) / (t[-1] - t[0])
    if at == "amplitude":
        return 0.5 * (y.max() - y.min())
    if at == "period":
        tops = maxima(t, y)
        if len(tops) < 2:
            raise LookupError("the series does not oscillate")
        return (tops[-1] - tops[0]) / (len(tops) - 1)
    return float(np.interp(seconds(at), t, y))


@dataclasses.dataclass
class Quantity:
    name: str
    given: dict
    folder: pathlib.Path  # of the case
    participant: str

    @property
    def is_error(self):
        """Returns true if the value is already an error."""
        return self.given.get("is") == "error" or "exact" in self.given or "against" in self.given

    @property
    def reference(self):
        return self.given.get("reference")

    @property
    def unit(self):
        head = str(self.given.get("probe", self.given.get("column", "")))
        return self.given.get("unit") or (head[head.rindex("[") + 1 : -1] if head.endswith("]") else "1")

    def size(self, value, row):
        """What an error of the value is relative to: the row's range of temperatures if it is one, else the value."""
        return 1 if self.given.get("absolute") else row.ranges.get(self.name) or abs(value)

    def range(self, results):
        """Range of the run's temperatures: of all in the same table, or else of the last field. 0 for other
        quantities."""
        if self.is_error or self.unit not in ("K", "degC"):
            return 0.0
        table = (
            results.table(self.participant, "probes.csv" if "probe" in self.given else self.given["file"])
            if "python" not in self.given
            else {}
        )
        found = [v for head, v in table.items() if head.endswith(f"[{self.unit}]")]
        range_seen = float(np.ptp(np.concatenate(found))) if found else 0.0
        if range_seen > 0 or self.unit != "K":
            return range_seen
        try:  # one probe at one time: the field
            series = results.fields(self.participant)
            return float(np.ptp(series.field(len(series.times) - 1, "temperature")))
        except (LookupError, OSError):
            return 0.0

    def value(self, results):
        g, who = self.given, self.given.get("participant", self.participant)
        if "python" in g:
            found = function_of(self.folder, g["python"])(results.folder / who)
            return float(found[g["item"]] if "item" in g else found)
        if "field" in g:
            return self.norm(results.fields(who))
        if "summary" in g:
            table = results.table(who, "summary.csv")
            rows = dict(zip(table["quantity"], np.asarray(table["value"], dtype=float)))
            if g["summary"] not in rows:
                raise LookupError(f"summary.csv has no row '{g['summary']}'")
            return rows[g["summary"]]
        file, column = ("probes.csv", g["probe"]) if "probe" in g else (g["file"], g["column"])
        y = results.column(who, file, column)
        if "against" in g:
            return self.distance(results.column(who, file, g["over"]), y, g)
        t = results.column(who, file, "time [s]")
        late = t >= seconds(g.get("from", -np.inf))
        return float(reduced(t[late], y[late], g.get("at", "last")))

    def distance(self, x, y, g):
        from couplet.runs.results import read_csv

        reference = read_csv(self.folder / g["against"])
        at, wanted = reference[g["over"]], reference[g["column"]]
        order = np.argsort(x)
        gap = np.interp(at, x[order], y[order]) - wanted
        return float(np.linalg.norm(gap) / np.linalg.norm(wanted))

    def norm(self, series):
        """Relative L2 norm of the difference from the exact field at the last output, over the cells, or over the
        points with their shares of cells."""
        i = len(series.times) - 1
        field, at_points = series.field(i, self.given["field"]), series.is_at_points(i, self.given["field"])
        centres, weight = (
            (series.reference(), series.shares_of_points()) if at_points else (series.centres(), series.volumes())
        )
        field = field.reshape(len(field), -1)
        names = {
            "pi": np.pi,
            "x": centres[:, 0],
            "y": centres[:, 1],
            "z": centres[:, 2] if centres.shape[1] > 2 else 0 * centres[:, 0],
            "t": series.times[i],
        }
        exact = self.given["exact"] if isinstance(self.given["exact"], list) else [self.given["exact"]]
        wanted = np.stack([np.broadcast_to(evaluate(e, names, FUNCTIONS), len(centres)) for e in exact], axis=1)
        weight = weight[:, None]
        return float(
            np.sqrt((weight * (field[:, : wanted.shape[1]] - wanted) ** 2).sum() / (weight * wanted**2).sum())
        )


def check_exact(formula, where):
    """Checks before any run that the exact field can be computed."""
    try:
        evaluate(formula, {"pi": np.pi, **{n: np.full(1, 0.5) for n in "xyzt"}}, FUNCTIONS)
    except ValueError as error:
        expect(False, f"{where}: exact: '{formula}' is not an expression of x, y, z and t. {error}.")


def quantities_of(case, section, participant, place="study"):
    given = section.get("quantities")
    expect(
        isinstance(given, dict) and given, f"{case.file}: {place}.quantities: expected quantities of interest by name."
    )
    found = []
    for name, content in given.items():
        where = f"{case.file}: {place}.quantities.{name}"
        expect(isinstance(content, dict), f"{where}: expected a mapping.")
        unknown = set(content) - KEYS
        expect(not unknown, f"{where}: unknown key '{next(iter(unknown), '')}'; valid keys: {', '.join(sorted(KEYS))}.")
        ways = [w for w in ("probe", "file", "summary", "python", "field") if w in content]
        expect(len(ways) == 1, f"{where}: expected one of probe, file, summary, python, field.")
        expect("file" not in content or "column" in content, f"{where}: 'file' needs a 'column'.")
        expect("field" not in content or "exact" in content, f"{where}: 'field' needs 'exact'.")
        for formula in (
            content["exact"]
            if isinstance(content.get("exact"), list)
            else [content[k] for k in ("exact",) if k in content]
        ):
            check_exact(formula, where)
        if "python" in content:
            file = (case.file.parent / str(content["python"]).split(":")[0].strip()).resolve()
            expect(
                file.is_relative_to(case.file.parent.resolve()),
                f"{where}: python: '{file}' is not in the folder of the case.",
            )
        expect(
            "against" not in content or "over" in content, f"{where}: 'against' needs 'over', the column of the places."
        )
        orders = content.get("orders", {})
        expect(
            isinstance(orders, dict) and all(isinstance(p, (int, float)) and p > 0 for p in orders.values()),
            f"{where}: orders: expected {{word in a series' name: order of convergence}}.",
        )
        expect(content.get("is") in (None, "error"), f"{where}: is: expected error.")
        reference = content.get("reference")
        expect(
            reference is None or isinstance(reference, (int, float)) or reference in ("finest", "richardson"),
            f"{where}: reference: expected a number, finest or richardson.",
        )
        found.append(Quantity(str(name), content, case.file.parent, content.get("participant", participant)))
    return found
