# SPDX-License-Identifier: Apache-2.0
"""The search of scripts/study --optimise: on functions whose best is known, with failures, and what it says about a wrong section."""
import math
import pathlib
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "scripts"))
import couplet_optimise as optimise  # noqa: E402
from couplet_run.warnings import warnings_of  # noqa: E402

FUNCTIONS = {
    "valley": lambda x: 1 + 2 * (x[0] - .63) ** 2 + (x[1] - .31) ** 2 + .5 * (x[0] - .63) * (x[1] - .31),
    "kink": lambda x: 100 + 20 * abs(x[0] - .4) + 8 * (x[1] - .7) ** 2 + 6 * max(0, x[1] - .6) * x[0],
    "cost": lambda x: (1 + .6 * x[0] + .2 * x[1]) / (1 - math.exp(-3 * (x[0] + .2) * (x[1] + .3))) * 100,
}
GRID = [(a / 8, b / 8) for a in range(9) for b in range(9)]


def quiet(*_):
    pass


def check(condition, text):
    if not condition:
        sys.exit(f"FAILED: {text}")


for name, function in FUNCTIONS.items():
    full = min(map(function, GRID))
    point, value, points, values = optimise.search(lambda todo: [function(p) for p in todo], 2, 16, 0.002, 2, say=quiet)
    check(value <= 1.01 * full, f"{name}: {value} is not within 1 % of the grid's {full}")
    check(len(points) <= 16 == 81 // 5, f"{name}: {len(points)} runs")
    check(value == min(values) == function(point), f"{name}: the best is not the best of its runs")
    # A third of the square fails: the search keeps away from it and still finds the rest's best.
    broken = lambda p: math.inf if p[0] + p[1] > 1.4 else function(p)  # noqa: E731
    _, value, _, _ = optimise.search(lambda todo: [broken(p) for p in todo], 2, 20, 0.002, 2, say=quiet)
    check(value <= 1.03 * min(map(broken, GRID)), f"{name} with failures: {value}")
line = optimise.search(lambda todo: [(p[0] - 0.77) ** 2 + 3 for p in todo], 1, 9, 1e-4, 1, say=quiet)
check(abs(line[0][0] - 0.77) < 0.03 and len(line[2]) <= 9, f"one variable: {line[0]}")
# It does not stop where it has not looked: without tolerance all runs are used.
check(len(optimise.search(lambda todo: [FUNCTIONS["valley"](p) for p in todo], 2, 14, -1, 2, say=quiet)[2]) == 14, "all runs are used")

# It says why it ended, and what it maximises as it is.
said = []
optimise.search(lambda todo: [-(3 - (p[0] - 0.5) ** 2) for p in todo], 1, 9, 1e-2, 1, say=said.append, sign=-1)
check(said[0] == "optimise: 3 runs, best so far 3", f"a value that is maximised: {said[0]}")
check("three times in a row nothing better" in said[-1] and "of 9 runs" in said[-1], f"why it ended: {said[-1]}")
said = []
optimise.search(lambda todo: [(p[0] - 0.3) ** 2 for p in todo], 1, 4, -1, 1, say=said.append)
check(said[-1] == "optimise: ends because all 4 runs are used (study.optimise.runs)", f"why it ended: {said[-1]}")
with tempfile.TemporaryDirectory() as folder:
    logs = [pathlib.Path(folder) / name for name in ("a.log", "b.log", "c.log", "none.log")]
    logs[0].write_text("[tank 0] warning: 8 days stand for a year\n[tank 0] warning: 8 days stand for a year\n[tank 0] all is well\n")
    logs[1].write_text("[tank 0] warning: 9.5 days stand for a year\n")
    logs[2].write_text("[tank 0] warning: the wall is hot\n")
    check(warnings_of(logs) == ["warning in 2 of 4 runs, for example: 8 days stand for a year",
                                "warning in 1 of 4 runs, for example: the wall is hot"], f"warnings: {warnings_of(logs)}")
    check(warnings_of(logs[3:]) == [], "no warnings")

HEAD = "participants: {tank: {program: thermocline}}\nstudy:\n  optimise:\n"
WRONG = {
    "    minimise: cost\n": "variables: one to four are needed",
    "    minimise: cost\n    maximise: heat\n    variables: {diameter: {from: 1, to: 2}}\n": "give either 'minimise' or 'maximise'",
    "    minimise: cost\n    variables: {diameter: {from: 2, to: 1}}\n": "diameter: 'from' and 'to' must be numbers, the first below the second",
    "    minimise: cost\n    variables: {diameter: {from: 1 m, to: 2 m}}\n": "the unit stands in 'unit'",
    "    minimise: cost\n    variabels: {}\n": "unknown key 'variabels'",
}
with tempfile.TemporaryDirectory() as folder:
    file = pathlib.Path(folder) / "case.yaml"
    for text, wanted in WRONG.items():
        file.write_text(HEAD + text)
        try:
            optimise.read(file)
            sys.exit(f"FAILED: accepted {text}")
        except optimise.Wrong as error:
            check(wanted in str(error), f"'{error}' does not say '{wanted}'")
    file.write_text(HEAD + "    maximise: heat\n    variables: {height: {from: 8, to: 16, unit: m, sets: {bed.layers.0.height: 0.25}}}\n")
    _, _, (height,), participant = optimise.read(file)
    check(list(height.changes(0.5, participant)) == ["participants.tank.bed.layers.0.height=3 m"], "shares of a variable")
print("ok")
