# SPDX-License-Identifier: Apache-2.0
"""Sizing by few runs: the best of one to four continuous variables of a case, what `scripts/study CASE.yaml --optimise` does.
The section of the case:
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
A surface of cubic radial functions through the runs so far says where the best is expected; the next runs go there, as many at a
time as there are processors, the others of a round to where the surface is known least."""
import argparse
import concurrent.futures
import csv
import itertools
import json
import math
import os
import pathlib
import re
import subprocess
import sys

import numpy as np
import yaml
from scipy.interpolate import RBFInterpolator
from scipy.optimize import minimize
from scipy.spatial.distance import cdist

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "scripts"))
from couplet_run.warnings import warnings_of  # noqa: E402


class Wrong(Exception):
    """Something the user can mend."""


def expect(condition, text):
    if not condition:
        raise Wrong(text)


# -- the search -------------------------------------------------------------------------------------------------------
def first_points(dimensions):
    """The middle, and on each axis two points; for two variables the corners between them, too. In the unit cube."""
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
    """Through all points; a plane beside it carries the trend. Values that failed (inf) count as worse than all others."""
    values = np.asarray(values, float)
    good = values[np.isfinite(values)]
    worst = good.max() + (np.ptp(good) or 1) if len(good) else 1.0
    filled = np.where(np.isfinite(values), values, worst)
    degree = 1 if len(points) > len(points[0]) + 1 else 0
    return RBFInterpolator(np.array(points), filled, kernel="cubic", degree=degree)


def next_points(points, values, count, nearest):
    """`count` new points and the least value that the surface expects: its minimum, then others of low expected value far from
    what is known. None of them closer than `nearest` to a known one."""
    dimensions, model = len(points[0]), surface(points, values)
    grid = np.array(list(itertools.product(np.linspace(0, 1, {1: 201, 2: 41, 3: 15}.get(dimensions, 8)), repeat=dimensions)))
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
        score = expected - 0.5 * span * known  # low, or far from all that is known
        score[known < nearest] = np.inf
        k = int(np.argmin(score))
        if not np.isfinite(score[k]):
            break
        chosen.append(grid[k])
    return chosen, float(best.fun)


def search(evaluate, dimensions, runs, tolerance, together, say=print, sign=1):
    """Least value of a function on the unit cube. `evaluate(points)` gives a value a point (inf: failed), `together` at a time.
    Gives (best point, its value, all points, all values). Says values times `sign`, and at the end why it ended."""
    points, values = [], []
    todo = first_points(dimensions)[:runs]
    quiet = 0
    while todo:
        values += list(evaluate(todo))
        points += todo
        finite = [v for v in values if np.isfinite(v)]
        expect(finite, "optimise: none of the first runs gave a value.")
        best = min(finite)
        say(f"optimise: {len(points)} runs, best so far {sign * best:.6g}")
        left = runs - len(points)
        if left <= 0:
            say(f"optimise: ends because all {runs} runs are used (study.optimise.runs)")
            break
        todo, wanted = next_points(points, values, min(together, left), 0.02)
        # The surface expects nothing better three times in a row: it has converged.
        quiet = quiet + 1 if best - wanted <= tolerance * abs(best) else 0
        if quiet > 2:
            say(f"optimise: ends after {len(points)} of {runs} runs: three times in a row nothing better by more than "
                f"{tolerance:.2g} of it was expected (study.optimise.tolerance); a smaller tolerance looks further")
            break
        if not todo:
            say(f"optimise: ends after {len(points)} of {runs} runs: no place is left that is 2 % of the range from all others")
    k = int(np.argmin(np.where(np.isfinite(values), values, np.inf)))
    return points[k], values[k], points, values


# -- a case -----------------------------------------------------------------------------------------------------------
def full_key(key, participant):
    return key if re.match(r"(simulation|participants|coupling)\.", key) else f"participants.{participant}.{key}"


class Variable:
    def __init__(self, name, spec, place):
        expect(isinstance(spec, dict), f"{place}.{name}: expected {{from: ..., to: ...}}.")
        unknown = set(spec) - {"key", "from", "to", "unit", "sets"}
        expect(not unknown, f"{place}.{name}: unknown key '{next(iter(unknown), '')}'; valid are key, from, to, unit, sets.")
        low, high = spec.get("from"), spec.get("to")
        expect(isinstance(low, (int, float)) and isinstance(high, (int, float)) and low < high,
               f"{place}.{name}: 'from' and 'to' must be numbers, the first below the second; the unit stands in 'unit'.")
        self.name, self.low, self.high, self.unit = name, low, high, spec.get("unit", "")
        self.sets = spec.get("sets") or {spec.get("key", name): 1}

    def at(self, x):
        return self.low + x * (self.high - self.low)

    def changes(self, x, participant):
        for key, share in self.sets.items():
            yield f"{full_key(key, participant)}={self.at(x) * share:.9g} {self.unit}".strip()


def read(case):
    expect(case.is_file(), f"{case}: this file does not exist.")
    data = yaml.safe_load(case.read_text()) or {}
    section = (data.get("study") or {}).get("optimise")
    place = f"{case}: study.optimise"
    expect(isinstance(section, dict), f"{place}: this section does not exist.")
    unknown = set(section) - {"minimise", "maximise", "runs", "tolerance", "variables", "set"}
    expect(not unknown, f"{place}: unknown key '{next(iter(unknown), '')}'; valid are minimise, maximise, runs, tolerance, variables, set.")
    expect(("minimise" in section) != ("maximise" in section), f"{place}: give either 'minimise' or 'maximise'.")
    variables = [Variable(name, spec, f"{place}.variables") for name, spec in (section.get("variables") or {}).items()]
    expect(1 <= len(variables) <= 4, f"{place}.variables: one to four are needed.")
    participants = data.get("participants") or {}
    participant = data["study"].get("participant", next(iter(participants), None))
    expect(participant in participants, f"{case}: study.participant: there is no participant '{participant}'.")
    return data, section, variables, participant


class Runs:
    """Runs of a case, one a point; each in a folder of its own."""

    def __init__(self, case, data, section, variables, participant, arguments):
        self.case, self.variables, self.participant, self.arguments = case, variables, participant, arguments
        self.program = arguments.build / "bin" / data["participants"][participant].get("program", "?")
        self.quantity = section.get("minimise", section.get("maximise"))
        self.sign = 1 if "minimise" in section else -1
        self.folder = arguments.out or case.parent / "out" / "optimise"
        self.made = 0
        self.fixed = [f"{full_key(key, participant)}={value if isinstance(value, str) else json.dumps(value)}"
                      for key, value in (section.get("set") or {}).items()]

    def one(self, number, point):
        out = self.folder / f"run-{number:03d}"
        out.mkdir(parents=True, exist_ok=True)
        summary = out / self.participant / "summary.csv"
        summary.unlink(missing_ok=True)
        changes = [c for v, x in zip(self.variables, point) for c in v.changes(x, self.participant)]
        command = [str(self.program), str(self.case), "--participant", self.participant]
        for change in [*self.fixed, *changes, *self.arguments.set, f"simulation.output.folder={out.resolve()}"]:
            command += ["--set", change]
        environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", OMPI_ALLOW_RUN_AS_ROOT="1",
                           OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
        with open(out / "run.log", "w") as log:
            code = subprocess.run(command, stdout=log, stderr=subprocess.STDOUT, env=environment).returncode
        if code != 0 or not summary.exists():
            print(f"optimise: run {number} failed with exit code {code}, see {out / 'run.log'}", flush=True)
            return math.inf
        with open(summary, newline="") as file:
            values = {row["quantity"]: float(row["value"]) for row in csv.DictReader(file)}
        expect(self.quantity in values, f"{self.case}: study.optimise: summary.csv has no '{self.quantity}'; it has {', '.join(values)}.")
        return self.sign * values[self.quantity]

    def __call__(self, points):
        numbers = range(self.made, self.made + len(points))
        self.made += len(points)
        with concurrent.futures.ThreadPoolExecutor(self.arguments.jobs) as pool:
            return list(pool.map(self.one, numbers, points))


def write(file, runs, points, values):
    with open(file, "w", newline="") as out:
        writer = csv.writer(out)
        writer.writerow([*(f"{v.name} [{v.unit}]" for v in runs.variables), runs.quantity])
        for point, value in zip(points, values):
            writer.writerow([*(f"{v.at(x):.9g}" for v, x in zip(runs.variables, point)), f"{runs.sign * value:.9g}"])


def main(words):
    parser = argparse.ArgumentParser(prog="scripts/study --optimise", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", type=pathlib.Path)
    parser.add_argument("--optimise", action="store_true")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    arguments = parser.parse_args(words)
    data, section, variables, participant = read(arguments.case)
    runs = Runs(arguments.case, data, section, variables, participant, arguments)
    budget = int(section.get("runs", 10 * len(variables)))
    expect(budget >= 3, f"{arguments.case}: study.optimise.runs: at least 3.")
    point, value, points, values = search(runs, len(variables), budget, float(section.get("tolerance", 0.005)), arguments.jobs,
                                          sign=runs.sign)
    write(runs.folder / "optimise.csv", runs, points, values)
    where = ", ".join(f"{v.name} {v.at(x):.4g} {v.unit}".strip() for v, x in zip(variables, point))
    edge = [v.name for v, x in zip(variables, point) if x < 0.02 or x > 0.98]
    print(f"best {runs.quantity} {runs.sign * value:.6g} at {where}, after {len(points)} runs; all in {runs.folder / 'optimise.csv'}")
    for line in warnings_of(runs.folder / f"run-{number:03d}" / "run.log" for number in range(runs.made)):
        print(line)
    if edge:
        print(f"{', '.join(edge)}: the best lies at the border of the range given; beyond it may be better.")
    return 0


def run(words):
    """main() with its complaints as one line."""
    try:
        return main(words)
    except (Wrong, yaml.YAMLError) as error:
        sys.exit(f"scripts/study: {error}")
