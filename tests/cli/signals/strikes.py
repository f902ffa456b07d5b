#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Signals at random moments on the processes of the perpendicular flap. After each: all processes have ended within 5 s
(or the run has come to its end), none is left, one line names the one that was struck. The next run goes on from the
last checkpoint; a run that comes to its end must leave what an undisturbed one does, bit for bit, also where it was stopped
on request and has saved at a step at which the undisturbed one did not.
Usage: strikes.py BIN CASE_FOLDER COUNT [SEED [END_TIME]] [--couplet]     --couplet: the jobs are started by couplet run"""
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import living, mpmd  # noqa: E402

COUPLET = "--couplet" in sys.argv
if COUPLET:
    sys.argv.remove("--couplet")
PROGRAMS = {"coupler": "coupler", "fluid": "fluid_solver", "solid": "solid_solver", "mover": "mesh_mover"}
SIGNALS = ["KILL", "TERM", "INT", "STOP", "SEGV"]
SLOWER = int(os.environ.get("COUPLET_SLOWER", 1))  # a step with sanitizers takes seconds
WITHIN = 5.0 * SLOWER
SETS = [f"simulation.end-time={sys.argv[5] if len(sys.argv) > 5 else 0.8}", "simulation.output.interval=0.2", "simulation.checkpoint.interval=0.05",
        f"simulation.hang-timeout={2 * SLOWER}"]


def fields_of(pid):
    with open(f"/proc/{pid}/stat", encoding="utf-8", errors="replace") as file:
        return file.read().rpartition(")")[2].split()


class Job:
    def __init__(self, binaries, folder, restart=False):
        more = [word for s in SETS for word in ("--set", s)] + (["--restart", "out/checkpoints"] if restart else [])
        words = mpmd([binaries / program, "case.yaml", *more] for program in PROGRAMS.values())
        if COUPLET:
            words = [str(pathlib.Path(__file__).resolve().parents[3] / "scripts/couplet"), "run", "case.yaml", "--bin", str(binaries), *more]
        environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
        self.said = open(folder / "said", "w+", encoding="utf-8", errors="replace")
        self.start = time.monotonic()
        self.process = subprocess.Popen(words, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=self.said,
                                        stderr=subprocess.STDOUT, start_new_session=True)
        self.sessions = {self.process.pid}

    def living(self):
        """Processes of the job: of the session of what was started, and of those that it has begun (couplet run: mpirun's)."""
        for entry in os.listdir("/proc") if COUPLET else ():
            if entry.isdigit():
                try:
                    fields = fields_of(entry)
                except OSError:
                    continue
                if int(fields[1]) == self.process.pid and fields[3] == entry:
                    self.sessions.add(int(entry))
        return {pid: exe for session in self.sessions for pid, exe in living(session).items()}

    def victims(self):
        """{participant: pid}: the processes that run the programs themselves."""
        names = {program: name for name, program in PROGRAMS.items()}
        found = {names[exe]: pid for pid, exe in self.living().items() if exe in names}
        found["mpirun"] = self.process.pid
        return found

    def wait(self, seconds):
        """True if all of the job has ended in time."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.process.poll()
            if not self.living() and self.process.returncode is not None:
                return True
            time.sleep(0.02)
        return False

    def has_been_served(self):
        """Whether all that the coupler serves have said their last words: nobody is left who could miss it."""
        return pathlib.Path(self.said.name).read_text(errors="replace").count("peak memory of '") >= len(PROGRAMS) - 1

    def clear(self):
        for pid in self.living():
            os.kill(pid, signal.SIGKILL)
        self.process.wait()
        self.said.seek(0)
        text = self.said.read()
        self.said.close()
        return text


def final_state(folder):
    """All arrays and values of the last checkpoint."""
    state = {}
    last = sorted((folder / "out/checkpoints").glob("step-*"))[-1]
    for file in sorted(last.glob("*.h5")):
        with h5py.File(file) as data:
            data.visititems(lambda name, item: state.update({f"{file.name}/{name}": item[()]})
                            if isinstance(item, h5py.Dataset) else None)
    return state


def differences(a, b):
    """Names of the tables and values that differ or are in one of them alone."""
    return [key for key in sorted(a.keys() | b.keys())
            if key not in a or key not in b or not numpy.array_equal(a[key], b[key], equal_nan=True)]


def copy_case(source, folder):
    folder.mkdir()
    for file in source.iterdir():
        if file.suffix in (".yaml", ".geo"):
            shutil.copy(file, folder)


def judge(name, victim, ended, finished, said, left):
    """(problems, whether the culprit was to be named, whether it was)"""
    problems = []
    if not ended and not finished:
        problems.append(f"not ended within {WITHIN:g} s")
    if left:
        problems.append(f"processes left: {left}")
    asked = "by a signal; the state is saved" in said
    named = f"participant '{victim}'" in said or asked
    due = victim != "mpirun" and not finished and "t=" in said  # after the start-up
    if name == "TERM" and due and not asked:
        problems.append("a stop that was asked for was not honoured")
    return problems, due, named


def main():
    binaries, source, count = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve(), int(sys.argv[3])
    dice = random.Random(int(sys.argv[4]) if len(sys.argv) > 4 else 1)
    failed, due_count, named_count, compared, stopped = 0, 0, 0, 0, 0
    with tempfile.TemporaryDirectory(prefix="couplet-strikes-") as name:
        scratch = pathlib.Path(name)
        folder = scratch / "undisturbed"
        copy_case(source, folder)
        job = Job(binaries, folder)
        job.wait(600)
        whole = time.monotonic() - job.start
        text = job.clear()
        if job.process.returncode != 0:
            sys.exit(f"the undisturbed run failed:\n{text}")
        wanted = final_state(folder)
        run = 0
        for strike in range(count):
            folder = scratch / f"run-{run}"
            restart = False
            if folder.exists():
                restart = any((s / "set.txt").exists() for s in (folder / "out/checkpoints").glob("step-*"))
            else:
                copy_case(source, folder)
            job = Job(binaries, folder, restart)
            which = SIGNALS[strike % len(SIGNALS)]
            moment = dice.uniform(0.3, 0.7 * whole)
            finished = job.wait(moment)
            victim = "nobody"
            if not finished:
                choice = job.victims()
                victim = "mpirun" if which in ("TERM", "KILL") and dice.random() < 0.15 else dice.choice(
                    sorted(set(choice) - {"mpirun"}) or ["mpirun"])
                struck = time.monotonic()
                try:
                    os.kill(choice[victim], getattr(signal, "SIG" + which))
                except ProcessLookupError:
                    victim = "nobody"
                ended = job.wait(WITHIN)
                seconds = time.monotonic() - struck
                if not ended and which == "STOP" and job.has_been_served():  # it ends when it may go on
                    os.kill(choice[victim], signal.SIGCONT)
                    ended = job.wait(WITHIN)
            else:
                ended, seconds = True, 0.0
            left = {} if ended else job.living()
            said = job.clear()
            code = job.process.returncode
            if code == 0:
                finished = True
            stopped += "by a signal; the state is saved" in said
            problems, due, named = judge(which, victim, ended, finished, said, left)
            due_count, named_count = due_count + due, named_count + (due and named)
            if finished:
                compared += 1
                other = differences(wanted, final_state(folder))
                if other:
                    problems.append(f"another result: {other[:5]}")
                shutil.rmtree(folder)
                run += 1
            print(f"{'not ok' if problems else 'ok'}  {strike}: SIG{which} to {victim} after {moment:.1f} s, {'restarted' if restart else 'fresh'}: "
                  f"code {code} after {seconds:.1f} s{', named' if named else ''}{', came to its end' if finished else ''}", flush=True)
            if problems or (due and not named):
                print("  " + "\n  ".join(problems) + "\n    " + "\n    ".join(said.splitlines()[-12:]), flush=True)
            failed += bool(problems)
        # What is left of the last run, to its end.
        folder = scratch / f"run-{run}"
        if folder.exists():  # from the start where the machine was too busy for a checkpoint
            job = Job(binaries, folder, any((s / "set.txt").exists() for s in (folder / "out/checkpoints").glob("step-*")))
            job.wait(600)
            said = job.clear()
            compared += 1
            if job.process.returncode != 0 or differences(wanted, final_state(folder)):
                failed += 1
                print(f"not ok  the last run, to its end: code {job.process.returncode}\n    " + "\n    ".join(said.splitlines()[-12:]))
    share = named_count / due_count if due_count else 1.0
    print(f"{count} strikes, {failed} failed, culprit named in {named_count} of {due_count} ({100 * share:.0f} %), {stopped} stopped on "
          f"request, {compared} runs compared at their end bit for bit")
    sys.exit(1 if failed or share < 0.95 or compared == 0 else 0)


main()
