#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Processor time of whole small jobs that need nothing of PETSc because a solver of ours serves them, beside the same with PETSc's libraries loaded
(not started, which comes on top): jobs.csv, from which `tables.py` takes what loading costs. Usage: benchmarks/linalg/jobs.py [BUILD [TURNS]]"""
import csv
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
COLUMNS = ("solver", "job", "cells", "seconds", "with_petsc", "turns")
S = "participants.solid."
SIZES = ((4, 6, 3), (8, 12, 6), (16, 24, 12))


def seconds(command, **more):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, env={**os.environ, **more}, stdout=subprocess.DEVNULL, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def rows(build, turns):
    for nr, nt, nz in SIZES:
        with tempfile.TemporaryDirectory() as folder:
            job = [build / "bin/solid_solver", ROOT / "configs/elliptic-plate/case.yaml", "--set", f"simulation.output.folder={folder}/out",
                   "--set", S + f"mesh-parameters={{nr: {nr}, nt: {nt}, nz: {nz}, shape: 0}}", "--set", S + "solution-method={preconditioner: multigrid}"]
            seconds(job)  # the mesh is made
            taken = [(seconds(job), seconds(job, LD_PRELOAD=str(build / "lib/libcouplet_petsc.so"))) for _ in range(turns)]
        yield dict(zip(COLUMNS, ("krylov", "plate B", nr * nt * nz, *(f"{statistics.median(t):.4g}" for t in zip(*taken)), turns)))


def read(path=HERE / "jobs.csv"):
    return list(csv.DictReader(path.read_text().splitlines()))


if __name__ == "__main__":
    build, turns = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build").resolve(), int(sys.argv[2]) if len(sys.argv) > 2 else 5
    with open(HERE / "jobs.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows(build, turns))
