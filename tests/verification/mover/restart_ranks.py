#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A mesh mover alone that is stopped in the middle goes on on other numbers of ranks: its last state is that of the run on one rank
within the tolerance of its solver, and the same bits on the same number; a checkpoint of another mesh is refused by name.
Usage: restart_ranks.py CONFIG_FOLDER MESH_MOVER"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy

SOURCE, PROGRAM = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
STEPS, STEP, TOLERANCE = 6, 0.02, 1e-6
METHODS = ["laplacian", "pseudo-solid", "barrier"]


def run(here, out, ranks, steps, method, restart=None, changes=()):
    sets = [f"simulation.end-time={steps * STEP}", "simulation.checkpoint.interval=0", f"simulation.output={{folder: {out}, interval: 0}}",
            "participants.mover.mesh-parameters={n: 10}", f"participants.mover.method={method}", *changes]
    words = ["mpirun", "--oversubscribe", "-n", str(ranks), str(PROGRAM), "case.yaml", *(f"--set={s}" for s in sets)]
    words += ["--restart", str(restart), "--restart-with-changes"] if restart else []
    return subprocess.run(words, cwd=here, capture_output=True, text=True, timeout=280)


def state(folder):
    with h5py.File(folder / "mover.h5") as file:
        return {name: item[()] for group in ("fields", "arrays", "scalars") if group in file for name, item in file[group].items()
                if isinstance(item, h5py.Dataset)}


def main():
    failed = False
    with tempfile.TemporaryDirectory(prefix="couplet-mover-") as scratch:
        here = pathlib.Path(scratch) / "case"
        shutil.copytree(SOURCE, here, ignore=shutil.ignore_patterns("out*"))

        def ended(out, ranks, steps, method, restart=None):
            result = run(here, out, ranks, steps, method, restart)
            if result.returncode:
                sys.exit(f"{method}, {out}: exit code {result.returncode}\n{result.stdout[-2000:]}\n{result.stderr[-2000:]}")
            return here / out / "checkpoints" / f"step-{steps:08d}"

        for k, method in enumerate(METHODS):
            whole = state(ended(f"whole-{k}", 1, STEPS, method))
            half = {n: ended(f"half-{k}-{n}", n, STEPS // 2, method) for n in (1, 2)}
            for one, other in ((1, 1), (1, 2), (2, 1)) + (((1, 3),) if k < 2 else ()):
                found = state(ended(f"on-{k}-{one}-{other}", other, STEPS, method, half[one]))
                off = numpy.abs(found["displacement"] - whole["displacement"]).max() / numpy.abs(whole["displacement"]).max()
                print(f"{method}: {one} to {other}: apart by {off:.2g}", flush=True)
                failed = failed or not off <= (0 if one == other else TOLERANCE)
        result = run(here, "wrong", 2, STEPS, "laplacian", half[1], ["participants.mover.mesh-parameters={n: 7}"])
        told = result.stdout + result.stderr
        if result.returncode == 0 or "is from another mesh" not in told:
            print(f"another mesh was not refused by name:\n{told[-1500:]}")
            failed = True
    sys.exit(failed)


main()
