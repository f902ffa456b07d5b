# SPDX-License-Identifier: Apache-2.0
"""The search of scripts/couplet study --optimise: on functions whose best is known, with failures, and what it says about a wrong section."""
import math
import pathlib
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "client/python"))
from couplet.runs import Case, Wrong  # noqa: E402
from couplet.study import optimise  # noqa: E402
from couplet.runs.pool import warnings_of  # noqa: E402

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
check("three times in a row, no improvement" in said[-1] and "of 9 runs" in said[-1], f"why it ended: {said[-1]}")
said = []
optimise.search(lambda todo: [(p[0] - 0.3) ** 2 for p in todo], 1, 4, -1, 1, say=said.append)
check(said[-1] == "optimise: ends because all 4 runs are used (study.optimise.runs)", f"why it ended: {said[-1]}")
with tempfile.TemporaryDirectory() as folder:
    logs = [pathlib.Path(folder) / name for name in ("a.log", "b.log", "c.log", "none.log")]
    logs[0].write_text("[tank 0] warning: 8 days represent a year\n[tank 0] warning: 8 days represent a year\n[tank 0] all is well\n")
    logs[1].write_text("[tank 0] warning: 9.5 days represent a year\n")
    logs[2].write_text("[tank 0] warning: the wall is hot\n")
    check(warnings_of(logs) == ["warning in 2 of 4 runs, for example: 8 days represent a year",
                                "warning in 1 of 4 runs, for example: the wall is hot"], f"warnings: {warnings_of(logs)}")
    check(warnings_of(logs[3:]) == [], "no warnings")

HEAD = "simulation: {output: {}}\nparticipants: {tank: {program: echo}}\nstudy:\n  optimise:\n"
ONE = "    variables: {diameter: {from: 1, to: 2}}\n"
WRONG = {
    "    minimise: cost\n": "variables: one to four are needed",
    "    minimise: cost\n    maximise: heat\n" + ONE: "give either 'minimise' or 'maximise'",
    "    minimise: cost\n    variables: {diameter: {from: 2, to: 1}}\n": "diameter: 'from' and 'to' must be numbers, the first below the second",
    "    minimise: cost\n    variables: {diameter: {from: 1 m, to: 2 m}}\n": "give the unit in 'unit'",
    "    minimise: cost\n    variables: {diameter: {from: true, to: 2}}\n": "'from' and 'to' must be numbers",
    "    minimise: cost\n    variables: {diameter: {from: 1, to: .inf}}\n": "'from' and 'to' must be numbers",
    "    minimise: cost\n    variables: {diameter: {from: 1, to: 2, unit: 5}}\n": "diameter.unit: expected a text",
    "    minimise: cost\n    variables: {diameter: {from: 1, to: 2, sets: [a]}}\n": "diameter.sets: expected {key: factor",
    "    minimise: cost\n    variables: {diameter: {from: 1, to: 2, sets: {a: x}}}\n": "diameter.sets: expected {key: factor",
    "    minimise: cost\n    variables: {diameter: {from: 1, to: 2, key: b, sets: {a: 1}}}\n": "give either 'key' or 'sets'",
    "    minimise: cost\n    variables: {diameter: {from: 1, to: 2}, width: {key: diameter, from: 1, to: 2}}\n": "participants.tank.diameter is set by variable 'diameter', too",
    "    minimise: cost\n    set: {diameter: 5 m}\n" + ONE: "participants.tank.diameter is set by 'set', too",
    "    minimise: cost\n    set: [a]\n" + ONE: "set: expected {key: value",
    "    minimise: cost\n    variables: [diameter]\n": "variables: expected {name:",
    "    minimise: cost\n    runs: many\n" + ONE: "runs: expected a whole number",
    "    minimise: cost\n    runs: 3.5\n" + ONE: "runs: expected a whole number",
    "    minimise: cost\n    tolerance: small\n" + ONE: "tolerance: expected a number",
    "    minimise: 5\n" + ONE: "the name of a quantity of summary.csv, not 5",
    "    minimise: cost\n    variabels: {}\n": "unknown key 'variabels'",
}
ECHO = """#!/usr/bin/python3
import pathlib, sys
sets = dict(word.split("=", 1) for word in sys.argv if "=" in word)
x = float(sets["participants.tank.diameter"].split()[0])
if x > 1.8:
    sys.exit("error: too wide")
out = pathlib.Path(sets["simulation.output.folder"]) / "tank"
out.mkdir(parents=True, exist_ok=True)
(out / "summary.csv").write_text(f"quantity,unit,value\\ncost,1,{'inf' if x < 1.15 else (x - 1.4) ** 2 + 1}\\n")
"""
with tempfile.TemporaryDirectory() as folder:
    file, bin = pathlib.Path(folder) / "case.yaml", pathlib.Path(folder) / "bin"
    bin.mkdir()
    (bin / "echo").write_text(ECHO)
    (bin / "echo").chmod(0o755)

    def read(text):
        file.write_text(HEAD + text)
        return optimise.Search(Case(file, file.parent))

    for text, wanted in WRONG.items():
        try:
            read(text)
            sys.exit(f"FAILED: accepted {text}")
        except Wrong as error:
            check(wanted in str(error), f"'{error}' does not say '{wanted}'")
    shares = read("    maximise: heat\n    variables: {height: {from: 8, to: 16, unit: m, sets: {bed.layers.0.height: 0.25}}}\n")
    check(shares.changes([0.5], {}) == {"participants.tank.bed.layers.0.height": "3 m"}, "shares of a variable")
    # A search over a program: one place fails, one gives no number; started again it finds what is done.
    said, section = [], "    minimise: cost\n    runs: 6\n    variables: {diameter: {from: 1, to: 2, unit: m}}\n"
    runs = optimise.Runs(read(section), file.parent / "out", 2, say=said.append)
    _, value, points, values = optimise.search(runs, 1, 6, 0, 1, say=quiet)
    check(value < 1.01 and sum(map(math.isinf, values)) == 2, f"search over a program: {values}")
    check(any("exit code 1: error: too wide" in line for line in said), f"the run that failed: {said}")
    check(any("'cost' is inf: it counts as failed" in line for line in said), f"the run without a number: {said}")
    rows = (file.parent / "out" / "optimise.csv").read_text().split()
    check(len(rows) == 1 + 1 + len(points) and sum("failed" in row for row in rows) == 2, f"optimise.csv: {rows}")
    said.clear()
    again = optimise.Runs(read(section), file.parent / "out", 2, say=said.append)
    check(again([points[k] for k in range(3)]) == values[:3] and all("done before" in line or "counts as" in line or "wide" in line for line in said), f"again: {said}")
    for sets, wanted in (({"participants.tank.diameter": "3 m"}, "this is one of the variables"), ({}, "summary.csv has no 'price'; it has cost")):
        try:
            optimise.Runs(read(section.replace("cost", "cost" if sets else "price")), file.parent / "other", 1, sets, say=quiet)([[0.5]])
            sys.exit(f"FAILED: accepted {sets}")
        except Wrong as error:
            check(wanted in str(error), f"'{error}' does not say '{wanted}'")
print("ok")
