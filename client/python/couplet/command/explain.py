# SPDX-License-Identifier: Apache-2.0
"""Lists what a case computes: the effects of each participant and, with --all, those it neglects; cells, expected memory and time,
and the launch line. Runs nothing."""
from couplet.command import check
from couplet.command.run import build_of
from couplet.runs.case import Case
from couplet.runs.job import Job


def declare(parser):
    check.declare(parser)
    parser.add_argument("--all", action="store_true", help="also lists neglected effects and the keys that enable them")


def run(arguments):
    for name, code, answer, complaint in check.ask(arguments, "--explain"):
        if code:
            print(complaint or answer, end="")
            return code
        for line in answer.splitlines():
            if not line.startswith(("whole case:", "  off")) and "] [info]" not in line or arguments.all and line.startswith("  off"):
                print(line)
    print("launch line:     " + Job(Case(arguments.case, build_of(arguments.bin)), sets=arguments.set).line())
    return 0
