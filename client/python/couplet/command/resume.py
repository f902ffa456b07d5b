# SPDX-License-Identifier: Apache-2.0
"""Continues a stopped or interrupted run from its last complete checkpoint, with its original ranks and settings. A
continued run is bit-for-bit identical to an uninterrupted one; on a different number of ranks (-n), they agree within
the tolerance of the solvers."""
import os
import pathlib
import shlex
import subprocess
import sys

from couplet.command.run import RANKS_HELP, build_of, declare_guests, pairs, ranks_of, shown, shown_run
from couplet.runs import folder as folders
from couplet.runs.case import OURS, Case, Wrong, expect, with_changes
from couplet.runs.job import RUN_HELP, Job, run_folder, surroundings
from couplet.runs.results import Results

SHAPE = {"case": str, "ranks": dict, "sets": list, "flags": list, "with": dict}  # of the record


def declare(parser):
    parser.add_argument("folder", type=pathlib.Path, metavar="RUN", help=RUN_HELP)
    parser.add_argument(
        "-n", "--ranks", action="append", default=[], metavar="NAME=N", help=f"new numbers of ranks: {RANKS_HELP}"
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="a.b=v",
        help="changes a value, such as simulation.end-time='10 s'",
    )
    declare_guests(
        parser,
        (
            "command that starts an external participant; give it again, because a resumed run starts only programs of"
            " Couplet"
        ),
    )
    parser.add_argument("--bin", type=pathlib.Path, metavar="FOLDER", help="folder that contains the programs")
    parser.add_argument(
        "--allow-commands",
        action="store_true",
        help=(
            "allows a .geo to run commands and write files, as the run was allowed to; give it again, because the"
            " folder may come from someone else"
        ),
    )
    parser.add_argument(
        "--restart-with-changes", action="store_true", help="continues although keys that change the solution differ"
    )
    parser.add_argument("--print", action="store_true", help="prints the launch line without running it")
    parser.add_argument("-q", "--quiet", action="store_true", help="prints only warnings and errors")


def problem_of(job, checkpoint):
    """Error in the files of a checkpoint, whose digests the driver compares. Empty if there is none."""
    if pathlib.Path(job.parts[0][1][0]).name not in OURS:
        return ""
    asked = subprocess.run(
        [*job.parts[0][1], "--check"], stdin=subprocess.DEVNULL, capture_output=True, text=True, env=surroundings()
    )
    return next((line for line in asked.stderr.splitlines() if str(checkpoint) in line), "")


def finished_at(folder, case, sets):
    """Time [s] at which the run in this folder ended, if the case with these --set ends no later. None otherwise."""
    from couplet.peers.values import number

    results = Results(folder)
    reports = {name: results.report(name) for name in results.participants()}
    driver = reports.get("coupler") or next(iter(reports.values()), {})
    try:
        simulation = with_changes(case.data, dict(s.split("=", 1) for s in sets))["simulation"]
        end = number(simulation["end-time"], "simulation.end-time")
    except (Wrong, KeyError, TypeError):  # the programs say what is wrong with it
        return None
    return driver["time"] if driver.get("state") == "ended" and driver["time"] >= end * (1 - 1e-9) else None


def run(arguments):
    named = run_folder(arguments.folder)
    folder = named.absolute()
    expect(folder.is_dir(), f"{named}: there is no such folder")
    record = folders.read_record(folder)
    expect(
        record,
        (
            f"{named}: was not started by couplet run (no {folders.RECORD}). Continue with: couplet run CASE"
            f" --restart {named / 'checkpoints'}"
        ),
    )
    expect(
        all(isinstance(record.get(key), kind) for key, kind in SHAPE.items())
        and all(isinstance(n, int) for n in record["ranks"].values()),
        f"{folder / folders.RECORD}: is damaged. Continue with: couplet run CASE --restart {named / 'checkpoints'}",
    )
    file, found = pathlib.Path(os.path.normpath(folder / record["case"])), folders.checkpoints(folder)
    expect(
        file.is_file(),
        (
            f"{named}: its case is not at {file}. Continue with: couplet run CASE --restart"
            f" {named / 'checkpoints'} --set simulation.output.folder={shlex.quote(str(folder))}"
        ),
    )
    expect(
        found,
        (
            f"{named}: no complete checkpoint to continue from; `simulation.checkpoint.interval` writes"
            f" them. Start again: couplet run {shlex.quote(str(file))}"
        ),
    )
    sets = [*record["sets"], f"simulation.output.folder={folder}", *arguments.set]
    case, played_by = Case(file, build_of(arguments.bin)).changed(sets), {
        name: shlex.split(words) for name, words in pairs(arguments.played_by, "--with").items()
    }
    end = None if arguments.print else finished_at(folder, Case(file), sets)
    if end is not None:  # the programs would start, make no step and overwrite the results with nothing
        line = f"couplet resume {shlex.quote(shown(named))} --set simulation.end-time='{1.5 * end:g} s'"
        print(f"this run is finished (t = {end:g} s); to continue it: {line}")
        return 0
    for name in (
        [record["alone"]] if record["alone"] else case.participants
    ):  # the folder may be another's: nothing is started that only it names
        command = record["with"].get(name) or case.guest(name)
        expect(
            not command or name in played_by,
            (
                f"'{name}' is run by a program that is not Couplet's. If you trust it, give its command again: --with"
                f" {name}={shlex.quote(shlex.join(map(str, command or [])))}"
            ),
        )
    expect(
        arguments.allow_commands or "--allow-commands" not in record["flags"],
        f"{named}: its run let the .geo run commands. If you trust the case, give --allow-commands again",
    )
    flags = [
        *record["flags"],
        *(
            ["--restart-with-changes"]
            if arguments.restart_with_changes and "--restart-with-changes" not in record["flags"]
            else []
        ),
        *(["--quiet"] if arguments.quiet and "--quiet" not in record["flags"] else []),
    ]

    def job_from(name):
        return Job(
            case,
            {**record["ranks"], **ranks_of(arguments.ranks, case)},
            sets,
            [*flags, "--restart", str(folder / "checkpoints" / name)],
            record["alone"],
            played_by,
        )

    problems = []
    for name in found:
        problem = problem_of(job_from(name), folder / "checkpoints" / name)
        if not problem:
            break
        problems.append(f"warning: {problem}")
    else:
        name, problems = found[0], []  # the run itself reports what is wrong with all of them
    for problem in problems:
        print(f"{problem} {name} is used.", file=sys.stderr)
    job = job_from(name)
    if arguments.print:
        print(job.line())
        return 0
    return shown_run(job)
