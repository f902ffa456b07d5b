# SPDX-License-Identifier: Apache-2.0
"""Measures of the fluid's speed and memory: benchmarks/fluid, with icoFoam and pimpleFoam beside it on the same machine."""
import re
import sys


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
