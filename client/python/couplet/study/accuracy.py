# SPDX-License-Identifier: Apache-2.0
"""Error against time of a case over meshes, schemes and methods, as a table and a picture: the runs that the accuracy.py of a case
of configs/ lists. The time is that of the whole process on one core, from its start to its end without meshing; memory is its
peak. What was run before with the same programs is not run again. `couplet study` does the same for any case from a section of
its YAML."""
import csv
import pathlib
import re
import tempfile

from couplet.places import ROOT
from couplet.runs import Case, Task, Wrong, expect, run_all
from couplet.study.pictures import divided, figure, finish, looks
from couplet.study.quantities import module


def load(case):
    file = ROOT / "configs" / case / "accuracy.py"
    if not file.exists():
        there = sorted(f.parent.name for f in (ROOT / "configs").glob("*/accuracy.py"))
        raise Wrong(f"configs/{case}/accuracy.py does not exist. Cases that have one: {', '.join(there)}")
    return module(str(file))


def row_of(runs_of, series, mesh, task, record):
    if record.state != "done":
        print(f"{series}, {mesh}: {record.reason}", flush=True)
        return None
    row = {"series": series, "mesh": mesh, "wall [s]": round(record.wall, 3), "processor [s]": round(record.cpu, 3), "memory [MB]": round(record.memory)}
    row |= {name: float(f"{value:.4g}") for name, value in runs_of.errors(task.folder).items()}
    print(", ".join(f"{value}" if key in ("series", "mesh") else f"{key} {value}" for key, value in row.items()), flush=True)
    return row


def draw(title, rows, quantity, clock, picture):
    found = divided(dict.fromkeys(row["series"] for row in rows))
    styles, clock_name = looks(found), "processor" if clock.startswith("processor") else "wall"
    made, panels = figure(title, len(found))
    for axes, (_, names) in zip(panels, found):
        for k, series in enumerate(names):
            points = [(r[clock], r[quantity], r["mesh"]) for r in rows if r["series"] == series]
            axes.loglog([p[0] for p in points], [p[1] for p in points], **styles[series], label=series)
            axes.margins(x=0.1)  # room for the words beside the last point
            for seconds, gap, mesh in points if k == 0 else ():
                axes.annotate(mesh, (seconds, gap), fontsize=6, color=styles[series]["color"], xytext=(4, 4), textcoords="offset points")
    finish(made, panels, picture, f"{clock_name} time of the whole process, one core [s]", quantity)


def declare(parser):
    parser.add_argument("case", metavar="CASE", help="a folder of configs/ with an accuracy.py")
    parser.add_argument("--only", nargs="*", default=[], metavar="WORD", help="only the series whose name holds one of the words")
    parser.add_argument("--meshes", nargs="*", default=[], metavar="MESH", help="only these meshes")
    parser.add_argument("--repeat", type=int, default=1, metavar="N", help="runs of each point, of which the median counts (1; short runs are measured three times)")
    parser.add_argument("--build", type=pathlib.Path, metavar="FOLDER", help="the folder whose bin/ holds the programs")
    parser.add_argument("--clock", choices=("wall", "processor"), default="processor", help="what the picture shows (processor: steadier on a busy machine)")
    parser.add_argument("--picture", type=pathlib.Path, metavar="FILE.png", help="by default configs/CASE/out/accuracy.png; the table goes beside it as .csv")


def run(arguments):
    runs_of, case = load(arguments.case), Case(ROOT / "configs" / arguments.case / "case.yaml", arguments.build)
    picture = arguments.picture or ROOT / "configs" / arguments.case / "out" / "accuracy.png"
    picture.parent.mkdir(parents=True, exist_ok=True)
    wanted = [(series, mesh, settings) for series, points in runs_of.SERIES.items() for mesh, settings in points.items()
              if (not arguments.only or any(w in series for w in arguments.only)) and (not arguments.meshes or mesh in arguments.meshes)]
    with tempfile.TemporaryDirectory(prefix="couplet-accuracy-") as scratch:
        runs = pathlib.Path(scratch) if arguments.picture else picture.parent / "accuracy"
        tasks = [Task(case, f"{series}, {mesh}", runs / re.sub(r"[^\w.+-]+", "_", f"{series}-{mesh}"), settings, repeats=arguments.repeat)
                 for series, mesh, settings in wanted]
        records = run_all(tasks, say=lambda line: None)
        rows = [row for (series, mesh, _), task in zip(wanted, tasks) if (row := row_of(runs_of, series, mesh, task, records[task]))]
    expect(rows, "No run succeeded.")
    with open(picture.with_suffix(".csv"), "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    draw(runs_of.TITLE, rows, [k for k in rows[0]][5], f"{arguments.clock} [s]", picture)
    print(f"picture: {picture}, table: {picture.with_suffix('.csv')}")
    return 0
