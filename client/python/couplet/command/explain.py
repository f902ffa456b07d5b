# SPDX-License-Identifier: Apache-2.0
"""Lists what a case computes (with --all, also what it neglects), its cells, the launch line, and the memory and time
that the whole run needs, extrapolated from its first seconds, which are run in a temporary folder."""
import shlex

from couplet.command import check
from couplet.command.run import build_of, declare_guests, pairs, span
from couplet.runs.case import OURS, Case
from couplet.runs.job import Job
from couplet.runs.probe import LIMIT, probe


def declare(parser):
    check.declare(parser)
    declare_guests(parser, "command of an external participant in the launch line")
    parser.add_argument("--all", action="store_true", help="also lists neglected effects and the keys that enable them")


def price(case, sets):
    """Lines on the whole run: time, memory, and what limits its steps."""
    if guests := [name for name in case.participants if case.program(name).name not in OURS]:
        return f"whole run:       not measured, because it requires the external participant '{guests[0]}'"
    found = probe(case, [word for s in sets for word in ("--set", s)])
    if found.ended:
        took = f"{span(found.wall)}, measured"
    elif found.wall > 0:
        took = f"about {span(found.wall)} on one rank for each program, estimated from its first steps"
    else:
        return f"whole run:       not measured: {found.problem or f'no step within {LIMIT:g} s'}"
    return "\n".join(
        [f"whole run:       {took}; {found.memory:.0f} MB", *(f"steps:           {line}" for line in found.said)]
    )


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
    print(price(Case(arguments.case, build_of(arguments.bin)).changed(arguments.set), arguments.set))
    print("limitations:     docs/limitations.md lists what no case can compute (couplet docs shows it)")
    print(
        "launch line:     "
        + Job(Case(arguments.case, build_of(arguments.bin)), sets=arguments.set, played_by=played_by).line()
    )
    return 0
