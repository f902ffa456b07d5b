# SPDX-License-Identifier: Apache-2.0
"""What tests that run programs share: claims that are reported one by one, the line that starts a job, and the last row of a table."""
import os
import re
import subprocess
import sys

COUPLED = ("coupler", "fluid_solver", "solid_solver", "mesh_mover")
for variable in ("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"):
    os.environ.setdefault(variable, "1")
failed = []


def mpmd(parts, ranks=(), mpirun=("mpirun", "--oversubscribe")):
    """The words of one job of several programs; `parts`: each a program and its words, on one rank where `ranks` has no number for it."""
    line = [*mpirun]
    for i, part in enumerate(parts):
        line += [*([":"] if i else []), "-n", ranks[i] if i < len(ranks) else 1, *part]
    return [str(word) for word in line]


def share(cases, words):
    """Returns those cases whose number is I, I + N, I + 2 N, ... for the word I/N among `words`, which it takes away; all without such a word."""
    word = next((word for word in words if re.fullmatch(r"[1-9]\d*/[1-9]\d*", word)), None)
    first, step = map(int, word.split("/")) if word else (1, 1)
    if word:
        words.remove(word)
    return list(cases)[first - 1::step]


def check(claim, holds, detail=""):
    """Gives whether the claim failed."""
    print(f"{'ok' if holds else 'not ok'}  {claim}  {detail}", flush=True)
    if not holds:
        failed.append(claim)
    return not holds


def require(claim, holds, detail=""):
    """A claim without which the rest is not worth a run."""
    if check(claim, holds, detail):
        end()


def said(line, timeout=300, **more):
    """What a program prints that has to end well."""
    done = subprocess.run([str(word) for word in line], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=timeout, **more)
    if done.returncode:
        sys.exit(f"exit code {done.returncode} of {' '.join(map(str, line))[:500]}\n{done.stdout[-4000:]}")
    return done.stdout


def living(session):
    """{pid: name of its program} of the processes of a session that are neither gone nor about to be."""
    found = {}
    for entry in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{entry}/stat", encoding="utf-8", errors="replace") as file:
                state, _, _, its_session = file.read().rpartition(")")[2].split()[:4]
            if int(its_session) == session and state not in "ZX":
                found[int(entry)] = os.path.basename(os.readlink(f"/proc/{entry}/exe"))
        except OSError:
            continue
    return found


def last(file):
    """Columns by name without its unit."""
    names, *rows = [line.split(",") for line in file.read_text().splitlines()]
    return dict(zip((n.split(" [")[0] for n in names), map(float, rows[-1])))


def end():
    print(f"{len(failed)} checks failed" if failed else "all checks passed")
    sys.exit(1 if failed else 0)
