# SPDX-License-Identifier: Apache-2.0
"""Sizing by few runs: the best of one to four continuous variables of a case, what `couplet study CASE.yaml --optimise`
does. The section of the case:
  study:
    participant: tank                     # keys below start at it unless they start with simulation. or participants.
    optimise:
      minimise: levelised cost            # or maximise: a quantity of summary.csv
      runs: 16                            # at most (10 a variable)
      set: {report.economics: {steel: 5}} # further changes, the same for all runs
      tolerance: 0.005                    # ends when no better value than by this share is expected
      variables:
        diameter: {from: 34, to: 50, unit: m}
        cut-off: {key: flow.cut-off, from: 5, to: 30, unit: K}
        height: {from: 8, to: 16, unit: m, sets: {bed.layers.0.height: 0.01, bed.layers.1.height: 0.99}}   # key: share
A surface of cubic radial functions through the runs so far predicts where the best is; the next runs go there, as many
at a time as there are processors, the others of a round to where the surface is known least. optimise.csv has all runs
so far; a search that was interrupted and is started again finds the runs that are done. --again repeats them."""
import itertools
import math
import os
import pathlib

import numpy as np
from scipy.interpolate import RBFInterpolator
from scipy.optimize import minimize
from scipy.spatial.distance import cdist

from couplet import files
from couplet.runs import expect, run_all, warnings_of
from couplet.study.variants import Variant


# -- the search -------------------------------------------------------------------------------------------------------
def first_points(dimensions):
    """Center and two points per axis, plus the corners between them for two variables, in the unit cube."""
    points = [np.full(dimensions, 0.5)]
    for axis in range(dimensions):
        for value in (0.1, 0.9):
            point = np.full(dimensions, 0.5)
            point[axis] = value
            points.append(point)
    if dimensions == 2:
        points += [np.array(corner) for corner in itertools.product((0.1, 0.9), repeat=2)]
    return points


def surface(points, values):
    """Surface through all points, with a plane for the trend. Failed values (inf) count as worse than all others."""
    values = np.asarray(values, float)
    good = values[np.isfinite(values)]
    worst = good.max() + (np.ptp(good) or 1) if len(good) else 1.0
    filled = np.where(np.isfinite(values), values, worst)
    degree = 1 if len(points) > len(points[0]) + 1 else 0
    return RBFInterpolator(np.array(points), filled, kernel="cubic", degree=degree)


def next_points(points, values, count, nearest):
    """`count` new points and the expected minimum of the surface: the minimum, then others with low expected values far
    from known ones. None is closer than `nearest` to a known one."""
    dimensions, model = len(points[0]), surface(points, values)
    grid = np.array(
        list(itertools.product(np.linspace(0, 1, {1: 201, 2: 41, 3: 15}.get(dimensions, 8)), repeat=dimensions))
    )
    expected = model(grid)
    best = None
    for start in grid[np.argsort(expected)[:5]]:
        found = minimize(lambda x: model(x[None, :])[0], start, method="L-BFGS-B", bounds=[(0, 1)] * dimensions)
        if best is None or found.fun < best.fun:
            best = found
    chosen = []
    if cdist(best.x[None, :], np.array(points)).min() >= nearest:
        chosen.append(best.x)
    span = np.ptp(np.asarray(values)[np.isfinite(values)]) or 1
    while len(chosen) < count:
        known = cdist(grid, np.array(points + chosen)).min(axis=1)
        score = expected - 0.5 * span * known  # low, or far from all known points
        score[known < nearest] = np.inf
        k = int(np.argmin(score))
        if not np.isfinite(score[k]):
            break
        chosen.append(grid[k])
    return chosen, float(best.fun)


def search(evaluate, dimensions, runs, tolerance, together, say=print, sign=1):
    """Minimizes a function on the unit cube. `evaluate(points)` returns a value per point (inf: failed), `together` at
    a time. Returns (best point, its value, all points, all values). Reports values times `sign`, and finally why it
    ended."""
    points, values = [], []
    todo = first_points(dimensions)[:runs]
    quiet = 0
    while todo:
        values += list(evaluate(todo))
        points += todo
        finite = [v for v in values if np.isfinite(v)]
        expect(finite, f"optimise: none of the first {len(points)} runs gave a value; see their messages above.")
        best = min(finite)
        say(f"optimise: {len(points)} runs, best so far {sign * best:.6g}")
        left = runs - len(points)
        if left <= 0:
            say(f"optimise: ends because all {runs} runs are used (study.optimise.runs)")
            break
        todo, wanted = next_points(points, values, min(together, left), 0.02)
        # Converged if the surface expects no improvement three times in a row.
        quiet = quiet + 1 if best - wanted <= tolerance * abs(best) else 0
        if quiet > 2:
            say(
                f"optimise: ends after {len(points)} of {runs} runs: three times in a row, no improvement by more than"
                f" a fraction of {tolerance:.2g} was expected (study.optimise.tolerance); a smaller tolerance looks"
                " further"
            )
            break
        if not todo:
            say(
                f"optimise: ends after {len(points)} of {runs} runs: every point is within 2 % of the range of one"
                " that was run"
            )
    k = int(np.argmin(np.where(np.isfinite(values), values, np.inf)))
    return points[k], values[k], points, values


# -- a case -----------------------------------------------------------------------------------------------------------
def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


class Variable:
    """Variable of the file: its keys and their values at a position x of its range, 0 <= x <= 1."""

    def __init__(self, name, spec, place):
        place = f"{place}.{name}"
        expect(isinstance(spec, dict), f"{place}: expected {{from: ..., to: ...}}.")
        unknown = set(spec) - {"key", "from", "to", "unit", "sets"}
        expect(
            not unknown,
            f"{place}: unknown key '{next(iter(unknown), '')}'; valid keys are key, from, to, unit and sets.",
        )
        low, high = spec.get("from"), spec.get("to")
        expect(
            is_number(low) and is_number(high) and low < high,
            f"{place}: 'from' and 'to' must be numbers, the first below the second; give the unit in 'unit'.",
        )
        self.name, self.low, self.high, self.unit = name, low, high, spec.get("unit", "")
        expect(isinstance(self.unit, str), f"{place}.unit: expected a text, not {self.unit!r}.")
        expect(not ("sets" in spec and "key" in spec), f"{place}: give either 'key' or 'sets'.")
        self.sets = spec["sets"] if "sets" in spec else {spec.get("key", name): 1}
        expect(
            isinstance(self.sets, dict)
            and self.sets
            and all(isinstance(k, str) and is_number(v) for k, v in self.sets.items()),
            (
                f"{place}.sets: expected {{key: factor, ...}}, with the number by which the variable is multiplied for"
                " each key."
            ),
        )

    def at(self, x):
        return self.low + x * (self.high - self.low)

    def changes(self, x, case, participant):
        return {
            case.absolute(key, participant): f"{self.at(x) * share:.9g} {self.unit}".strip()
            for key, share in self.sets.items()
        }


class Search:
    """Section of a case: the objective, the variables, and the number of runs."""

    def __init__(self, case):
        section, place = case.study.get("optimise"), f"{case.asked}: study.optimise"
        expect(isinstance(section, dict), f"{place}: this section does not exist.")
        unknown = set(section) - {"minimise", "maximise", "runs", "tolerance", "variables", "set"}
        expect(
            not unknown,
            (
                f"{place}: unknown key '{next(iter(unknown), '')}'; valid keys are minimise, maximise, runs, tolerance,"
                " variables and set."
            ),
        )
        expect(("minimise" in section) != ("maximise" in section), f"{place}: give either 'minimise' or 'maximise'.")
        self.case, self.sign = case, 1 if "minimise" in section else -1
        self.quantity = section.get("minimise", section.get("maximise"))
        expect(
            isinstance(self.quantity, str),
            f"{place}: expected the name of a quantity of summary.csv, not {self.quantity!r}.",
        )
        found = section.get("variables") or {}
        expect(isinstance(found, dict), f"{place}.variables: expected {{name: {{from: ..., to: ...}}}}.")
        self.variables = [Variable(name, spec, f"{place}.variables") for name, spec in found.items()]
        expect(1 <= len(self.variables) <= 4, f"{place}.variables: one to four are needed.")
        self.runs = section.get("runs", 10 * len(self.variables))
        expect(
            is_number(self.runs) and self.runs == int(self.runs) and self.runs >= 3,
            f"{place}.runs: expected a whole number of at least 3.",
        )
        self.tolerance = section.get("tolerance", 0.005)
        expect(
            is_number(self.tolerance) and self.tolerance >= 0, f"{place}.tolerance: expected a number of at least 0."
        )
        expect(isinstance(case.participants, dict), f"{case.file}: participants: expected a mapping.")
        self.participant = case.study.get("participant", next(iter(case.participants), None))
        expect(
            self.participant in case.participants,
            f"{case.asked}: study.participant: there is no participant '{self.participant}'.",
        )
        expect(
            case.program(self.participant).is_file(),
            (
                f"{case.program(self.participant)}: there is no such program. Build it, or name the "
                "folder of the build by --build."
            ),
        )
        fixed = section.get("set") or {}
        expect(isinstance(fixed, dict), f"{place}.set: expected {{key: value, ...}}.")
        self.fixed = {case.absolute(key, self.participant): value for key, value in fixed.items()}
        self.check_keys(place)

    def check_keys(self, place):
        """Rejects a key that two variables set."""
        seen = dict.fromkeys(self.fixed, "'set'")
        for variable in self.variables:
            for key in variable.changes(0, self.case, self.participant):
                expect(key not in seen, f"{place}.variables.{variable.name}: {key} is set by {seen.get(key)}, too.")
                seen[key] = f"variable '{variable.name}'"

    def changes(self, point, further):
        found = dict(self.fixed)
        for variable, x in zip(self.variables, point):
            found |= variable.changes(x, self.case, self.participant)
        double = found.keys() & further.keys() - self.fixed.keys()
        expect(not double, f"--set {next(iter(double), '')}: this is one of the variables.")
        return found | further


class Runs:
    """Runs of a case, one per point, each in a folder of its own where it is found again. `table` is written after each
    round."""

    def __init__(self, search, folder, jobs, further=None, again=False, say=print):
        self.search, self.folder, self.jobs, self.further, self.again, self.say = (
            search,
            pathlib.Path(folder),
            jobs,
            further or {},
            again,
            say,
        )
        self.points, self.values = [], []

    def task(self, number, point):
        name = f"run-{number:03d}"
        return Variant(
            self.search.case,
            name,
            self.folder / name,
            self.search.changes(point, self.further),
            alone=self.search.participant,
            timeout=86400,
        )

    def value(self, task, record):
        """Value to minimize; infinite if there is none."""
        if record.state != "done":
            return math.inf
        found = {quantity: value for (quantity, _), value in task.summary().items()}
        wanted = self.search.quantity
        expect(
            wanted in found,
            f"{self.search.case.asked}: study.optimise: summary.csv has no '{wanted}'; it has {', '.join(found)}.",
        )
        if not math.isfinite(found[wanted]):
            self.say(
                f"optimise: {task.name}: '{wanted}' is {found[wanted]:g}: it counts as failed, see"
                f" {task.folder / 'run.log'}"
            )
            return math.inf
        return self.search.sign * found[wanted]

    def __call__(self, points):
        tasks = [self.task(len(self.points) + i, point) for i, point in enumerate(points)]
        records = run_all(tasks, self.jobs, self.again, self.say)
        values = [self.value(task, records[task]) for task in tasks]
        self.points += list(points)
        self.values += values
        self.write()
        return values

    def write(self):
        rows = [[*(f"{v.name} [{v.unit}]" for v in self.search.variables), self.search.quantity]]
        for point, value in zip(self.points, self.values):
            shown = f"{self.search.sign * value:.9g}" if math.isfinite(value) else "failed"
            rows.append([*(f"{v.at(x):.9g}" for v, x in zip(self.search.variables, point)), shown])
        files.write_rows(files.folder(self.folder, "."), "optimise.csv", rows)


def run(case, arguments):
    wanted = Search(case)
    jobs = arguments.jobs or len(os.sched_getaffinity(0))
    runs = Runs(
        wanted,
        arguments.out or files.below(wanted.case.file.parent / "out", "optimise"),
        jobs,
        arguments.changes,
        arguments.again,
        lambda line: print(line, flush=True),
    )
    point, value, points, _ = search(
        runs, len(wanted.variables), int(wanted.runs), wanted.tolerance, jobs, runs.say, wanted.sign
    )
    where = ", ".join(f"{v.name} {v.at(x):.4g} {v.unit}".strip() for v, x in zip(wanted.variables, point))
    edge = [v.name for v, x in zip(wanted.variables, point) if x < 0.02 or x > 0.98]
    print(
        f"best {wanted.quantity} {wanted.sign * value:.6g} at {where}, after {len(points)} runs; all in"
        f" {runs.folder / 'optimise.csv'}"
    )
    for line in warnings_of(runs.folder / f"run-{number:03d}" / "run.log" for number in range(len(points))):
        print(line)
    failed = sum(not math.isfinite(v) for v in runs.values)
    if failed:
        print(f"{failed} of {len(points)} runs gave no value; the search avoided them")
    if edge:
        print(f"{', '.join(edge)}: the best value is at the limit of the given range; a wider range may be better.")
    return 0
