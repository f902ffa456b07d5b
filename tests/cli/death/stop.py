# SPDX-License-Identifier: Apache-2.0
"""A job that is asked to stop saves its state, ends with code 3 and goes on bit for bit; one whose partner hangs ends and
names it. Usage: stop.py BIN TOYS"""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

from jobs import PATIENCE, case_text, living, mpmd

PROGRAMS = {"coupler": "coupler", "fluid": "toy_piston", "solid": "toy_spring"}
failed = 0


def start(folder, words):
    environment = dict(os.environ)
    environment["PATH"] = os.pathsep.join([os.path.abspath(p) for p in sys.argv[1:3]] + [environment["PATH"]])
    return subprocess.Popen(words, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, text=True, start_new_session=True)


def pid_of(process, program):
    return next((pid for pid, name in living(process.pid).items() if name == program), None)


def wait_for(file, process, size=3000):
    """The file is there: steps are being made."""
    end = time.monotonic() + PATIENCE
    while not (file.exists() and file.stat().st_size > size) and process.poll() is None and time.monotonic() < end:
        time.sleep(0.01)


def end_of(process):
    output, _ = process.communicate(timeout=PATIENCE)
    return process.returncode, output


def check(name, good, output=""):
    global failed
    print(f"{'ok' if good else 'not ok'}  {name}", flush=True)
    if not good:
        failed += 1
        print("    " + "\n    ".join(output.splitlines()[-30:]), flush=True)


def case(folder, end, sets=""):
    (folder / "case.yaml").write_text(case_text(end=end).replace("output: {folder: out}", "output: {folder: out}" + sets))


def coupled(*options):
    return mpmd(*(f"1 {p} case.yaml {' '.join(options)}".strip() for p in PROGRAMS.values()))


CLOCKS = ("working [s]", "waiting [s]", "wall clock [s]", "seconds [s]")


def rows(folder):
    """Of all series; what a clock says is left out."""
    series = {}
    for file in sorted((folder / "out").rglob("*.csv")):
        lines = [line.split(",") for line in file.read_text().splitlines()]
        keep = [i for i, name in enumerate(lines[0]) if not name.endswith(CLOCKS)]
        series[str(file.relative_to(folder))] = [[line[i] for i in keep] for line in lines]
    return series


def difference(a, b):
    """The first, in words; empty if there is none."""
    for name in sorted(a.keys() | b.keys()):
        if name not in a or name not in b:
            return f"{name} is there only once"
        for one, other in zip(a[name], b[name]):
            if one != other:
                return f"{name}: {one} and {other}"
        if len(a[name]) != len(b[name]):
            return f"{name} has {len(a[name])} and {len(b[name])} rows"
    return ""


with tempfile.TemporaryDirectory(prefix="couplet-stop-") as name:
    top = pathlib.Path(name)
    for victim in ("coupler", "solid"):
        # Long enough not to be over before the signal comes.
        folder = top / victim
        folder.mkdir()
        case(folder, "100 s")
        job = start(folder, coupled())
        wait_for(folder / "out/coupler/residuals.csv", job)
        pid = pid_of(job, PROGRAMS[victim])
        if pid:
            os.kill(pid, signal.SIGTERM)
        code, output = end_of(job)
        check(f"SIGTERM to {victim}: saved, code 3", code == 3 and "by a signal; the state is saved" in output, output)
        case(folder, "100 s", "\n  checkpoint: {keep: 3}")  # a change that is harmless
        code, output = end_of(start(folder, coupled("--restart", "out/checkpoints", "-q")))
        check("... and it goes on to its end", code == 0, output)
        whole = top / (victim + "-whole")
        whole.mkdir()
        case(whole, "100 s")
        code, output = end_of(start(whole, coupled("-q")))
        apart = difference(rows(folder), rows(whole))
        check(f"... with the rows of an undisturbed run {apart}", code == 0 and not apart, output)

    folder = top / "alone"
    folder.mkdir()
    case(folder, "1e9 s")
    job = start(folder, ["toy_spring", "case.yaml", "--participant", "solid"])
    wait_for(folder / "out/solid/solid.log", job, 300)
    job.send_signal(signal.SIGTERM)
    code, output = end_of(job)
    check("SIGTERM to a program alone: saved, code 3", code == 3 and "by a signal; the state is saved" in output, output)

    for victim in ("fluid", "coupler"):
        folder = top / ("hang-" + victim)
        folder.mkdir()
        case(folder, "1e6 s", "\n  hang-timeout: 1 s")
        job = start(folder, coupled("-q"))
        wait_for(folder / "out/coupler/residuals.csv", job)
        pid = pid_of(job, PROGRAMS[victim])
        if pid:
            os.kill(pid, signal.SIGSTOP)
        before = time.monotonic()
        code, output = end_of(job)
        check(f"SIGSTOP to {victim}: named ({time.monotonic() - before:.1f} s)",
              code != 0 and f"participant '{victim}' (rank 0, " in output and "is stopped (as by SIGSTOP)" in output, output)

    # Before the programs know each other nobody can be named, but the others do not wait for ever in MPI's start.
    folder = top / "hang-at-the-start"
    folder.mkdir()
    case(folder, "1e6 s", "\n  hang-timeout: 1 s")
    job = start(folder, coupled("-q"))
    end = time.monotonic() + PATIENCE
    while not (pid := pid_of(job, "toy_piston")) and time.monotonic() < end:
        time.sleep(0.001)
    os.kill(pid, signal.SIGSTOP)
    code, output = end_of(job)
    check("SIGSTOP before the roll call: the job ends", code != 0 and "have answered within 4 s of the start" in output, output)

    folder = top / "patient"
    folder.mkdir()
    case(folder, "1e6 s", "\n  hang-timeout: 60 s")
    job = start(folder, coupled("-q"))
    wait_for(folder / "out/coupler/residuals.csv", job)
    pid = pid_of(job, "toy_piston")
    os.kill(pid, signal.SIGSTOP)
    time.sleep(1.5)
    os.kill(pid, signal.SIGCONT)
    time.sleep(1)
    check("a short pause is no hang", job.poll() is None)
    os.killpg(job.pid, signal.SIGKILL)
    job.communicate()

sys.exit(1 if failed else 0)
