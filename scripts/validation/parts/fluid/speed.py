# SPDX-License-Identifier: Apache-2.0
"""Bars of the fluid's speed and memory: benchmarks/fluid, with icoFoam and pimpleFoam beside it on the same machine."""
import re
import sys

from validation.job import Bar


def benchmark(job, only):
    def make():
        result = job.run([sys.executable, job.root / "benchmarks/fluid", "--build", job.build, "--only", only])
        if result.returncode != 0:
            raise RuntimeError((result.stderr or result.stdout)[-300:])
        return result.stdout
    return job.once(("benchmark", only), make)


def ratio(only, wanted):
    def measure(job):
        text = benchmark(job, only)
        found = re.search(r"ratio ([\d.]+)", text)
        if not found:
            raise LookupError("OpenFOAM is not installed")
        return f"{found[1]} times", float(found[1]) >= wanted
    return measure


def memory(job):
    found = re.search(r"([\d.]+) kB per cell", benchmark(job, "cavity-3d"))
    return f"{found[1]} kB per cell", float(found[1]) <= 1.5


def second_core(wanted):
    def measure(job):
        found = re.search(r"two ranks: .*, ([\d.]+) times", benchmark(job, "cavity-3d"))
        return f"{found[1]} times", float(found[1]) >= wanted
    return measure


BARS = [
    Bar("speed: cavity 128^2 against icoFoam, one core", ">= 8 times", ratio("cavity-2d", 8), long=True),
    Bar("speed: cavity 64^3 against icoFoam, one core", ">= 3 times", ratio("cavity-3d", 3), long=True),
    Bar("speed: 24 000 cells around an oscillating cylinder against pimpleFoam, one core", ">= 8 times", ratio("moving-cylinder", 8), long=True),
    Bar("time to equal error: cavity Re 1000, icoFoam on 128^2", ">= 10 times", ratio("equal-error", 10), long=True),
    Bar("time to equal error: vortex street 2D-2, icoFoam on 24 330 cells", ">= 5 times", ratio("shedding", 5), long=True),
    Bar("speed: second core on 64^3", ">= 1.5 times", second_core(1.5), long=True),
    Bar("memory on 64^3", "<= 1.5 kB per cell", memory, long=True),
]
