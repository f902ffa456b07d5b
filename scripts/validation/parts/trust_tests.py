# SPDX-License-Identifier: Apache-2.0
"""Bars of the tests themselves: mutants, guards that stay silent on sound cases, and what the guards cost."""
import re
import signal
import subprocess
import time

from couplet_run import Case, environment
from validation.job import Bar
from validation.parts.trust_runs import script

SECONDS = 25  # of each committed case
# What guards say; verdicts on left-out effects are none.
GUARDS = re.compile(r"error:|grow|diverge|swing|part by|unexplained|does not hold|not sound|convict|mismatch|staircase|stairs", re.I)


def heard(job, case):
    """What guards said in the first seconds of a committed case, and the exit code (3: it was ended by SIGTERM and has saved)."""
    out = job.scratch / "alarms" / case.parent.name / case.stem
    out.mkdir(parents=True, exist_ok=True)
    command = Case(case, job.build).command({"simulation.output.folder": str(out)})
    with open(out / "run.log", "w", encoding="utf-8") as log:
        run = subprocess.Popen([str(c) for c in command], stdout=log, stderr=subprocess.STDOUT, env=environment(), start_new_session=True)
        try:
            code = run.wait(SECONDS)
        except subprocess.TimeoutExpired:
            run.send_signal(signal.SIGTERM)
            try:
                run.wait(60)  # mpirun, too, has heard the signal and leaves with a code of its own
                code = 3
            except subprocess.TimeoutExpired:
                run.kill()
                code = "hangs"
    text = (out / "run.log").read_text(errors="replace")
    if code == 3 and "the state is saved" not in text:
        code = "ended without saving"
    lines = [line for line in text.splitlines() if re.search(r"warning|error", line) and GUARDS.search(line)]
    return code, lines


def false_alarms(job):
    alarms, count, start = [], 0, time.monotonic()
    for case in sorted((job.root / "configs").glob("*/*.yaml")):
        if "participants" not in case.read_text():
            continue
        mesh = re.search(r"mesh: (\S+\.msh)", case.read_text())
        if mesh and not (case.parent / mesh[1]).exists():  # made by a command of its own, see the case's README
            continue
        if any(not (job.build / "bin" / p["program"]).exists() for p in Case(case, job.build).participants.values()):
            continue  # a program of somebody else, which the case's own script starts
        modes = re.search(r"file: (\S+\.h5)", case.read_text())
        if modes and not (case.parent / modes[1]).exists():  # another case's result
            continue
        code, lines = heard(job, case)
        count += 1
        if code not in (0, 3) or lines:
            alarms.append(f"{case.parent.name}/{case.name}: {code} {lines[0][:120] if lines else ''}")
    return f"{len(alarms)} of {count} cases ({time.monotonic() - start:.0f} s){': ' if alarms else ''}" + "; ".join(alarms[:8]), not alarms


def share(program, case, functions, *options):
    """Share of a program's instructions that it spends in functions with what they call (callgrind, so that it repeats)."""
    def measure(job):
        file = job.scratch / f"callgrind-{program}"
        job.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={file}", job.build / "bin" / program, job.root / case,
                 "--set", f"simulation.output.folder={job.scratch / 'callgrind'}", *options], 1800)
        text = job.run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", file]).stdout
        rows = [(int(m[1].replace(",", "")), m[2]) for m in re.finditer(r"^\s*([\d,]+) \(\s*[\d.]+%\)\s+(.*)$", text, re.M)]
        total = max(n for n, _ in rows)
        step = max((n for n, name in rows if "advance" in name or "::solve(" in name), default=total)
        spent = max((n for n, name in rows if re.search(functions, name)), default=None)
        if spent is None:
            raise RuntimeError(f"no function like {functions} was called")
        return 100 * spent / step
    return measure


def fluid_cost(job):
    got = share("fluid_solver", "configs/taylor-green-2d/case.yaml", r"EnergyGuard<.*>::judge", "--set", "simulation.end-time=0.05")(job)
    return f"{got:.2f} % of the instructions of its steps", got < 3


BARS = [
    Bar("mutants that survived are killed", "all", script("tests/mutants/run.py", "{root}", "{bin}/.."), long=True),
    Bar("false alarms of guards on the committed cases", "none", false_alarms, long=True,
        but=f"the first {SECONDS} s of wall time of each case, with its own settings; the validation runs are judged by their own rows"),
    Bar("the energy guard in the cheapest fluid step", "< 3 %", fluid_cost, long=True,
        but="instructions under callgrind in place of paired times"),
]
