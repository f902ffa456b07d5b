# SPDX-License-Identifier: Apache-2.0
"""The section `plot` of a case: what it draws from which values, what it refuses, and that fields are drawn where the body is."""
import argparse
import contextlib
import io
import os
import pathlib
import sys
import tempfile
import time

import h5py
import numpy as np
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "client/python"), str(ROOT / "tests/support")]
from checks import check, end  # noqa: E402
from command import couplet  # noqa: E402
from couplet import fields  # noqa: E402
from couplet.plots.section import check as check_section  # noqa: E402
from couplet.plots.sources import columns_of, points_of  # noqa: E402
from couplet.runs.case import Case, Wrong  # noqa: E402
from couplet.series import find_series  # noqa: E402

SQUARES = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])
STILL = np.array([[x, y, 0.0] for y in (0, 1) for x in (0, 1, 2)])
MOVE = np.column_stack([0 * STILL[:, 0], 0.1 * STILL[:, 0] ** 2, 0 * STILL[:, 0]])
GOOD = yaml.safe_load("""
columns: 2
panels:
  - title: tip
    x: {label: "time [s]", from: 0}
    y: {log: false}
    curves:
      - {monitor: solid/probes.csv, with: {y: "tip y [m]"}, y: 1000*y, label: Couplet, extrema: true}
      - {table: tip.csv, y: "tip [mm]", style: points}
      - {function: exp(-x), from: 0, to: 2, style: dashed}
      - {levels: [5]}
      - {points: [[1, 2]], style: squares}
  - curves:
      - {fields: solid, with: {s: stress}, x: x, y: s/1e6, where: x < 1, style: dots}
  - {field: stress, bodies: [solid], mesh: black, range: [0, 3], factor: 1.0e-6, at: {first-maximum: "tip y [m]", monitor: solid/probes.csv}}
quantities:
  tip: {probe: "tip y [m]", at: maximum, unit: m, reference: 1}
""")


def case_in(folder, section):
    folder.mkdir(exist_ok=True)
    body = {"simulation": {"end-time": 1, "time-step": 1, "output": {"folder": "out"}}, "participants": {"solid": {"program": "solid_solver"}}}
    (folder / "case.yaml").write_text(yaml.safe_dump({**body, **({"plot": section} if section else {})}))
    return Case(folder)


def run_in(out):
    (out / "solid").mkdir(parents=True)
    t = np.linspace(0, 2, 41)
    (out / "solid/probes.csv").write_text("time [s],tip y [m]\n" + "".join(f"{a},{np.sin(2 * a)}\n" for a in t))
    with h5py.File(out / "solid/solid.h5", "w") as file:
        file.attrs["format"], file.attrs["kind"] = "couplet fields", 5
        file["mesh/cells"], file["mesh/coordinates"] = SQUARES, STILL
        for k in range(2):
            step = file.create_group(f"steps/{k:06d}")
            step.attrs["time"] = float(k)
            step["coordinates"] = STILL + k * MOVE
            step["cells/stress"] = np.array([1e6, 3e6]) * k
            step["points/displacement"] = k * MOVE


def plot(*words):
    return couplet("plot", *words)


def changed(path, value):
    """GOOD with another value at panels[0].curves[0].key, or without it (None)."""
    section = yaml.safe_load(yaml.safe_dump(GOOD))
    node = section
    for key in path[:-1]:
        node = node[key]
    node.pop(path[-1]) if value is None else node.__setitem__(path[-1], value) if isinstance(node, dict) else node.insert(path[-1], value)
    return section


CURVE = ("panels", 0, "curves", 0)
WRONG = [  # when the case is checked
    (("panel",), 1, "plot: unknown key 'panel'; allowed: "), (("panels",), None, "plot: the key 'panels' is missing"), (("panels",), [], "expected at least 1 values"),
    (("size",), [1], "plot.size: expected 2 values, found 1"), (("size",), [1e6, 1], "plot.size: expected width and height from 1 to 100 inch"), (("file",), "../x.png", "plot.file: '../x.png'"), (("panels", 0, "field"), "stress", "panels[0]: expected either curves or field"),
    (("panels", 0, "warp"), 2, "panels[0]: 'warp' belongs to a field"), (("panels", 2, "participant"), "fluid", "there is no participant 'fluid'; the participants are: solid"),
    (("panels", 2, "at"), "soon", "panels[2].at: 'soon' is not a time"), ((*CURVE, "table"), "tip.csv", "curves[0]: expected one of monitor, table"), ((*CURVE, "y"), None, "the key 'y' is missing"),
    ((*CURVE, "style"), "wavy", "curves[0].style: 'wavy'; allowed: line, points"), ((*CURVE, "extrema"), "yes", "curves[0].extrema: expected true or false, found 'yes'"),
    (("panels", 0, "curves", 2, "to"), None, "a function needs 'from' and 'to'"), (("quantities", "tip", "prob"), 1, "plot.quantities.tip: unknown key 'prob'"),
    (("panels", 0, "curves", 1, "optional"), True, "'optional' belongs to a monitor"), (("panels", 0, "curves", 5), {"python": "none.py: f", "y": "a"}, "curves[5].python: 'none.py: f'")]
LATE = [  # when it is drawn
    ((*CURVE, "y"), "1000*z", "curves[0].y: 'z' is not allowed here; use numbers"), ((*CURVE, "y"), "__import__('os')", "curves[0].y: "), ((*CURVE, "monitor"), "solid/prob.csv", "there is no "),
    ((*CURVE, "with"), {"y": "tip"}, "curves[0].with.y: "), (("panels", 1, "curves", 0, "with"), {"s": "strain"}, "there is no field 'strain'; the fields are: stress"), (("panels", 1, "curves", 0, "where"), "x > 9", "no row of solid's fields is left"),
    ((*CURVE, "colour"), "notacolour", "plot.panels[0]: 'notacolour'"), (("panels", 2, "colours"), "bogus", "plot.panels[2]: 'bogus'"), (("title",), "$\\nosuch$", "plot: "),
    (("quantities", "tip", "probe"), "top", "plot.quantities.tip: ")]

argparse.ArgumentParser(description=__doc__).parse_args()
with tempfile.TemporaryDirectory(prefix="a case with blanks ") as name:
    folder = pathlib.Path(name)
    case, out = case_in(folder, GOOD), folder / "out"
    (folder / "tip.csv").write_text("# of a book\n# t [s],tip [mm]\n0,0\n1,1\n")
    done = plot(folder / "case.yaml")
    check("before the run", done.returncode == 2 and "run the case first" in done.stderr, done.stderr)
    run_in(out)
    done = plot(folder / "case.yaml")
    picture = out / f"{folder.name}.png"
    check("the picture is drawn and named", done.returncode == 0 and f"picture: {picture}" in done.stdout and picture.stat().st_size > 20000, done)
    check("quantities beside their references", "tip: 1 m, reference 1 (" in done.stdout, done.stdout)
    out.rename(folder / "elsewhere")
    done = plot(folder / "case.yaml", "--out", folder / "elsewhere", "--picture", folder / "mine.png")
    check("--out and --picture", done.returncode == 0 and (folder / "mine.png").exists(), done)
    (folder / "elsewhere").rename(out)

    for path, value, words in WRONG:
        said = ""
        try:
            check_section(case_in(folder / "w", changed(path, value)))
        except Wrong as problem:
            said = str(problem)
        check(f"{'.'.join(map(str, path))} = {value}", words in said and "case.yaml: plot" in said, said)
    from couplet.plots.draw import draw
    (folder / "w/tip.csv").write_text((folder / "tip.csv").read_text())
    for path, value, words in LATE:
        try:
            draw(case_in(folder / "w", changed(path, value)), out, folder / "w.png")
            said = ""
        except Wrong as problem:
            said = str(problem)
        check(f"{'.'.join(map(str, path))} = {value}", words in said, said)

    # values
    values = points_of({"monitor": "solid/probes.csv", "with": {"y": "tip y [m]"}, "x": "where(t < 1, 0, 1)", "y": "mean(y)"}, case, out, "")[0]
    t = np.linspace(0, 2, 41)
    check("mean over rows of equal x", np.allclose(values[1][t < 1], np.sin(2 * t[t < 1]).mean()) and np.allclose(values[1][t >= 1], np.sin(2 * t[t >= 1]).mean()), values)
    found = points_of({"monitor": "solid/probes.csv", "y": "tip y [m]", "each": "t > 1"}, case, out, "")
    check("each: a curve for each value", [len(x) for x, _, _ in found] == [21, 20] and [v for _, _, v in found] == [0, 1], found)
    last = points_of({"fields": "solid", "with": {"s": "stress", "u": "displacement y"}, "x": "x", "y": "s/1e6 + 0*u"}, case, out, "")[0]
    check("cells of the last output", np.allclose(last[0], [0.5, 1.5]) and np.allclose(last[1], [1, 3]), last)
    first = points_of({"fields": "solid", "at": "0 s", "with": {"s": "stress"}, "x": "x", "y": "s"}, case, out, "")[0]
    check("cells of another output", np.allclose(first[1], 0), first)
    (folder / "made.py").write_text("def made(folder):\n    return {'x [m]': [0.0, 1.0], 'name': [2.0, len(folder.name)]}\n")
    curve = {"python": "made.py: made", "with": {"n": "name"}, "y": "2*n"}
    try:
        points_of(curve, case, out, "")
        raise AssertionError("a function beside a case is called without leave")
    except Wrong:
        case.trusted = True
    made = points_of(curve, case, out, "")[0]
    check("columns of a function beside the case", list(made[0]) == [0, 1] and list(made[1]) == [4, 10], made)
    check("a run that need not be there", points_of({"monitor": "../other/probes.csv", "y": "a", "optional": True}, case, out, "") == [])
    check("a head that is a comment", list(columns_of(folder / "tip.csv")) == ["t [s]", "tip [mm]"])

    # a body is drawn with its displacement once, or as often as one asks
    series = find_series(out / "solid")
    for warp in (0, 1, 3):
        check(f"places with {warp} times the displacement", np.allclose(fields.places_of(series, 1, warp, "stress"), STILL + warp * MOVE))

    # names of curves, with and without a unit
    from couplet.plot import curves
    axes = curves(t, "t", {"relative residual": t, "tip x [m]": t}, ["relative residual", "tip x [m]"], False, "").axes
    check("a legend has the whole name", [a.get_legend_handles_labels()[1] for a in axes] == [["relative residual"], ["tip x"]])

    # what the last run did not write is drawn with a warning
    def warned():
        with contextlib.redirect_stderr(io.StringIO()) as said:
            columns_of(out / "solid/probes.csv")
        return "probes.csv: belongs to an earlier run" in said.getvalue()

    check("no warning of a file of this run", not warned())
    for name, age in (("probes.csv", 100), ("effective.yaml", 50)):
        (out / "solid" / name).touch()
        os.utime(out / "solid" / name, (time.time() - age, time.time() - age))
    check("none while the run works", not warned())
    (out / "solid/run.json").write_text('{"steps": 3}')
    check("a warning of a file of an earlier run", warned())
    (out / "solid/run.json").write_text('{"steps": 0}')
    check("none where the run made no step", not warned())

    # a folder of a case is its case file
    done = plot(folder)
    check("a folder with case.yaml", done.returncode == 0 and f"picture: {picture}" in done.stdout, done)

    # no section: the monitors
    done = plot(case_in(folder, None).file)
    check("a case without the section", done.returncode == 0 and "probes.png" in done.stdout, done)

for file in sorted((ROOT / "configs").glob("*/case.yaml")):
    one = Case(file)
    if "plot" in one.data:
        check_section(one)
        names = {k for panel in one.data["plot"]["panels"] for c in panel.get("curves", ()) for k in [c.get("table")] if k}
        check(f"{file.parent.name}: valid, its tables are there", all((file.parent / n).is_file() for n in names), names)
end()
