# SPDX-License-Identifier: Apache-2.0
"""Accuracy per cell, time of steps beside other programs, and the command."""
import os
import re
import resource
import sys
import time


PEAK, HEIGHT = 9.0, 0.0128  # of -dk/dt at Re 1600
KEY = "participants.fluid.face-values="
ORDERS = {"second": KEY + "second-order", "fourth": KEY + "fourth-order"}


def cavity(job):
    """The largest deviation of the three extrema by order, and the processor minutes."""
    found = {}
    for name, setting in ORDERS.items():
        run = job.case("cavity-3d", [setting], timeout=7200)
        found[name] = job.beside("configs/cavity-3d/extrema.py").errors(run.folder / "fluid"), run.cost.cpu / 60
    return found


def peak(job, n, name, *sets):
    folder = job.case(
        "taylor-green-3d", [f"participants.fluid.mesh-parameters.n={n}", ORDERS[name], *sets], timeout=48 * 3600
    ).folder
    return job.beside("configs/taylor-green-3d/budget.py").budget(folder / "fluid")


def vortices(job, n, what, share):
    key, wanted = {"time": ("peak_time", PEAK), "height": ("peak", HEIGHT)}[what]
    sets = ["simulation.time-step=0.02 s"] if n > 64 else []
    got = {name: peak(job, n, name, *sets)[key] for name in ORDERS}
    texts = [f"{name} order {got[name]:.5g} ({100 * (got[name] / wanted - 1):+.1f} %)" for name in ("fourth", "second")]
    return ", ".join(texts), abs(got["fourth"] / wanted - 1) <= share


# -- speed ------------------------------------------------------------------------------------------------------------
def benchmark(job, only):
    def make():
        result = job.done([sys.executable, job.root / "benchmarks/fluid", "--build", job.build, "--only", only])
        return result.stdout

    return job.once(("benchmark", only), make)


def ratio(job, only, wanted):
    text = benchmark(job, only)
    found = re.search(r"ratio ([\d.]+)", text)
    if not found:
        raise LookupError("OpenFOAM is not installed")
    return f"{found[1]} times", float(found[1]) >= wanted


def memory(job):
    found = re.search(r"([\d.]+) kB per cell", benchmark(job, "cavity-3d"))
    return f"{found[1]} kB per cell", float(found[1]) <= 1.5


def second_core(job, wanted):
    found = re.search(r"two ranks: .*, ([\d.]+) times", benchmark(job, "cavity-3d"))
    return f"{found[1]} times", float(found[1]) >= wanted


# -- jobs -------------------------------------------------------------------------------------------------------------
def overhead(job):
    """Wall and processor time of couplet run less those of mpirun with the same line; the programs do nothing, the runs
    alternate. What the machine does besides lengthens both: the quickest of all runs counts."""
    couplet, folder, programs = job.root / "scripts/couplet", job.scratch / "overhead", job.scratch / "idle/bin"
    job.run([couplet, "new", folder], check=True)
    programs.mkdir(parents=True)
    for name in ("coupler", "fluid_solver", "solid_solver", "mesh_mover"):
        (programs / name).write_text("#!/bin/sh\nexit 0\n")
        (programs / name).chmod(0o755)
    command = [couplet, "run", folder, "--bin", programs]
    line = job.run([*command, "--print"], check=True).stdout
    wall, processor = {"couplet": [], "mpirun": []}, {"couplet": [], "mpirun": []}
    for _ in range(20):
        for name, words in (("couplet", command), ("mpirun", ["sh", "-c", "exec " + line])):
            start, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
            job.run(words, check=True)
            wall[name].append(time.monotonic() - start)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            processor[name].append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    seconds, used = (min(t["couplet"]) - min(t["mpirun"]) for t in (wall, processor))
    return (
        (
            f"{seconds:.2f} s, {used:.2f} s of the processor (mpirun {min(wall['mpirun']):.2f} s; load"
            f" {os.getloadavg()[0]:.0f})"
        ),
        seconds < 0.2,
    )
