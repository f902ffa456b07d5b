# SPDX-License-Identifier: Apache-2.0
"""Measures of the tests themselves: mutants, guards that stay silent on sound cases, and what the guards cost."""
import json
import os
import pathlib
import re
import signal
import subprocess
import time

from couplet.runs import Case, environment

SECONDS = 25  # of each committed case
# What guards say; verdicts on left-out effects are none.
GUARDS = re.compile(r"error:|grow|diverge|oscillat|spurious|not reliable|increasingly apart|part by|unexplained|does not hold|not sound|convict|mismatch|staircase|stairs", re.I)


def heard(job, case):
    """Messages of guards in the first seconds of a committed case, and the exit code (3: it was ended by SIGTERM and has saved)."""
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


def counted(job, command, folder):
    """{function: instructions with what it calls}, for each program of a command (callgrind, so that it repeats)."""
    folder.mkdir(parents=True, exist_ok=True)
    words, programs = [], []
    for word in command:
        if pathlib.Path(str(word)).parent == job.build / "bin":
            programs.append(pathlib.Path(word).name)
            words += ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder / programs[-1]}"]
        words.append(word)
    job.done(words, 1800, cwd=folder)
    found = {}
    for program in programs:
        text = job.run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", folder / program]).stdout
        rows = re.finditer(r"^\s*([\d,]+) \(\s*[\d.]+%\)\s+\S*?:(.*?)(?: \[[^ ]*\])?$", text, re.M)
        found[program] = {m[2]: int(m[1].replace(",", "")) for m in rows}
    return found


def within(counts, pattern):
    """Instructions of the functions that a pattern names (none of them calls another one)."""
    named = [n for name, n in counts.items() if re.match(pattern, name)]
    if not named:
        raise RuntimeError(f"no function like {pattern} was called")
    return sum(named)


# What a program does in a step, and what of it are guards: the end of a run, files and verdicts on left-out effects are none.
STEPS = {
    "fluid_solver": r"couplet::fluid::FluidParticipant<\d>::(begin_step|solve|accept_step)\b",
    "solid_solver": r"couplet::solid::Solid::(begin_step|solve|accept_step)\b",
    "mesh_mover": r"couplet::mesh_mover::Mover::(begin_step|solve|accept_step)\b",
}
GUARD = {
    "fluid_solver": r"couplet::fluid::(FractionalStep<\d>::judge|Fluid<\d>::(refuse_inverted|check_wall_velocity))\(",
    "solid_solver": r"couplet::solid::SolidJudge::(look|see_inertia)\(",
    "mesh_mover": r"couplet::mesh_mover::Guard::refusal\b",
    "coupler": r"couplet::coupler::(Coupler::watch|IterationGuard::pass)\(",
}


def later(job, name, case, end, words=None):
    """What a run to twice a time takes more than one to that time: steps without the start of a run and without its end."""
    case, sums = Case(job.root / "configs" / case / "case.yaml", job.build), []
    for k in (1, 2):
        overrides = {"simulation.output.folder": str(job.scratch / f"cost-{name}-{k}"), "simulation.end-time": str(k * end), **(words or {})}
        counts = counted(job, case.command(overrides), job.scratch / f"callgrind-{name}-{k}")
        sums.append({p: (within(counts[p], GUARD[p]), within(counts[p], STEPS[p]) if p in STEPS else 0) for p in counts})
    return {p: tuple(b - a for a, b in zip(sums[0][p], sums[1][p])) for p in sums[0]}


def solid_cost(job):
    """A static step, and dynamic ones with an output."""
    static = Case(job.root / "configs/cantilever/case.yaml", job.build).command(
        {"simulation.output.folder": str(job.scratch / "cost-static"), "participants.solid.mesh-parameters": "{n_length: 20, n_side: 4}"})
    counts = counted(job, static, job.scratch / "callgrind-static")["solid_solver"]
    guard, step = later(job, "dynamic", "vibrating-cantilever", 5, {"participants.solid.mesh-parameters": "{n_length: 20, n_side: 2}"})["solid_solver"]
    got = {"static": 100 * within(counts, GUARD["solid_solver"]) / within(counts, STEPS["solid_solver"]), "dynamic": 100 * guard / step}
    return ", ".join(f"{name} {share:.2f} %" for name, share in got.items()) + " of the instructions of its steps", max(got.values()) < 1


def coupled_cost(job):
    """All guards of the four programs against all that they do in the steps; waiting is in neither."""
    counts = later(job, "flap", "perpendicular-flap", 0.05)
    guards, steps = (sum(pair[k] for pair in counts.values()) for k in (0, 1))
    parts = ", ".join(f"{program} {100 * pair[0] / steps:.2f}" for program, pair in counts.items())
    return f"{100 * guards / steps:.2f} % of the instructions of its steps ({parts})", guards < 0.01 * steps


def fluid_cost(job):
    guard, step = later(job, "fluid", "taylor-green-2d", 0.5)["fluid_solver"]
    return f"{100 * guard / step:.2f} % of the instructions of its steps", guard < 0.03 * step


def limits(job):
    """Time limits of the quick tests against what each took on average in the build at hand (CTestCostData)."""
    file = pathlib.Path(os.environ.get("COUPLET_QUIET_BUILD", job.build)) / "Testing/Temporary/CTestCostData.txt"
    cost = {w[0]: float(w[2]) for w in map(str.split, file.read_text().splitlines()) if len(w) == 3}
    registered, short, seen = json.loads(job.run(["ctest", "--test-dir", job.build, "--show-only=json-v1"]).stdout)["tests"], [], 0
    for test in registered:
        settings = {p["name"]: p["value"] for p in test.get("properties", [])}
        if "long" in settings.get("LABELS", ()) or not cost.get(test["name"]):
            continue
        seen += 1
        if (limit := settings.get("TIMEOUT", 1500)) < 10 * cost[test["name"]]:
            short.append(f"{test['name']} {limit:.0f} s for {cost[test['name']]:.1f} s")
    return f"{seen} quick tests that were run" + (f"; too short: {'; '.join(short)}" if short else ""), seen >= 250 and not short
