# SPDX-License-Identifier: Apache-2.0
"""A fault of the machine at any operation on a file of a run: a run alone, or a coupled one, ends at once with an error, no checkpoint is complete that is not,
and `couplet resume` goes on from the last good checkpoint to what the undisturbed run gives, bit for bit.

Usage: run.py BIN PRELOAD CASE FAULT COUNT [CASE FAULT COUNT ...] [--part I N]

CASE: alone or coupled

FAULT: error   one write, flush, close or rename fails with EIO, as on a network disk or at a quota
       kill    half of the data is written, then the program is killed by SIGKILL
       disk    the disk is full, at a size that varies, and has room again before the run is resumed; needs a user namespace in which tmpfs can be mounted
COUNT: so many trials, evenly spread over all operations or sizes (0: all operations). --part: only part I of N of the trials."""
import collections
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

import h5py
import numpy

HERE = pathlib.Path(__file__).resolve().parent
TESTS = HERE.parents[1]
sys.path.insert(0, str(TESTS / "support"))
from checks import check, failed  # noqa: E402

BIN, PRELOAD = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
WORDS, _, OF_PART = " ".join(sys.argv[3:]).partition(" --part ")
CAMPAIGNS = list(zip(*[iter(WORDS.split())] * 3))
PART, PARTS = map(int, OF_PART.split() or (0, 1))
ALONE = """
simulation: {end-time: 0.2 s, time-step: 0.01 s, accept: [error-estimate, strain-energy], output: {folder: out, interval: 0.05 s}, checkpoint: {interval: 0.05 s}}
participants:
  solid:
    program: solid_solver
    mesh: square.msh
    dimension: 2
    plane: stress
    material: {density: 7800 kg/m^3, youngs-modulus: 210 GPa, poissons-ratio: 0.3}
    boundaries: {left: {type: fixed-displacement, value: [0, 0]}, right: {type: traction, value: [0, "-1e5*sin(30*t)"]}, bottom: {type: free}, top: {type: free}}
    output: {surfaces: [top]}
    probes: {tip: {point: [1, 0.5]}}
"""
COUPLED = (TESTS / "mistakes/coupled.yaml").read_text().replace("end-time: 0.02 s", "end-time: 0.04 s").replace(
    "diagnostics: without-errors", "accept: [error-estimate], output: {folder: out, interval: 0.02 s}, checkpoint: {interval: 0.02 s}")
OURS = ("coupler", "fluid_solver", "solid_solver", "mesh_mover")
SAID = r"this \w+ (?:fails|kills).*"
CLOCKS = ("participants.csv", "steps.csv", "solver.csv")  # seconds, and counts since the start of the process


def couplet(folder, *words, **environment):
    begun = time.monotonic()
    done = subprocess.run([TESTS.parent / "scripts/couplet", *words, "--bin", BIN], cwd=folder, capture_output=True, text=True, timeout=120,
                          env={**os.environ, "OMP_NUM_THREADS": "1", **environment})
    done.seconds = time.monotonic() - begun
    return done


def results(out):
    """{name: value} of the last checkpoint, the last fields, the tables and the verdict of a run."""
    found = {}
    for file in [*sorted(out.glob("checkpoints/step-*"))[-1].glob("*.h5"), *out.glob("*/*.h5")]:
        with h5py.File(file) as data:
            inner = data["steps/" + sorted(data["steps"])[-1]] if "steps" in data else data
            inner.visititems(lambda name, item: found.update({(file.name, name): item[()]}) if isinstance(item, h5py.Dataset) else None)
    found.update({file.relative_to(out): file.read_text() for file in out.glob("*/*.csv") if file.name not in CLOCKS})
    report = json.loads(sorted(out.glob("*/run.json"))[0].read_text())
    return found | {"state": report["state"], "errors": json.dumps(report["errors"]), "findings": json.dumps(report["findings"])}


def differences(a, b):
    equal = lambda x, y: numpy.array_equal(x, y, equal_nan=x.dtype.kind == "f") if isinstance(x, numpy.ndarray) else x == y  # noqa: E731
    return [str(key) for key in a.keys() | b.keys() if key not in a or key not in b or not equal(a[key], b[key])]


def resumed(folder, whole):
    """What is wrong with the run that goes on from the last good checkpoint; from the start where there is none."""
    sets = list((folder / "out/checkpoints").glob("step-*/set.txt"))
    again = couplet(folder, "resume", "out") if sets and (folder / "out/job.json").exists() else couplet(folder, "run", "case.yaml", *(("--restart", "out/checkpoints") if sets else ()))
    if again.returncode != 0:
        return f"does not go on from {len(sets)} checkpoints: code {again.returncode}, {again.stderr[-600:]}"
    other = differences(whole, results(folder / "out"))
    return f"another result from {len(sets)} checkpoints: {other[:5]}" if other else ""


def injected(folder, whole, fault, program, k):
    shutil.rmtree(folder / "out", ignore_errors=True)
    done = couplet(folder, "run", "case.yaml", LD_PRELOAD=str(PRELOAD), COUPLET_FAIL=f"{program} {k} {fault}")
    said = re.search(SAID, done.stdout + done.stderr)
    if not said:
        return None, "has not come"
    if fault == "error" and (done.returncode not in (1, 2) or "rror" not in done.stderr):
        return said[0], f"goes on or crashes: code {done.returncode}, {done.stderr[-600:]}"
    if done.returncode == 0:
        return said[0], "goes on"
    if done.seconds > 20:
        return said[0], f"takes {done.seconds:.0f} s to end"
    return said[0], resumed(folder, whole)


def full(folder, whole, _, size):
    """The output is on a disk of so many bytes."""
    out = folder / "out"
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", out], check=True)
    try:
        done = couplet(folder, "run", "case.yaml")
        if done.returncode == 0:
            return None, "the disk was not full"
        if done.returncode not in (1, 2):
            return f"{size} bytes", f"crashes: code {done.returncode}, {done.stderr[-600:]}"
        subprocess.run(["mount", "-o", "remount,size=100m", out], check=True)
        return f"{size} bytes", resumed(folder, whole)
    finally:
        subprocess.run(["umount", out], check=True)


def chosen(every, count):
    """So many as are wanted, evenly spread, and of these the wanted part."""
    count = min(count, len(every))
    every = [every[(2 * i + 1) * len(every) // (2 * count)] for i in range(count)] if count else every
    return every[len(every) * PART // PARTS:len(every) * (PART + 1) // PARTS]


def trials_of(folder, fault, count):
    """All that is tried: (program, number of its operation), or the size of a disk."""
    if fault == "disk":
        most = sum(f.stat().st_size + 4095 & ~4095 for f in (folder / "out").rglob("*"))
        return chosen([(most * (i + 1) // (count + 1),) for i in range(count)], count)
    counts, every = collections.Counter(), []
    for program in (line.split()[0] for line in (folder / "writes").read_text().splitlines()):
        counts[program] += 1
        every.append((program, counts[program]))
    print(f"operations on files: {dict(counts)}")
    return chosen([trial for trial in every if trial[0] in OURS], count)


def without_end_of_fields(folder, whole):
    for lost in (1, 4096, 10**9):
        shutil.rmtree(folder / "out", ignore_errors=True)
        couplet(folder, "run", "case.yaml", "--set", "simulation.end-time=0.1 s")
        file = folder / "out/solid/solid.h5"
        os.truncate(file, max(0, file.stat().st_size - lost))
        again = couplet(folder, "resume", "out", "--set", "simulation.end-time=0.2 s")
        check(f"the last {lost} bytes of a field file are lost: it is set aside",
              again.returncode == 0 and not differences(whole, results(folder / "out")) and (file.parent / "solid.h5.aside").exists(), again.stderr[-300:])


def campaign(which, fault, count):
    """Gives the sum of its trials."""
    with tempfile.TemporaryDirectory(prefix="couplet-failed-write-") as scratch:
        folder, bad, tried = pathlib.Path(scratch), 0, collections.Counter()
        for mesh in ("square.msh", "below.msh"):
            shutil.copy(TESTS / "mistakes" / mesh, folder)
        (folder / "case.yaml").write_text(ALONE if which == "alone" else COUPLED)
        done = couplet(folder, "run", "case.yaml", LD_PRELOAD=str(PRELOAD), COUPLET_WRITES=str(folder / "writes"))
        check(f"{which}: nothing fails", done.returncode == 0, done.stderr if done.returncode else "")
        whole, trials = results(folder / "out"), trials_of(folder, fault, count)
        shutil.rmtree(folder / "out")
        (folder / "out").mkdir()
        for trial in trials:
            what, problem = (full if fault == "disk" else injected)(folder, whole, fault, *trial)
            if what is None and fault == "disk":
                continue
            tried[fault if fault == "disk" else trial[0]] += 1
            bad += bool(problem)
            if problem:
                print("not ok ", *trial, what, problem, flush=True)
        if fault == "error" and which == "alone":
            without_end_of_fields(folder, whole)
        total = sum(tried.values())
        check(f"{which}, {fault}: {total} faults came", total >= 0.8 * len(trials) > 0)
        check("each ends the run, which goes on from its last good checkpoint", not bad)
        return f"{which}, {fault}: {total - bad} of {total} ({', '.join(f'{n} in {p}' for p, n in tried.items())})"


if any(fault == "disk" for _, fault, _ in CAMPAIGNS) and "COUPLET_INSIDE" not in os.environ:  # mounts that end with this process
    os.execvpe("unshare", ["unshare", *(["-r"] if os.geteuid() else []), "-m", sys.executable, *sys.argv], {**os.environ, "COUPLET_INSIDE": "1"})
print(*[campaign(which, fault, int(count)) for which, fault, count in CAMPAIGNS], sep="; ")
sys.exit(bool(failed))
