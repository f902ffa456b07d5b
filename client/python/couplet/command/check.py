# SPDX-License-Identifier: Apache-2.0
"""Reports every error in the keys and files of a case with file and line, without running it. Each program of the
case checks its own part. Errors that only the mesh reveals (patches without an entry, positions of probes, selections
of faces) are found at the start of the run. The exit code is 0 if there are no errors, and 2 otherwise."""
import pathlib
import subprocess
import sys

from couplet.command.run import build_of
from couplet.runs.case import COUPLER, OURS, Case, expect
from couplet.runs.job import surroundings


def declare(parser):
    parser.add_argument("case", type=pathlib.Path, metavar="CASE", help="a YAML file, or a folder with case.yaml")
    parser.add_argument("--set", action="append", default=[], metavar="a.b=v", help="sets a value; repeatable")
    parser.add_argument("--bin", type=pathlib.Path, metavar="FOLDER", help="folder that contains the programs")


def ask(arguments, question):
    """Yields (participant, exit code, answer, complaint) of all our programs of the case, asked concurrently."""
    case = Case(arguments.case, build_of(arguments.bin)).changed(arguments.set)
    expect(isinstance(case.participants, dict) and case.participants, f"{case.file}: there are no 'participants'.")
    sets = [word for s in arguments.set for word in ("--set", s)]
    asked = {}
    for name in [*([COUPLER] if case.coupled else []), *case.participants]:
        program = case.build / "bin" / COUPLER if name == COUPLER else case.program(name)
        if name == COUPLER or program.name in OURS:  # anything else in that folder, such as a shell, might run the case
            expect(
                program.exists(), f"{case.file}: the program '{program.name}' of '{name}' is not in {program.parent}"
            )
            line = [program, case.file, question, *(["--participant", name] if name != COUPLER else []), *sets]
            asked[name] = subprocess.Popen(
                list(map(str, line)),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                env=surroundings(),
            )
    for name, process in asked.items():
        answer, complaint = process.communicate()
        yield name, process.returncode, answer, complaint


def problem_of_plot(case):
    """Error in the section `plot`, which the programs ignore. Empty if there is none."""
    from couplet.plots.section import check
    from couplet.runs.case import Wrong

    try:
        if "plot" in case.data:
            check(case)
    except Wrong as problem:
        return str(problem)
    return ""


def problem_of_programs(case):
    """Error in what runs the participants that only the whole case shows. Empty if there is none."""
    if len(case.participants) > 1 and not case.data.get("coupling"):
        return (
            f"{case.file}: {len(case.participants)} participants, but no section 'coupling': add it, or run one of"
            " them: couplet run --participant NAME"
        )
    for name in case.participants:
        program = case.program(name)
        if not program.exists() and case.guest(name) is None and not case.coupled:
            return (
                f"{case.file}: participants.{name}.program: there is no program '{program.name}'; Couplet has"
                f" {', '.join(OURS[1:])}."
            )
    return ""


def run(arguments):
    worst, told = 0, []
    for name, code, answer, complaint in ask(arguments, "--check"):
        worst = max(worst, code if code >= 0 else 1)
        if code:  # every program reports general errors, but once is enough
            told += [line for line in (complaint or answer).rstrip().splitlines() if line not in told]
    case = Case(arguments.case, build_of(arguments.bin))
    for problem in filter(None, (problem_of_plot(case), problem_of_programs(case))):
        worst, told = max(worst, 2), [*told, problem]
    print(*told, sep="\n", end="\n" if told else "", file=sys.stderr)
    if worst == 0:
        print(
            f"{arguments.case}: keys and files are valid; patches, probes and selections are checked on the mesh when"
            " the run starts"
        )
    return worst
