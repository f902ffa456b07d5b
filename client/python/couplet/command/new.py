# SPDX-License-Identifier: Apache-2.0
"""Creates a case of your own by copying an example case, with all files that it names, into a new folder. Comments
and the order of keys are kept."""
import pathlib
import shlex

from couplet.runs import gallery
from couplet.runs.case import expect


def declare(parser):
    parser.add_argument("folder", type=pathlib.Path, metavar="FOLDER", help="folder to create")
    parser.add_argument(
        "--from",
        dest="source",
        default="perpendicular-flap",
        metavar="CASE",
        help="example case (couplet gallery lists them), or another file of one, such as cavity/re400.yaml",
    )
    parser.add_argument("--end-time", metavar="T", help="simulation.end-time, such as '2 s'")
    parser.add_argument("--time-step", metavar="T", help="simulation.time-step, such as '0.01 s'")
    parser.add_argument(
        "--set", action="append", default=[], metavar="a.b=v", help="changes a key that the case has; repeatable"
    )


def run(arguments):
    expect(all("=" in s for s in arguments.set), "--set: expected a.b=value")
    values = dict(s.split("=", 1) for s in arguments.set)
    values |= {
        f"simulation.{key}": value
        for key, value in (("end-time", arguments.end_time), ("time-step", arguments.time_step))
        if value
    }
    file = gallery.copy(gallery.find(arguments.source), arguments.folder, values)
    print(
        f"{file}: a copy of {arguments.source}. Use it with couplet check, explain or run: couplet run"
        f" {shlex.quote(str(file))}"
    )
    return 0
