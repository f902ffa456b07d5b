# SPDX-License-Identifier: Apache-2.0
"""The atlas of stability: each map of maps.yaml is one table of runs over two parameters, and a square is one run, read
and judged.

A map has `title`, `criterion` (what the number of a square is), `about`, the axes `x` and `y` ({label, values, log})
and
  panels     names, or {name: names that its runs have}; `beside`: panels that are not drawn
  programs   that run the case, one alone or several as a coupled job
  case       a case written out, or a folder whose case.yaml and .geo files are copied; `files`: further files, {name:
             text or a path of the project}
  with       names for the expressions below, in order, among them x, y and panel
  set        {key of the case: value}, with names in braces; a panel may have `set`, too
  read       names made of a run that ended well; t("solid/probes.csv") has the columns of a table below the output
             folder
  number     of the square; `error` (number): how far off it is
  reference  names that another run has, whose `read` are known as ref.NAME; it is made once for equal cases
  theory     curves: [{panels, label, over: the parameter s, x, y}]
Expressions are Python over these names and numpy's functions: this file belongs to the project, not to its users."""
import copy
import csv
import dataclasses
import itertools
import json
import math
import pathlib
import re
import subprocess
import threading
import types
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import yaml

from couplet.places import ROOT
from couplet.runs import environment, read_csv
from couplet.runs.case import load, with_changes

HERE = pathlib.Path(__file__).resolve().parent
# Result of a square. RED must not occur: more than 20 % off with exit code 0 and no warning.
HOLDS, POOR, WARNED, REFUSED, RED = "within 5 %", "within 20 %", "warned", "stopped", "silent"
GOOD, BOUND = 0.05, 0.2
FUNCTIONS = {
    **{
        n: getattr(np, n)
        for n in (
            "pi",
            "inf",
            "sqrt",
            "sin",
            "cos",
            "tan",
            "tanh",
            "radians",
            "mean",
            "diff",
            "hypot",
            "linspace",
            "geomspace",
            "argmax",
        )
    },
    "np": np,
    "max": lambda *v: max(*v) if len(v) > 1 else np.max(v[0]),
}


@dataclasses.dataclass
class Square:
    number: float
    error: float
    code: int
    doubted: bool
    outcome: str


class Runner:
    """Runs the programs of a build in folders of its own."""

    def __init__(self, build, scratch):
        self.build, self.scratch = pathlib.Path(build), pathlib.Path(scratch)
        self.lock, self.kept, self.numbers = threading.RLock(), {}, itertools.count()

    def once(self, key, make):
        """The first square that needs a shared result makes it; the others wait."""
        with self.lock:
            if key not in self.kept:
                self.kept[key] = make()
            return self.kept[key]

    def run(self, name, programs, files):
        """Folder, exit code, and whether the run flags its own result. `files`: {name: text}, with case.yaml among
        them."""
        folder = self.scratch / f"{name}-{next(self.numbers)}"
        folder.mkdir(parents=True)
        for file, text in files.items():
            (folder / file).write_text(text)
        words = [[self.program(n), "case.yaml", "--strict=effects"] for n in programs]
        line = (
            words[0]
            if len(words) == 1
            else [
                "mpirun",
                "--oversubscribe",
                *(w for i, one in enumerate(words) for w in ([":"] * (i > 0) + ["-n", "1", *one])),
            ]
        )
        return folder, *self.command(line, folder)

    def program(self, name):
        found = next((p for p in (self.build / "bin" / name, self.build / "bin/tests" / name) if p.exists()), None)
        if found is None:  # otherwise the square would count as a run that stopped
            raise RuntimeError(f"the program '{name}' is not built")
        return found

    def command(self, line, folder, limit=300):
        try:
            result = subprocess.run(
                [str(w) for w in line], cwd=folder, env=environment(), capture_output=True, text=True, timeout=limit
            )
        except subprocess.TimeoutExpired:
            return 124, False
        text = result.stdout + result.stderr
        (folder / "run.log").write_text(text)
        if result.returncode == 2 and not any(
            word in text for word in (" is beyond ", " exceeds ")
        ):  # what a program says of values that it cannot compute with
            raise RuntimeError(f"{folder}: the case is wrong: {text.strip().splitlines()[-1]}")
        told = ("--strict: the result is questionable", "The result is useless (")
        failed = any(
            re.search(r"(^|\] )error:", line) and not any(t in line for t in told) for line in text.splitlines()
        )
        strict = result.returncode in (1, 4) and any(t in text for t in told) and not failed
        # An unresolved turbulent flow says nothing about the stability of the scheme.
        words = [line for line in text.splitlines() if "warning:" in line and "turbulence model neglected" not in line]
        return (0 if strict else result.returncode), strict and bool(words)


def filled(thing, names):
    """Replaces {name} in the texts of a value. A text that is only a name becomes its value; any other text is read as
    YAML."""
    if isinstance(thing, dict):
        return {k: filled(v, names) for k, v in thing.items()}
    if isinstance(thing, list):
        return [filled(v, names) for v in thing]
    if not isinstance(thing, str) or "{" not in thing:
        return thing
    alone = re.fullmatch(r"\{(\w+)\}", thing)
    return names[alone[1]] if alone else thing.format_map(names)


def plain(thing):
    """Numbers of numpy as those of Python, for YAML."""
    return json.loads(json.dumps(thing, default=lambda v: v.item()))


class Map:
    def __init__(self, name, given):
        self.name, self.given = name, given
        self.title, self.criterion, self.about = given["title"], given["criterion"], given.get("about", "").strip()
        self.x, self.y = ({"log": True, **given[axis]} for axis in "xy")
        entries = lambda panels: panels if isinstance(panels, dict) else dict.fromkeys(panels or (), {})
        self.panels = list(entries(given["panels"]))
        self.every = {**entries(given["panels"]), **entries(given.get("beside"))}

    def names(self, panel, x, y, given=()):
        found = {
            **FUNCTIONS,
            "panel": panel,
            "x": x,
            "y": y,
            **{k: v for k, v in self.every[panel].items() if k != "set"},
        }
        for name, text in self.given.get("with", {}).items():
            found[name] = (
                dict(given)[name] if name in dict(given) else eval(text, found) if isinstance(text, str) else text
            )
        return {**found, **dict(given)}

    def case(self, panel, names):
        """The case of a square and its further files."""
        source = self.given["case"]
        files = {
            f: text if "\n" in text else (ROOT / text).read_text() for f, text in self.given.get("files", {}).items()
        }
        if isinstance(source, str):
            files |= {f.name: f.read_text() for f in (ROOT / source).glob("*.geo")}
            source = load((ROOT / source / "case.yaml").read_text())
        changes = {**self.given.get("set", {}), **self.every[panel].get("set", {})}
        case = with_changes(copy.deepcopy(source), filled(changes, names))
        return {k: v for k, v in case.items() if k not in ("study", "plot")}, files

    def read(self, panel, names, runner):
        """Returns (what was read or None, exit code, whether it was doubted) of a run."""
        case, files = self.case(panel, names)
        text = yaml.safe_dump(plain(case), sort_keys=False)

        def make():
            folder, code, doubted = runner.run(self.name, self.given["programs"], {**files, "case.yaml": text})
            if code != 0:
                return None, code, doubted
            found = {**names, "t": lambda file: read_csv(folder / "out" / file)}
            try:
                for name, expression in self.given.get("read", {}).items():
                    found[name] = eval(expression, found)
            except FileNotFoundError:
                return None, code, doubted
            return {name: found[name] for name in self.given["read"]}, code, doubted

        return runner.once((self.name, text), make)

    def run(self, panel, x, y, runner, **given):
        """Returns (number, exit code, doubted, error); `given`: names that are not those of `with`."""
        names = self.names(panel, x, y, given)
        found, code, doubted = self.read(panel, names, runner)
        if found is None:
            return math.nan, code, doubted, math.nan
        if "reference" in self.given:
            other = dict(self.given["reference"])
            at = other.pop("panel", panel)
            reference, *_ = self.read(at, self.names(at, x, y, other), runner)
            names["ref"] = types.SimpleNamespace(**reference)
        names |= found
        number = float(eval(self.given["number"], names))
        return (
            number,
            code,
            doubted,
            float(eval(str(self.given["error"]), {**names, "number": number})) if math.isfinite(number) else number,
        )

    def theory(self):
        """Returns [(panels or None, label, xs, ys)]"""
        for curve in self.given.get("theory", ()):
            names = {**FUNCTIONS, "s": eval(curve["over"], FUNCTIONS)}
            yield curve.get("panels"), curve["label"], *(
                eval(str(curve[axis]), names) + 0 * names["s"] for axis in "xy"
            )


def maps():
    """Returns {name: Map}"""
    given = load((HERE / "maps.yaml").read_text(), HERE / "maps.yaml")
    return {name: Map(name, one) for name, one in given.items() if not name.startswith("_")}


def outcome(error, code, doubted):
    if code != 0:
        return REFUSED
    if error <= BOUND:  # False for NaN
        return HOLDS if error <= GOOD else POOR
    return WARNED if doubted else RED


def judged(number, code, doubted, error):
    return Square(number, error, code, doubted, outcome(error, code, doubted))


def read(file):
    """Returns {(panel, x, y): Square} of a table that is there."""
    if not file.exists():
        return {}
    with open(file, newline="") as rows:
        return {
            (r["panel"], float(r["x"]), float(r["y"])): Square(
                float(r["number"]), float(r["error"]), int(r["exit code"]), r["warned"] == "yes", r["outcome"]
            )
            for r in csv.DictReader(rows)
        }


def keys(map_):
    return [(p, float(x), float(y)) for p in map_.panels for y in map_.y["values"] for x in map_.x["values"]]


def write(file, map_, squares):
    with open(file, "w", newline="") as out:
        rows = csv.writer(out, lineterminator="\n")
        rows.writerow(["panel", "x", "y", "number", "error", "exit code", "warned", "outcome"])
        for key in keys(map_):
            if s := squares.get(key):
                rows.writerow(
                    [
                        key[0],
                        f"{key[1]:g}",
                        f"{key[2]:g}",
                        f"{s.number:.4g}",
                        f"{s.error:.3g}",
                        s.code,
                        "yes" if s.doubted else "no",
                        s.outcome,
                    ]
                )


def make(map_, file, runner, fresh=False, workers=1):
    """Runs the squares that are missing in the table and those that are red. Writes the table after every eight of
    them. Returns all squares."""
    squares = {} if fresh else {k: s for k, s in read(file).items() if s.outcome != RED}
    missing = [k for k in keys(map_) if k not in squares]
    with ThreadPoolExecutor(workers) as pool:
        for i, (key, square) in enumerate(pool.map(lambda k: (k, judged(*map_.run(*k, runner))), missing)):
            squares[key] = square
            if i % 8 == 7:
                write(file, map_, squares)
    squares = {k: squares[k] for k in keys(map_)}
    write(file, map_, squares)
    return squares


def hard_cases():
    """Returns [{part, case, mechanism, criterion, holds, fails}] of tests in tests/stability: "executable: Suite.test",
    or a script's name in ctest."""
    return load((HERE / "hard-cases.yaml").read_text())


def missing_tests(root=ROOT):
    """Names of hard-cases.yaml that tests/stability does not have with its label."""
    lists, lost = {f: f.read_text() for f in (root / "tests/stability").glob("*/CMakeLists.txt")}, []
    for case in hard_cases():
        for name in (*case["holds"], *case["fails"]):
            executable, _, test = name.partition(": ")
            home = next(
                (
                    f.parent
                    for f, text in lists.items()
                    if re.search(rf"NAME\s+{executable}\b[^)]*LABELS[^)]*\bstability\b", text)
                ),
                None,
            )
            suite, _, claim = test.partition(".")
            if (
                not home
                or test
                and not any(
                    re.search(rf"TEST(_P|_F)?\(\s*{suite},\s*{claim}\)", f.read_text()) for f in home.glob("*_test.cpp")
                )
            ):
                lost.append(name)
    return lost
