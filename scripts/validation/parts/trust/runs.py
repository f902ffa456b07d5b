# SPDX-License-Identifier: Apache-2.0
"""Measures of runs, files and input: step counts, checkpoints, what is overwritten, geometry that runs commands, broken inputs,
--check, start-up, signals."""
import shutil
import statistics
import time

PROGRAMS = ("solid_solver", "fluid_solver", "mesh_mover", "thermocline", "coupler")


def fuzz(job, name, count):
    """What the one test of a fuzz program recorded, and whether it passed."""
    found, passed = job.fuzz(name, count)
    return next(iter(found.values())), passed


def yaml(job):
    found = [fuzz(job, f"fuzz_yaml_{program}", 4000) for program in PROGRAMS]
    tried = sum(int(t["tried"]) for t, _ in found)
    return (f"{tried} tried over {len(found)} programs, {sum(int(t['refused']) for t, _ in found)} refused, "
            f"{sum(int(t['unplaced']) for t, _ in found)} messages without a place, slowest {max(float(t['slowest']) for t, _ in found):.2f} s, "
            f"{max(float(t['megabytes']) for t, _ in found):.0f} MB"), tried >= 20000 and all(good for _, good in found)


def meshes(job):
    test, good = fuzz(job, "fuzz_meshes", 10000)
    return (f"{test['tried']} tried, {test['refused']} refused, slowest {test['slowest']} s, {test['megabytes']} MB",
            good and int(test["tried"]) >= 10000)


def checkpoints(job):
    test, good = fuzz(job, "fuzz_checkpoints", 2000)
    return (f"{test['tried']} damaged: {test['refused']} refused, {test['earlier_set']} continued from an earlier set, "
            f"{test['unharmed']} unharmed, 0 with another result", good and int(test["tried"]) >= 2000)


def start_up(job):
    folder = job.scratch / "start-up"
    folder.mkdir(exist_ok=True)
    shutil.copy(job.root / "tests/cli/wrong/tank.yaml", folder / "case.yaml")
    times = []
    for _ in range(9):
        start = time.monotonic()
        result = job.run([job.build / "bin/thermocline", "case.yaml"], cwd=folder)
        times.append(time.monotonic() - start)
        if result.returncode != 0:
            raise RuntimeError(result.stderr[-200:])
    return f"{statistics.median(times):.2f} s (least {min(times):.2f} s) of 9 runs", statistics.median(times) <= 0.2
