#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rows of tables are data: every table is read, each measure takes the arguments that its row gives, groups are written out in order, and what a row cannot mean
is refused by its name; numbers read from a run are compared with what is right."""
import pathlib
import re
import sys
import tempfile
import types

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "client/python")]
from validation import rows, shapes, table  # noqa: E402

for name in rows.known():
    read = rows.load(name)
    there = table.read(ROOT / f"docs/validation/{name}.md")
    assert read.bars and read.sources, name
    for quantity, row in rows.written_out(rows.yaml.load((rows.FOLDER / f"{name}.yaml").read_text(), rows.Loader)["rows"]):
        # Infinity is '.inf' in YAML: 'inf' is a word, which is not compared with a number.
        assert "'inf'" not in str(row), (quantity, row)
    # A table without the rows that it had would lose what was measured.
    assert set(there) <= {b.quantity for b in read.bars}, (name, set(there) - {b.quantity for b in read.bars})
assert len(rows.known()) >= 20
assert sum(len(rows.load(name).bars) for name in rows.known()) <= 250
for page in (ROOT / "docs/validation").glob("*.md"):  # a reader learns first how old the numbers are
    assert re.search(r"\*\*[^*]*\b\d{4}-\d\d-\d\d\b[^*]*\*\*", page.read_text()[:400]), page
assert all((ROOT / "common" / folder).is_dir() for folders in rows.COMMON.values() for folder in folders)
assert rows.needed(["coupler", "configs"]) == ("common/base", "common/parallel", "common/linalg", "common/coupling", "coupler", "configs", "!coupler/diagnostics")
assert rows.needed(["common", "coupler"]) == ("common", "coupler")


def loaded(text):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "t.yaml"
        file.write_text(text)
        return rows.load("t", file)


def refused(text, words):
    try:
        loaded(text)
    except Exception as error:
        assert words in str(error), error
    else:
        sys.exit(f"not refused: {text}")


group = """rows:
  first: {wanted: pass, tests: ^a$}
  plates:
    long: true
    each: {n: [8, 16], "word, limit": [[hard, 1e-3], [soft, 1e-2]]}
    rows:
      "{word} plate, {n} cells, {other}": {wanted: "<= {limit}", at_most: [program, "{word}", key, "{limit}"]}
"""
bars = loaded(group).bars
assert [b.quantity for b in bars] == ["first", *(f"{w} plate, {n} cells, {{other}}" for n in (8, 16) for w in ("hard", "soft"))], bars
assert [b.long for b in bars] == [False, True, True, True, True] and bars[1].wanted == "<= 0.001"
job = types.SimpleNamespace(recorded=lambda program, pattern, key: ([-0.002], True))
assert bars[1].measure(job) == ("-2.0e-03", False) and bars[2].measure(job) == ("-2.0e-03", True)

job = types.SimpleNamespace(recorded=lambda program, pattern, key: ({"slope": [1.95, 2.0], "error": [0.3]}[key], True))
assert shapes.numbers(job, "p", "t", {"slope": (1.9, None), "error": (None, 0.5)}) == ("slope 1.95, 2; error 0.3", True)
assert not shapes.numbers(job, "p", "t", {"slope": (1.97, None)})[1] and not shapes.numbers(job, "p", "t", {"error": (0, 0.2)})[1]
assert shapes.near(job, "p", "t", "error", 0.29, 0.05) == ("0.3 (+3.45 %)", True) and not shapes.near(job, "p", "t", "error", 0.29, 0.03)[1]

refused("rows: {a: {wanted: x, tests: ^a$, claims: b}}", "'a': one measure, but there is tests, claims")
refused("rows: {a: {wanted: x}}", "'a': one measure, but there is none")
refused("rows: {a: {tests: ^a$}}", "'a': nothing is wanted")
refused("rows: {a: {wanted: x, test: ^a$}}", "0 functions 'test'")
refused("rows: {a: {wanted: x, claims: b}}", "missing a required argument: 'names'")
refused("rows: {a: {wanted: x, tests: ^a$}, a: {wanted: x, tests: ^b$}}", "twice: a")
refused("rows: {g: {each: {n: [1, 2]}, rows: {a: {wanted: x, tests: ^a$}}}}", "twice: a")
refused("rows: {a: {wanted: x, at_most: [a, b, c, 1]}}\nsource: [common]", "unknown source")


class Run:
    """What job.case gives: monitors of one participant that warned once."""
    folder, participant, log = pathlib.Path("/out"), "solid", "[solid] warning: coarse\n"

    def __init__(self, asked):
        self.asked = asked

    def column(self, participant, file, name):
        assert (participant, file) == ("solid", "probes.csv")
        return {"tip y [m]": [0.5, -1.0, 2.02], "drag [-]": [3.0, 9.0, 4.0]}[name]


asked = []
job = types.SimpleNamespace(quick=False, case=lambda case, keys, ranks, timeout: asked.append((case, keys)) or Run(keys))
given = {"case": "le1", "read": "probes.csv: tip y [m]", "of": "2*1", "within": 0.02}
assert shapes.run(job, **given) == ("2.02 m (+1.00 %)", True)
assert shapes.run(job, **{**given, "within": 0.005}) == ("2.02 m (+1.00 %)", False)
assert shapes.run(job, **{**given, "within": None}) == ("2.02 m (+1.00 %)", None)  # nothing judges: reported
assert shapes.run(job, **given, quiet=True)[1] is False  # right, but it warned
text, met = shapes.run(job, "le1", ["probes.csv: least tip y [m]", "probes.csv: largest drag [-]"], low=(-2, 8), high=(0, 8.5), keys=[".a=1", ["b=2"]], meshes=["n: 1", "n: 2"])
assert (text, met) == ("tip y -1, -1 m; drag 9, 9", False), (text, met)
assert asked[-1] == ("le1", (".a=1", "b=2", ".mesh-parameters={n: 2}")), asked[-1]
assert abs(shapes.number("-pi*2**3/4") + 6.283185307) < 1e-9 and shapes.number(None) is None
for wrong in ("__import__('os')", "x", "len([1])"):
    try:
        shapes.number(wrong)
    except ValueError:
        continue
    sys.exit(f"taken as a number: {wrong}")


class Coupled:
    """A run of two participants whose fluid's drag converges to 2 with the square of 1/n, in 2 and 4 passes."""
    participant, folder, cost, log = "fluid", pathlib.Path("/nowhere"), types.SimpleNamespace(cpu=90), ""

    def __init__(self, keys):
        self.n = next((int(k.rsplit(" ", 1)[1][:-1]) for k in keys if "mesh-parameters" in k), 8)
        self.shift = 0.01 * ("coupling.order=parallel" in keys)

    def column(self, participant, file, name):
        assert (participant, file) == ("solid", "probes.csv"), (participant, file)
        return rows_np.array([1.0, 2 + 1 / self.n**2 + self.shift])

    def iterations(self):
        return rows_np.array([2, 4])


rows_np = shapes.np
asked = []
job = types.SimpleNamespace(quick=True, case=lambda case, keys, ranks, timeout: asked.append((keys, ranks)) or Coupled(keys))
assert shapes.run(job, "c", ["solid/probes.csv: y", "passes: mean"], high=(3, 3), quick="end=1", cost=True) == ("y 2.0156; mean coupling iterations per step 3 (1.5 processor minutes)", True)
assert asked[-1] == (("end=1",), ())
assert shapes.run(job, "c", "solid/probes.csv: y", of=2, limits=(None, 0.005), meshes=("n: 4", "n: 16"))[1]
assert not shapes.run(job, "c", "solid/probes.csv: y", of=2, limits=(0.005, 0.005), meshes=("n: 4", "n: 16"))[1]
text, met = shapes.order(job, "c", "solid/probes.csv: y", ("n: 4", "n: 8", "n: 16"), 1.9, of=2, limits=(None, None, 0.01))
assert met and text == "2.0625, 2.01562, 2.00391: order 2.00 (the last +0.195 %)", text
assert shapes.order(job, "c", "solid/probes.csv: y", ("n: 4", "n: 8"), 1.9, of=2, errors=True)[1] and not shapes.order(job, "c", "solid/probes.csv: y", ("n: 4", "n: 8"), 2.1, of=2, errors=True)[1]
assert shapes.extrapolated(job, "c", "solid/probes.csv: y", ("n: 4", "n: 8", "n: 16"), 0.002)[1] and not shapes.extrapolated(job, "c", "solid/probes.csv: y", ("n: 4", "n: 8", "n: 16"), 0.001)[1]
together = {"case": "c", "read": "solid/probes.csv: all y", "runs": {"serial": None, "parallel": "coupling.order=parallel"}}
assert shapes.apart(job, **together, within=0.01) == ("serial: runs; parallel: 5.0e-03 apart", True) and not shapes.apart(job, **together, within=0.001)[1]
assert shapes.run(job, "c", "solid/probes.csv: y", keys=("ranks=1,2",)) == ("2.0156", None) and asked[-1] == ((), (1, 2))
