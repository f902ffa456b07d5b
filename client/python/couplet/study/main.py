# SPDX-License-Identifier: Apache-2.0
"""Runs the section `study` of a case and reports the result: named variants with their summaries in one table, axes
with the error against time, or the best values of some variables. An interrupted study continues where it stopped,
and two that run concurrently share the work. docs/studies.md describes the section."""
import fnmatch
import os
import pathlib
import re
import time

from couplet import files
from couplet.runs import Case, expect, run_all, warnings_of
from couplet.study import variants


def say(line):
    print(line, flush=True)


def chosen(names, arguments):
    found = [name for name in names if any(fnmatch.fnmatch(name, pattern) for pattern in arguments.only.split(","))]
    expect(found, f"--only {arguments.only}: there is no such variant.")
    return found


def out_of(case, arguments):
    return arguments.out or files.below(case.file.parent / "out", "study")


def run_variants(cases, arguments):
    runs, several = [], arguments.out and len(cases) > 1
    for case in cases:
        participant, found = variants.variants_of(case)
        for name in found:
            if any(fnmatch.fnmatch(name, pattern) for pattern in arguments.only.split(",")):
                folder = out_of(case, arguments) / (f"{case.file.parent.name}-{name}" if several else name)
                runs.append(
                    variants.Variant(
                        case, name, folder, {**found[name], **arguments.changes}, alone=participant, timeout=86400
                    )
                )
    expect(runs, f"--only {arguments.only}: there is no such variant.")
    if arguments.list:
        for run in runs:
            print(run.name, *run.command()[2:])
        return 0
    jobs = arguments.jobs or len(os.sched_getaffinity(0))
    start = time.monotonic()
    records = run_all(runs, jobs, arguments.again, say)
    for case in cases:
        good = [run for run in runs if run.case is case and records[run].state == "done"]
        if good:
            folder = out_of(case, arguments)
            variants.write_table(folder / (f"{case.file.parent.name}.csv" if several else "table.csv"), good)
    for line in warnings_of(run.folder / "run.log" for run in runs):
        say(line)
    failed = sum(record.state != "done" for record in records.values())
    print(
        f"{len(runs) - failed} of {len(runs)} variants in {time.monotonic() - start:.1f} s, {jobs} at a time; "
        f"one after another they would take {sum(r.wall for r in records.values()):.1f} s"
    )
    return 1 if failed else 0


def run_axes(case, arguments):
    from couplet.study.study import Study

    out = out_of(case, arguments)
    study = Study(case, out, arguments.changes, arguments.repeats)
    if arguments.for_error:
        from couplet.study.predict import for_error

        return for_error(study, arguments.for_error, arguments.quantity, say)
    points = study.axes.points()
    names = chosen([p.name for p in points], arguments)
    points = [p for p in points if p.name in names]
    if arguments.list:
        for point in points:
            print(point.name, *map(str, study.task(point).command()[2:]))
        return 0
    rows = study.run(points, arguments.jobs or 1, arguments.again, say)
    peers, why = [], {}
    if arguments.peers:
        from couplet.peers.race import Race

        race = Race(study, say, arguments.allow_commands)
        peers, why = race.rows(rows), race.why
        for name, reason in why.items():
            say(f"{name} was not run: {reason}")
    page = study.report(rows, peers, why)
    if arguments.publish:
        for file in (*out.glob("peers.csv"), out / "runs.csv"):
            files.copy(file, files.folder(arguments.publish, "."))
        files.write(
            arguments.publish,
            "report.md",
            re.sub(r"^!\[.*\]\(.*\)\n\n?", "", (out / "report.md").read_text(), flags=re.M),
        )
    failed = [row for row in rows if not row.good]
    for row in failed:
        say(f"failed: {row.point.name}: {row.record.reason or row.reason}")
    say(f"{len(rows) - len(failed)} of {len(rows)} runs; table: {out / 'runs.csv'}, report: {page}")
    return 1 if failed else 0


def declare(parser):
    parser.add_argument(
        "cases", nargs="+", type=pathlib.Path, metavar="CASE", help="case files; several only for studies of variants"
    )
    parser.add_argument(
        "--only",
        default="*",
        metavar="NAMES",
        help="runs to make, separated by commas; * matches any text (diameter-*)",
    )
    parser.add_argument(
        "--jobs",
        type=int,
        metavar="N",
        help="number of concurrent runs (default: the number of processors; 1 for axes, whose times are compared)",
    )
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="changes a value in all runs")
    parser.add_argument(
        "--out",
        type=pathlib.Path,
        metavar="FOLDER",
        help="folder for runs and tables (default: out/study or out/optimise next to the case)",
    )
    parser.add_argument("--build", type=pathlib.Path, metavar="FOLDER", help="folder whose bin/ contains the programs")
    parser.add_argument("--list", action="store_true", help="lists the runs and their changes")
    parser.add_argument("--repeats", type=int, metavar="N", help="repetitions of each run of axes; their median counts")
    parser.add_argument(
        "--publish",
        type=pathlib.Path,
        metavar="FOLDER",
        help="copies the report (without its plots) and the tables to this folder",
    )
    parser.add_argument("--again", action="store_true", help="repeats runs even if results exist")
    parser.add_argument(
        "--peers",
        action="store_true",
        help=(
            "also writes the case for CalculiX or OpenFOAM, runs those that are installed, and shows them in the same"
            " pictures; reports why if it cannot"
        ),
    )
    parser.add_argument(
        "--allow-commands",
        action="store_true",
        help="with --peers: allows a .geo to run commands and write files, with your permissions",
    )
    parser.add_argument(
        "--for-error",
        metavar="SHARE",
        help=(
            "predicts the cheapest setting for this error (such as 1%%) from a few cheap runs, runs it, and compares"
            " error and time with the prediction"
        ),
    )
    parser.add_argument(
        "--quantity", metavar="NAME", help="quantity that --for-error is about, if the study has several"
    )
    parser.add_argument(
        "--quantities",
        action="store_true",
        help=(
            "estimates the errors of the study's quantities for the case as it is, from runs with a half and a quarter"
            " of the cells along each line, with two and four times the step, and with tighter tolerances (section"
            " `sources`), and names the dominant contribution"
        ),
    )
    parser.add_argument("--optimise", action="store_true", help="finds the best values of some variables in few runs")


def run(arguments):
    expect(all("=" in change for change in arguments.set), "--set: expected KEY=VALUE.")
    expect(arguments.jobs is None or arguments.jobs >= 1, "--jobs: at least one.")
    arguments.changes = dict(change.split("=", 1) for change in arguments.set)
    cases = [Case(file, arguments.build) for file in arguments.cases]
    if arguments.optimise:
        from couplet.study import optimise

        expect(len(cases) == 1, "--optimise: one case at a time.")
        return optimise.run(cases[0], arguments)
    if arguments.quantities:
        from couplet.study import interest

        expect(len(cases) == 1, "--quantities: one case at a time.")
        return interest.run(cases[0], out_of(cases[0], arguments), arguments, say)
    if all("axes" not in case.study for case in cases):
        expect(not arguments.peers, "--peers: the study needs 'axes' and 'quantities'.")
        expect(not arguments.for_error, "--for-error: the study needs 'axes', of which one has 'sizes'.")
        return run_variants(cases, arguments)
    expect(len(cases) == 1, "a study by axes: one case at a time.")
    return run_axes(cases[0], arguments)
