# SPDX-License-Identifier: Apache-2.0
"""Stops the active run of an output folder after the current step, with a checkpoint to continue from. Finds it on this machine,
however it was started."""
import pathlib
import shlex
import sys

from couplet.runs import folder as folders
from couplet.runs.case import expect


def declare(parser):
    parser.add_argument("folder", type=pathlib.Path, metavar="FOLDER", help="the output folder of the run")
    parser.add_argument("--within", type=float, default=600, metavar="SECONDS", help="waits so long for its end (600)")


def run(arguments):
    expect(arguments.folder.is_dir(), f"{arguments.folder}: there is no such folder")
    expect(folders.stop(arguments.folder), f"{arguments.folder}: no job is at work there on this machine (a job of Slurm: scancel --signal=TERM --full JOB)")
    if not folders.wait_for_end(arguments.folder, arguments.within):
        print(f"couplet stop: not at its end after {arguments.within:g} s; it ends after the step under way", file=sys.stderr)
        return 1
    print(f"stopped, saved as {folders.checkpoint(arguments.folder)}; continue: couplet resume {shlex.quote(str(arguments.folder))}")
    return 0
