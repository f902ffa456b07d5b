# SPDX-License-Identifier: Apache-2.0
"""Stops the running job of an output folder after its current step, with a checkpoint to continue from. The job must
run on this machine; it does not matter how it was started."""
import pathlib
import shlex
import sys

from couplet.runs import folder as folders
from couplet.runs.case import expect
from couplet.runs.job import RUN_HELP, run_folder


def declare(parser):
    parser.add_argument("folder", type=pathlib.Path, metavar="RUN", help=RUN_HELP)
    parser.add_argument(
        "--within",
        type=float,
        default=600,
        metavar="SECONDS",
        help="how long to wait for the run to end (default: 600)",
    )


def run(arguments):
    folder = run_folder(arguments.folder)
    expect(folder.is_dir(), f"{folder}: there is no such folder")
    expect(
        folders.stop(folder),
        (
            f"{folder}: no running job found for this folder on this machine (for a Slurm job, use scancel"
            " --signal=TERM --full JOB)"
        ),
    )
    if not folders.wait_for_end(folder, arguments.within):
        print(
            f"couplet stop: still running after {arguments.within:g} s; it stops after the current step",
            file=sys.stderr,
        )
        return 1
    saved = folders.checkpoint(folder)
    if saved is None:
        print("stopped before the first step; nothing was saved")
        return 0
    print(f"stopped, saved as {saved}; continue: couplet resume {shlex.quote(str(folder))}")
    return 0
