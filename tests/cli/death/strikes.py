# SPDX-License-Identifier: Apache-2.0
"""Kills and stops of coupled jobs of real solvers at any moment, start-up, meshing and finish among them: no process is left
5 s later, the exit code is not 0, and the culprit is named. Usage: strikes.py BIN TOYS CASE_FOLDER COUNT [SEED]"""
import collections
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from jobs import PATIENCE, Suite, living, mpmd

source, count = pathlib.Path(sys.argv[3]), int(sys.argv[4])
draw = random.Random(int(sys.argv[5]) if len(sys.argv) > 5 else 1)
SLOWER = int(os.environ.get("COUPLET_SLOWER", "1"))
TIMEOUT = 3.0  # [s] hang-timeout: a busy disk holds a save for more than 1 s; the start has 4 s at least
PROGRAMS = {"coupler": "coupler", "fluid": "fluid_solver", "solid": "solid_solver", "mover": "mesh_mover"}
RANKS = {"coupler": 1, "fluid": 2, "solid": 1, "mover": 1}
MOMENTS = ("start", "meshing", "steps", "finish")
COARSE = "n_side: 12, n_tip: 1, growth: 1.4, wall_growth: 1.4, wall_cells: 4"
# Many seconds of gmsh, another mesh each time.
FINE = "n_side: 800, n_tip: 80, growth: {growth}, wall_growth: 1.006, wall_cells: 200"
Suite()  # sets the PATH


def options(meshing, finish):
    mesh = FINE.format(growth=1.004 + draw.uniform(0, 1e-4)) if meshing else COARSE
    return ["--set", f"participants.fluid.mesh-parameters={{{mesh}}}", "--set", f"participants.mover.mesh-parameters={{{mesh}}}",
            "--set", "participants.solid.mesh-parameters={n_side: 24, n_tip: 2}",
            "--set", f"simulation.end-time={'0.03' if finish else '50'}", "--set", "simulation.output.interval=1",
            "--set", f"simulation.hang-timeout={TIMEOUT}"]


def launch(folder, words):
    parts = [f"{RANKS[name]} {program} case.yaml" for name, program in PROGRAMS.items()]
    command = []
    for word in mpmd(*parts):
        command.append(word)
        if word == "case.yaml":
            command += words
    return subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=open(folder / "output", "w"),
                            stderr=subprocess.STDOUT, start_new_session=True)


def name_of(pid):
    try:
        return os.path.basename(os.readlink(f"/proc/{pid}/exe"))
    except OSError:
        return ""


def with_names(session, program):
    """Not the copies that have yet to become a mesh generator."""
    found, every = [pid for pid, name in living(session).items() if name == program], stats()
    return [pid for pid in found if pid in every and every[pid][1] not in found]


def stats():
    """(state, parent, start) of every process by pid."""
    found = {}
    for entry in os.listdir("/proc"):
        if entry.isdigit():
            try:
                fields = pathlib.Path(f"/proc/{entry}/stat").read_text(errors="replace").rpartition(")")[2].split()
            except OSError:
                continue
            found[int(entry)] = (fields[0], int(fields[1]), fields[19])
    return found


def family(job):
    """{pid: start} of what the job has started, whatever its session: a mesh generator may have one of its own."""
    every, mine = stats(), {job.pid}
    for _ in range(8):
        mine |= {pid for pid, (_, parent, _) in every.items() if parent in mine}
    return {pid: every[pid][2] for pid in mine if pid in every}


def alive(job, known):
    """Of the job's session and of its family as it was seen."""
    every = stats()
    left = {pid for pid, start in known.items() if pid in every and every[pid][2] == start and every[pid][0] not in "ZX"}
    return left | set(living(job.pid))


def wait_until(condition, job):
    end = time.monotonic() + PATIENCE
    while job.poll() is None and time.monotonic() < end:
        if value := condition():
            return value
        time.sleep(0.002)
    return None


def is_there(file, size):
    return file.exists() and file.stat().st_size > size


def come(moment, job, folder, victim):
    """Waits for the moment; gives the process that is to be struck, None if the job was over before."""
    if moment == "start":
        pids = wait_until(lambda: with_names(job.pid, PROGRAMS[victim]), job)
        time.sleep(draw.uniform(0, 0.6))
    elif moment == "meshing":
        wait_until(lambda: any("gmsh" in name_of(p) for p in family(job)), job)
        time.sleep(draw.uniform(0, 1))
    elif moment == "steps":
        wait_until(lambda: is_there(folder / "out/coupler/residuals.csv", 400), job)
        time.sleep(draw.uniform(0, 0.5))
    else:
        wait_until(lambda: is_there(folder / "out/coupler/residuals.csv", 400), job)
        wait_until(lambda: list((folder / "out").glob("checkpoints/*")) or "halvings in" in (folder / "output").read_text(), job)
        time.sleep(draw.uniform(0, 0.02))
    pids = with_names(job.pid, PROGRAMS[victim])
    return draw.choice(pids) if pids else None


def is_named(text, victim, pid):
    """By the job, or, before its programs know each other, by the launcher or by the guard of the start."""
    first = sum(list(RANKS.values())[:list(RANKS).index(victim)])
    ranks = "|".join(str(first + r) for r in range(RANKS[victim]))
    return bool(re.search(rf"participant '{victim}' \([^)]*pid {pid}\)|process rank (?:{ranks}) with PID \d+ on node \S+ exited on\s+signal|"
                          rf"{PROGRAMS[victim]} \(pid {pid}\)", text))


def strike(number, folder, cached):
    moment, victim = MOMENTS[number % len(MOMENTS)], draw.choice(list(PROGRAMS))
    what = signal.SIGSTOP if draw.random() < 0.3 else signal.SIGKILL
    if moment == "meshing" and victim == "coupler":
        victim = "fluid"
    for file in [*source.glob("*.yaml"), *source.glob("*.geo")]:
        shutil.copy(file, folder)
    if moment != "meshing":
        for file in cached:
            shutil.copy(file, folder)
    words = options(moment == "meshing", moment == "finish")
    job = launch(folder, words)
    pid = come(moment, job, folder, victim)
    label = f"{number + 1:3d} {victim} {'killed' if what == signal.SIGKILL else 'stopped'} at {moment}"
    known = family(job)
    struck = time.monotonic()
    try:
        if pid:
            os.kill(pid, what)
    except ProcessLookupError:
        pid = None
    allowed = 5 * SLOWER + (max(TIMEOUT, 4) if what == signal.SIGSTOP else 0)
    while time.monotonic() - struck < allowed + 20 and (alive(job, known) or job.poll() is None):
        job.poll()
        time.sleep(0.02)
    took = time.monotonic() - struck
    left = alive(job, known)
    names = sorted({name_of(p) or str(p) for p in left})
    for process in left:
        try:
            os.kill(process, signal.SIGKILL)
        except ProcessLookupError:
            pass
    job.wait()
    text = (folder / "output").read_text()
    if pid is None or job.returncode == 0:  # it was over before, or had done all that it had to do
        return label, "over", took, names, text
    result = "late" if left or took > allowed else "named" if is_named(text, victim, pid) else "not named"
    return label, result, took, names, text


def make_cache(folder):
    for file in [*source.glob("*.yaml"), *source.glob("*.geo")]:
        shutil.copy(file, folder)
    before = set(folder.iterdir())
    job = launch(folder, options(False, True))
    code = job.wait(timeout=PATIENCE)
    if code != 0:
        sys.exit((folder / "output").read_text()[-2000:] + f"\nthe case does not run: code {code}")
    return [f for f in set(folder.iterdir()) - before if f.is_file() and f.name != "output"]


outcomes = collections.Counter()
slowest = 0.0
with tempfile.TemporaryDirectory(prefix="couplet-strikes-") as top:
    top = pathlib.Path(top)
    (top / "cache").mkdir()
    cached = make_cache(top / "cache")
    number = tries = 0
    while number < count and tries < 3 * count:
        tries += 1
        folder = top / f"job-{tries}"
        folder.mkdir()
        label, result, took, left, text = strike(number, folder, cached)
        if result == "over":
            shutil.rmtree(folder, ignore_errors=True)
            continue
        number += 1
        outcomes[result] += 1
        slowest = max(slowest, took)
        print(f"{'ok    ' if result == 'named' else 'not ok'} {label}: {result} ({took:.1f} s){' left: ' + ', '.join(left) if left else ''}", flush=True)
        if result != "named":
            print("    " + "\n    ".join(text.splitlines()[-12:]), flush=True)
        shutil.rmtree(folder, ignore_errors=True)
named = outcomes["named"] / max(1, number)
print(f"{number} strikes: {outcomes['late']} left processes after 5 s, culprit named in {100 * named:.0f} %, slowest end {slowest:.1f} s")
sys.exit(0 if number == count and outcomes["late"] == 0 and named >= 0.95 else 1)
