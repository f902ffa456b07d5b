# SPDX-License-Identifier: Apache-2.0
"""The fluid's step on the lid-driven cavity of benchmarks/fluid: instructions per cell and step, speed and divergence beside commit b350924.
Speed needs a build of that commit: COUPLET_OTHER_BUILD names its folder, which holds bin/fluid_solver."""
import importlib.machinery
import importlib.util
import os
import pathlib
import re
import statistics

import couplet

BEFORE = "b350924"
# (cells a side, dimension): dt [s], the steps between which is counted, and the instructions of b350924 by the same count
COUNTED = {(128, 2): (0.004, 10, 30, 1183), (32, 3): (0.008, 20, 30, 2471)}
TIMED = {(128, 2): (0.004, 250), (64, 3): (0.008, 60)}
TOLERANCE, TURNS = 1e-6, 7


def benchmark(job):
    loader = importlib.machinery.SourceFileLoader("couplet_benchmark_fluid", str(job.root / "benchmarks/fluid"))
    spec = importlib.util.spec_from_loader(loader.name, loader)
    module = importlib.util.module_from_spec(spec)
    loader.exec_module(module)
    return module


def scene(job, what, steps):
    """Folder with the case of so many steps; its mesh is made once."""
    n, dimension = what
    dt = (COUNTED.get(what) or TIMED[what])[0]
    folder = job.scratch / f"cavity-{n}-{dimension}"
    folder.mkdir(exist_ok=True)
    job.once(("benchmark module",), lambda: benchmark(job)).cavity_case(folder, dimension, n, dt, steps, TOLERANCE)
    return folder


def instructions(job, program, what):
    """Per cell and step, of the whole process between two lengths of the run."""
    n, dimension = what
    dt, first, last, _ = COUNTED[what]
    totals = []
    for steps in (first, last):
        folder = scene(job, what, steps)
        job.once(("meshed", what), lambda: job.run([program, "case.yaml"], cwd=folder))
        counts = folder / "counts"
        job.done(["valgrind", "--tool=callgrind", f"--callgrind-out-file={counts}", program, "case.yaml"], cwd=folder)
        totals.append(int(re.search(r"^(?:totals|summary): (\d+)", counts.read_text(), re.M)[1]))
    return (totals[1] - totals[0]) / (n**dimension * (last - first))


def counted(job, what, share):
    got, before = instructions(job, job.build / "bin/fluid_solver", what), COUNTED[what][3]
    return f"{got:.0f}, {got / before:.2f} of the {before} of {BEFORE}", got <= share * before


def timed(job, program, what, steps):
    """Seconds in the steps by the run's own clock, and the mean divergence at the end [1/s]."""
    folder = scene(job, what, steps)
    result = job.done([program, "case.yaml"], cwd=folder)
    seconds = sum(float(m) for m in re.findall(r"^(?:begin_step|solve|accept_step) +([\d.]+) ", result.stdout, re.M))
    return seconds, couplet.read_csv(folder / "out/fluid/balance.csv")["mean divergence [1/s]"][-1]


def pairs(job, what):
    """[(seconds before, now)], and the divergences of both."""
    def make():
        other = os.environ.get("COUPLET_OTHER_BUILD")
        if not other:
            raise LookupError(f"COUPLET_OTHER_BUILD names no build of {BEFORE}")
        programs = [pathlib.Path(other) / "bin/fluid_solver", job.build / "bin/fluid_solver"]
        turns = [[timed(job, program, what, TIMED[what][1]) for program in programs] for _ in range(TURNS)]
        return [(a[0], b[0]) for a, b in turns], turns[-1][0][1], turns[-1][1][1]
    return job.once(("pairs", what), make)


def faster(job, what, wanted):
    turns, *_ = pairs(job, what)
    ratio = statistics.median(before / now for before, now in turns)
    return f"{ratio:.2f} times, median of {len(turns)} pairs, tolerance {TOLERANCE:g}", ratio >= wanted


def divergence(job, what):
    _, before, now = pairs(job, what)
    return f"{now:.1e} for {before:.1e} 1/s", now <= before
