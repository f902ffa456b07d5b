# SPDX-License-Identifier: Apache-2.0
"""Lists what a case computes (with --all, also what it neglects), its cells, expected memory and time, and the launch
line. Runs nothing."""
import shlex

from couplet.command import check
from couplet.command.run import build_of, declare_guests, pairs
from couplet.runs.case import Case
from couplet.runs.job import Job


def declare(parser):
    check.declare(parser)
    declare_guests(parser, "command of an external participant in the launch line")
    parser.add_argument("--all", action="store_true", help="also lists neglected effects and the keys that enable them")


def run(arguments):
    for name, code, answer, complaint in check.ask(arguments, "--explain"):
        if code:
            print(complaint or answer, end="")
            return code
        for line in answer.splitlines():
            if (
                not line.startswith(("whole case:", "  off"))
                and "] [info]" not in line
                or arguments.all
                and line.startswith("  off")
            ):
                print(line)
    played_by = {name: shlex.split(words) for name, words in pairs(arguments.played_by, "--with").items()}
    print("limitations:     docs/limitations.md lists what no case can compute (couplet docs shows it)")
    print(
        "launch line:     "
        + Job(Case(arguments.case, build_of(arguments.bin)), sets=arguments.set, played_by=played_by).line()
    )
    return 0
