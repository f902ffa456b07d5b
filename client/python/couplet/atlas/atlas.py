# SPDX-License-Identifier: Apache-2.0
"""What a map is, how its squares are run, kept and judged."""
import csv
import dataclasses
import itertools
import math
import pathlib
import re
import subprocess
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import Callable

from couplet.runs import environment

# How a square came out. RED is what must not be: more than 20 % off with exit code 0 and no warning.
HOLDS, POOR, WARNED, REFUSED, RED = "within 5 %", "within 20 %", "warned", "stopped", "silent"
GOOD, BOUND = 0.05, 0.2


@dataclasses.dataclass
class Axis:
    label: str
    values: list
    log: bool = True


@dataclasses.dataclass
class Map:
    name: str
    title: str
    criterion: str            # what the number in a square is
    x: Axis
    y: Axis
    panels: list              # names
    run: Callable             # (panel, x, y, Runner) -> (number, exit code, doubted) and, where it is not of the number alone, the error
    error: Callable = None    # (number) -> how far the answer is off, as a share of it
    theory: list = dataclasses.field(default_factory=list)   # [(panels or None, label, [(x, y)])]
    about: str = ""           # mechanism, failing neighbour, what the picture shows


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
        """What several squares share is made by the first that asks; the others wait."""
        with self.lock:
            if key not in self.kept:
                self.kept[key] = make()
            return self.kept[key]

    def folder(self, *key):
        """A new folder; the key is for those who look into it."""
        words = (str(k).replace("/", "_").replace(" ", "_") for k in (*key, next(self.numbers)))
        place = self.scratch / "-".join(words)
        place.mkdir(parents=True)
        return place

    def program(self, name):
        file = self.build / "bin" / name
        return file if file.exists() else self.build / "bin" / "tests" / name

    def alone(self, program, folder, files, sets=()):
        """Exit code, and whether the run flags its own result. `files`: {name: text}, with case.yaml among them."""
        return self.command([self.program(program), "case.yaml", "--strict=effects", *(w for s in sets for w in ("--set", s))], folder, files)

    def job(self, programs, folder, files):
        line = ["mpirun", "--oversubscribe"]
        for i, name in enumerate(programs):
            line += [":"] * (i > 0) + ["-n", "1", self.program(name), "case.yaml", "--strict=effects"]
        return self.command(line, folder, files)

    def command(self, line, folder, files, limit=300):
        for name, text in files.items():
            (folder / name).write_text(text)
        try:
            result = subprocess.run([str(w) for w in line], cwd=folder, env=environment(), capture_output=True, text=True, timeout=limit)
        except subprocess.TimeoutExpired:
            return 124, False
        text = result.stdout + result.stderr
        (folder / "run.log").write_text(text)
        if result.returncode == 2 and not any(word in text for word in (" is beyond ", " exceeds ")):  # what a program says of values that it cannot compute with
            raise RuntimeError(f"{folder}: the case is wrong: {text.strip().splitlines()[-1]}")
        told = ("--strict: the result is questionable", "The result is useless (")
        failed = any(re.search(r"(^|\] )error:", line) and not any(t in line for t in told) for line in text.splitlines())
        strict = result.returncode in (1, 4) and any(t in text for t in told) and not failed
        # That a mesh does not resolve turbulence is no word about the scheme.
        words = [line for line in text.splitlines() if "warning:" in line and "turbulence model neglected" not in line]
        return (0 if strict else result.returncode), strict and bool(words)


def outcome(error, code, doubted):
    if code != 0:
        return REFUSED
    if error <= BOUND:  # False for NaN
        return HOLDS if error <= GOOD else POOR
    return WARNED if doubted else RED


def judged(map_, number, code, doubted, error=None):
    if error is None:
        error = map_.error(number) if code == 0 and math.isfinite(number) else math.nan
    return Square(number, error, code, doubted, outcome(error, code, doubted))


def read(file):
    """{(panel, x, y): Square} of a table that is there."""
    if not file.exists():
        return {}
    with open(file, newline="") as rows:
        return {(r["panel"], float(r["x"]), float(r["y"])): Square(float(r["number"]), float(r["error"]), int(r["exit code"]), r["warned"] == "yes", r["outcome"])
                for r in csv.DictReader(rows)}


def write(file, map_, squares):
    with open(file, "w", newline="") as out:
        rows = csv.writer(out, lineterminator="\n")
        rows.writerow(["panel", "x", "y", "number", "error", "exit code", "warned", "outcome"])
        for panel in map_.panels:
            for y in map_.y.values:
                for x in map_.x.values:
                    if s := squares.get((panel, float(x), float(y))):
                        rows.writerow([panel, f"{x:g}", f"{y:g}", f"{s.number:.4g}", f"{s.error:.3g}", s.code, "yes" if s.doubted else "no", s.outcome])


def make(map_, file, runner, fresh=False, workers=1):
    """Runs the squares that the table does not have and those that are red; it is written after each row of them. Gives all squares."""
    squares = {} if fresh else {k: s for k, s in read(file).items() if s.outcome != RED}
    wanted = [(p, float(x), float(y)) for p in map_.panels for y in map_.y.values for x in map_.x.values]
    missing = [k for k in wanted if k not in squares]

    def one(key):
        return key, judged(map_, *map_.run(*key, runner))

    with ThreadPoolExecutor(workers) as pool:
        for i, (key, square) in enumerate(pool.map(one, missing)):
            squares[key] = square
            if i % 8 == 7:
                write(file, map_, squares)
    squares = {k: squares[k] for k in wanted}
    write(file, map_, squares)
    return squares
