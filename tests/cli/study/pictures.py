#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Pictures of studies: at most eight series in a panel, titles and names inside the picture, other programs in the front, processor
seconds; the site draws those of a published study from its tables, and each published study names its case. usage: pictures.py"""
import pathlib
import re
import sys
import tempfile
import types

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "client/python"))
from couplet.documents import plots  # noqa: E402
from couplet.runs import Case  # noqa: E402
from couplet.study import pictures  # noqa: E402
from couplet.study.axes import Point  # noqa: E402
from couplet.study.table import Row  # noqa: E402
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import check  # noqa: E402

LONG = "LE1, gradients, methods and cells: what each of the three face gradients costs on every kind of cell by every method that takes it"
QUANTITY = types.SimpleNamespace(name="stress at D", given={})


def rows_of(methods, cells):
    """Two sizes of every series."""
    rows = []
    for g in ("thesis", "symmetric"):
        for m in methods:
            for c in cells:
                for n in (8, 16):
                    record = types.SimpleNamespace(reason="", cpu=0.1 * n, wall=99.0 * n, phases={f"phase {k}": 1.0 for k in range(11)})
                    row = Row(Point({"mesh": str(n), "gradient": g, "method": m, "cells": c}, {}, {}, n), record, f"{g}, {m}, {c}")
                    row.errors["stress at D"], row.values["stress at D"] = 1 / n**2, 1.0
                    rows.append(row)
    return rows


def looked_at(draw):
    """(figure, whether all its words lie inside) of what a function draws."""
    kept, close, save = [], pictures.plt.close, pictures.plt.Figure.savefig
    pictures.plt.close, pictures.plt.Figure.savefig = kept.append, lambda *_: None
    try:
        draw()
    finally:
        pictures.plt.close, pictures.plt.Figure.savefig = close, save
    made = kept[-1]
    made.canvas.draw()
    width, height = made.canvas.get_width_height()
    words = [made._suptitle, *(a.title for a in made.axes), *(t for a in made.axes if a.get_legend() for t in a.get_legend().get_texts())]
    boxes = [w.get_window_extent() for w in words if w.get_text()]
    close(made)
    return made, all(b.x0 >= 0 and b.y0 >= 0 and b.x1 <= width and b.y1 <= height for b in boxes)


def main():
    failed, many = 0, rows_of(("multigrid", "factors", "segregated", "block-coupled"), ("quadrilaterals", "triangles"))
    few = rows_of(("multigrid",), ("quadrilaterals",))
    with tempfile.TemporaryDirectory(prefix="couplet-pictures-") as scratch:
        file = pathlib.Path(scratch) / "picture.png"
        for name, rows, others, panels in (("16 series", many, [], 2), ("3 series and 4 peers", few, [(f"peer {k}", [(1, 0.001), (2, 0.0005)]) for k in range(4)], 1),
                                           ("3 series and 9 peers", few, [(f"peer {k}", [(1, 0.001)]) for k in range(9)], 3)):
            made, inside = looked_at(lambda rows=rows, others=others: pictures.error_against_time(LONG, rows, QUANTITY, "cpu", file, others))
            series = [sum(t.get_text() != "Pareto front" for t in a.get_legend().get_texts()) for a in made.axes]
            failed += check(f"{name}: {panels} panels, at most {pictures.MOST} series in each", len(made.axes) == panels and max(series) <= pictures.MOST, series)
            failed += check(f"{name}: no word is cut", inside)
            failed += check(f"{name}: processor seconds", "processor" in made._supxlabel.get_text())
            front = next(line for line in made.axes[0].get_lines() if line.get_label() == "Pareto front")
            failed += check(f"{name}: others are in the front", (min(front.get_ydata()) < 1 / 300) == bool(others), front.get_ydata())
        for name, draw in (("order", lambda: pictures.order(LONG, many, QUANTITY, "mesh", file)), ("growth", lambda: pictures.growth(LONG, many, "cpu", "mesh", file))):
            made, inside = looked_at(draw)
            failed += check(f"{name}: no word is cut, two panels", inside and len(made.axes) == 2)
        made, inside = looked_at(lambda: pictures.phases(LONG, many, file))
        failed += check("phases: at most eight, no word is cut, processor seconds of each run", inside and len(made.axes[1].get_legend().get_texts()) <= 8 and "(1.6 s)" in made.axes[0].get_yticklabels()[0].get_text())
        cook = pathlib.Path("docs/validation/studies/cook/report.md")
        text = plots.added(cook, (ROOT / cook).read_text(), pathlib.Path(scratch))
        drawn = re.findall(r"!\[[^]]+\]\(([^)]+)\)", text)
        failed += check("a published study is drawn from its tables", len(drawn) == 4 and all((pathlib.Path(scratch) / cook.parent / name).stat().st_size > 3000 for name in drawn), drawn)
    cases = [re.search(r"`couplet study ([\w./-]+)`", report.read_text()) for report in ROOT.glob("docs/validation/studies/*/report.md")]
    failed += check("each published study names its case", len(cases) > 10 and all(case and Case(ROOT / case[1]).study.get("axes") for case in cases), cases)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
