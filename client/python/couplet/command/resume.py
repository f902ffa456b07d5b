# SPDX-License-Identifier: Apache-2.0
"""Continues a stopped or interrupted run from its last complete checkpoint, with its original ranks and settings. A continued run equals
the uninterrupted one bit for bit; on other ranks (-n), within the tolerance of the solvers."""
import pathlib
import shlex

from couplet.command.run import RANKS_HELP, ranks_of, shown_run
from couplet.runs import folder as folders
from couplet.runs.case import Case, expect
from couplet.runs.job import Job


def declare(parser):
    parser.add_argument("folder", type=pathlib.Path, metavar="FOLDER", help="output folder of the run")
    parser.add_argument("-n", "--ranks", action="append", default=[], metavar="NAME=N", help=f"other ranks than before: {RANKS_HELP}")
    parser.add_argument("--set", action="append", default=[], metavar="a.b=v", help="changes a value, such as simulation.end-time='10 s'")
    parser.add_argument("--restart-with-changes", action="store_true", help="continues although keys that change the solution differ")
    parser.add_argument("--print", action="store_true", help="prints the launch line without running it")


def without_restart(flags):
    """Flags of the first start without its checkpoint."""
    at = flags.index("--restart") if "--restart" in flags else len(flags)
    return flags[:at] + flags[at + 2:]


def run(arguments):
    folder = arguments.folder.absolute()
    expect(folder.is_dir(), f"{arguments.folder}: there is no such folder")
    record = folders.read_record(folder)
    expect(record, f"{arguments.folder}: was not started by couplet run (no {folders.RECORD}). Continue with: couplet run CASE --restart {arguments.folder / 'checkpoints'}")
    expect(folders.checkpoint(folder), f"{arguments.folder}: no complete checkpoint to continue from; `simulation.checkpoint.interval` writes them. Start again: couplet run {shlex.quote(str(record['case']))}")
    flags = [*without_restart(record["flags"]), *(["--restart-with-changes"] if arguments.restart_with_changes and "--restart-with-changes" not in record["flags"] else []), "--restart", str(folder / "checkpoints" / folders.checkpoint(folder))]
    case = Case(record["case"], pathlib.Path(record["bin"]).parent)
    job = Job(case, {**record["ranks"], **ranks_of(arguments.ranks, case)}, [*record["sets"], f"simulation.output.folder={folder}", *arguments.set],
              flags, record["alone"], record["with"])
    if arguments.print:
        print(job.line())
        return 0
    return shown_run(job)
