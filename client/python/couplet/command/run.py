# SPDX-License-Identifier: Apache-2.0
"""Runs a case: starts all its programs in one job as the YAML file lists them, shows their output, and reports at the
end where the results are. The results are bit-for-bit identical to those of the launch command typed by hand (--print
shows it). Ctrl-C stops the run after the current step with a checkpoint; press it again to stop immediately."""
import os
import pathlib
import shlex
import shutil
import subprocess
import sys

from couplet import places
from couplet.runs import folder as folders
from couplet.runs.case import CONTROL, Case, expect, mapping_of
from couplet.runs.job import Job, output_of

RANKS_HELP = (
    "ranks of participants (fluid=4,solid=2), or a total, which is divided by measured work or, without measurements,"
    " by numbers of cells"
)
FLAGS = {"strict": "fails if the run warns about its own result; --strict=effects: also about neglected effects"}


def declare_guests(parser, what):
    parser.add_argument("--with", dest="played_by", action="append", default=[], metavar="NAME=COMMAND", help=what)


def declare_job(parser, ranks_help):
    parser.add_argument("case", type=pathlib.Path, metavar="CASE", help="a YAML file, or a folder with case.yaml")
    parser.add_argument("-n", "--ranks", action="append", default=[], metavar="NAME=N", help=ranks_help)
    parser.add_argument("--participant", metavar="NAME", help="runs only this participant")
    declare_guests(parser, "command that starts an external participant")
    parser.add_argument("--bin", type=pathlib.Path, metavar="FOLDER", help="folder that contains the programs")
    options_of_programs(parser)


def declare(parser):
    declare_job(parser, RANKS_HELP)
    parser.add_argument(
        "--separate",
        action="append",
        default=[],
        metavar="NAME[=tcp:INTERFACE]",
        help=(
            "you start this external participant yourself, with COUPLET_JOIN in its environment, on this machine or"
            " over a network interface (tcp6: IPv6)"
        ),
    )
    parser.add_argument("--print", action="store_true", help="prints the launch line without running the case")
    parser.add_argument(
        "--slurm",
        nargs="?",
        const="",
        metavar="OPTIONS",
        help="submits the run to Slurm with these options of sbatch; with --print, prints the batch script",
    )
    parser.add_argument(
        "--picture",
        action="store_true",
        help="draws the picture of the case afterwards (its section plot, or its plot.py)",
    )


def options_of_programs(parser):
    parser.add_argument("--set", action="append", default=[], metavar="a.b=v", help="sets a value; repeatable")
    parser.add_argument(
        "--restart", type=pathlib.Path, metavar="FOLDER", help="continues from the checkpoints in this folder"
    )
    parser.add_argument(
        "--restart-with-changes", action="store_true", help="continues although keys that change the solution differ"
    )
    parser.add_argument(
        "--allow-commands",
        action="store_true",
        help="allows a .geo to run commands and write files, with your permissions",
    )
    parser.add_argument("--strict", nargs="?", const="", metavar="effects", help=FLAGS["strict"])
    parser.add_argument(
        "--diagnostics",
        choices=("standard", "without-errors", "full"),
        help="how thoroughly the run checks its own result; full includes searches that may take as long as a solve",
    )
    parser.add_argument(
        "--accept",
        action="append",
        default=[],
        metavar="ID",
        help="accepts a finding by its id (docs/findings.md); repeatable",
    )
    parser.add_argument("-v", "--verbose", action="store_true", help="logs more, on every rank")
    parser.add_argument("-q", "--quiet", action="store_true", help="prints only warnings and errors")


def flags_of(arguments):
    """Arguments that are passed unchanged to all programs."""
    words = [
        f"--{name.replace('_', '-')}"
        for name in ("restart_with_changes", "allow_commands", "verbose", "quiet")
        if getattr(arguments, name)
    ]
    words += ["--restart", str(arguments.restart.absolute())] if arguments.restart else []
    words += ["--diagnostics", arguments.diagnostics] if arguments.diagnostics else []
    words += [] if arguments.strict is None else ["--strict" + (f"={arguments.strict}" if arguments.strict else "")]
    return words + [word for finding in arguments.accept for word in ("--accept", finding)]


def pairs(words, option):
    expect(all("=" in w for w in words), f"{option}: expected NAME=...")
    return dict(w.split("=", 1) for w in words)


def ranks_of(words, case, here=True):
    """Number of ranks. `here` is true if the job runs on this machine."""
    words = [w for word in words for w in word.split(",")]
    if len(words) == 1 and words[0].isdigit():
        from couplet.runs.ranks import divide, fit_total

        if here:
            fit_total(int(words[0]))
        return divide(case, int(words[0]))
    expect(
        all("=" in w for w in words), f"-n {','.join(words)}: expected one whole number for the whole job, or NAME=N"
    )
    found = pairs(words, "-n")
    expect(len(found) == len(words), f"-n {','.join(words)}: a participant is named twice")
    expect(
        all(n.isdigit() and int(n) > 0 for n in found.values()),
        f"-n {','.join(words)}: expected whole numbers of at least 1, such as -n fluid=4,solid=2",
    )
    return {name: int(n) for name, n in found.items()}


def relays(words, case):
    """Returns {participant: command of its relay in the job}. Prints how the participants must be started."""
    found = {}
    for word in words:
        name, _, listen = word.partition("=")
        address = pathlib.Path.cwd() / f"{name}.relay"
        found[name] = [str(case.build / "bin/relay"), name, "--listen", listen or "unix", "--address", str(address)]
        print(
            f"'{name}' is launched separately: COUPLET_JOIN={shlex.quote(str(address))} PROGRAM ...",
            file=sys.stderr,
            flush=True,
        )
    return found


def build_of(folder):
    if folder is not None:
        expect(folder.is_dir(), f"--bin {folder}: there is no such folder")
        expect(folder.resolve().name == "bin", f"--bin {folder}: expected a folder called bin")
        return folder.absolute().parent
    return None


def batch_script(job, options):
    case, *words = job.case.words(job.alone, job.ranks, job.sets, job.flags, job.played_by)
    words = [str(word) for word in (places.command(), "run", case.absolute(), *words)]
    # Asks the job to end before its time limit, so that it saves and couplet resume can continue.
    head = {
        "--job-name": mapping_of(job.case.data.get("simulation")).get("name", job.case.file.stem),
        "--ntasks": sum(n for n, _ in job.parts),
        "--signal": "B:TERM@60",
    }
    head = [
        f"{name}={value}" for name, value in head.items() if name not in {option.split("=")[0] for option in options}
    ]
    for word in (*head, *options, *words):  # a line break would begin a command
        expect(not CONTROL.search(word), f"{word!r}: contains a control character; a batch script cannot contain it.")
    return "\n".join(
        [
            "#!/bin/bash",
            *(f"#SBATCH {shlex.quote(word)}" for word in (*head, *options)),
            "exec " + shlex.join(words),
            "",
        ]
    )


def hand_to_slurm(job, options, only_show):
    text = batch_script(job, options)
    if only_show:
        print(text, end="")
        return 0
    expect(shutil.which("sbatch"), "there is no sbatch on this machine; couplet run --slurm --print shows the script")
    return subprocess.run(["sbatch"], input=text, text=True).returncode


def job_of(arguments, here=False, relayed=()):
    case = Case(arguments.case, build_of(arguments.bin))
    expect(all("=" in s for s in arguments.set), "--set: expected a.b=value")
    return Job(
        case,
        ranks_of(arguments.ranks, case, here),
        arguments.set,
        flags_of(arguments),
        arguments.participant,
        {
            **{name: shlex.split(words) for name, words in pairs(arguments.played_by, "--with").items()},
            **relays(relayed, case),
        },
    )


def run(arguments):
    job = job_of(arguments, arguments.slurm is None and not arguments.print, arguments.separate)
    if arguments.slurm is not None:
        return hand_to_slurm(job, shlex.split(arguments.slurm), arguments.print)
    if arguments.print:
        print(job.line())
        return 0
    return shown_run(job, arguments.picture, arguments.verbose)


def shown_run(job, picture=False, verbose=False):
    """Runs the job with a digest on a terminal, else with the programs' own lines."""
    from couplet.command import report
    from couplet.runs import ranks
    from couplet.runs.results import Results
    from couplet.runs.terminal import Digest, Plain

    ranks.fit(job.case, job.ranks, job.alone)
    if not sys.stdout.isatty() or verbose:
        code = job.run(Plain())
        if (
            job.case.coupled and not job.alone and code in (0, 4) and "--quiet" not in job.flags
        ):  # a program alone prints its own
            print(*report.ending(Results(job.output), ["coupler", *job.case.participants]), sep="\n")
        return finish(job, code, picture)
    digest = Digest(job)
    digest.begin()
    code = job.run(digest)
    digest.end(code)
    return finish(job, code, picture)


def shown(path):
    """Formats a path as a person would type it."""
    relative = os.path.relpath(path)
    return str(path) if relative.startswith("../..") else relative


def span(seconds):
    for unit, size, below in (("s", 1, 600), ("min", 60, 7200)):
        if seconds < below:
            return f"{seconds / size:.{int(seconds < 10)}f} {unit}"
    return f"{seconds / 3600:.1f} h"


def line_of_picture(job, out):
    """Command that draws this run."""
    if not job.case.has_picture or (job.alone and job.case.coupled):
        return f"couplet plot {shlex.quote(out)}"
    elsewhere = job.output.absolute() != output_of(job.case, ()).absolute()
    return (
        f"couplet plot {shlex.quote(shown(job.case.file))}"
        + (f" --out {shlex.quote(out)}" if elsewhere else "")
        + (" --allow-commands" if job.case.draws_itself else "")
    )


def picture_of(job):
    """Draws the picture of the case. Returns its part of the last line."""
    done = subprocess.run(
        [
            sys.executable,
            places.command(),
            "plot",
            str(job.case.file),
            "--allow-commands",
            *(["--out", str(job.output)] if "plot" in job.case.data else []),
        ],
        capture_output=True,
        text=True,
    )
    name = next(
        (line.removeprefix("picture: ") for line in reversed(done.stdout.splitlines()) if line.endswith(".png")), None
    )
    if done.returncode != 0:
        return f"no picture ({(done.stderr.strip().splitlines() or ['couplet plot failed'])[-1]})"
    return f"picture {shown(name)}" if name else "picture made"


def finish(job, code, picture):
    """Prints the last lines: where the results are, or what failed and what to do."""
    out, took = shown(job.output), span(job.seconds)
    again = f"couplet resume {shlex.quote(out)}"
    if not job.case.file.is_file():
        print(f"warning: {shown(job.case.file)} was removed during the run", file=sys.stderr)
    if code == 0 or code == 4:
        look = picture_of(job) if picture else f"picture: {line_of_picture(job, out)}"
        doubt = ", but the result is useless" if code == 4 else ""
        print(
            f"done in {took}{doubt}: results in {out}",
            look,
            f"more: couplet report {shlex.quote(out)}",
            sep="\n",
            flush=True,
        )
        return code
    if code == 3 or (job.asked and job.recorded and folders.checkpoint(job.output)):
        print(f"stopped after {took}, saved as {folders.checkpoint(job.output)}; continue: {again}", file=sys.stderr)
        return 3 if code == 3 or folders.sets_since(job.output, job.asked_at) else code
    fix = "fix the errors above"
    if any(
        "cannot start" in line for line in job.last
    ):  # errors of the case; it does not know others, such as of --restart
        fix += f"; to list all errors of the file: couplet check {shlex.quote(shown(job.case.file))}" + "".join(
            f" --set {shlex.quote(s)}" for s in job.sets
        )
    left = f"from the last checkpoint: {again}" if job.recorded and folders.checkpoint(job.output) else f"logs in {out}"
    what = fix if code == 2 else left
    why = "" if code == 2 else f": {job.last_words()}"  # errors of the case were printed just above
    print(f"failed after {took}, exit code {code}{why}\n{what}", file=sys.stderr)
    return code
