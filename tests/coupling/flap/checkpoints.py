#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How often the flap is saved is nothing to it: runs with a checkpoint at the end alone, with one in the middle besides, and
with one a step leave the same last state bit for bit, and so does one that goes on from the middle. Coarse meshes.
Usage: checkpoints.py CONFIG_FOLDER BIN RANKS"""
import pathlib
import shutil
import sys
import tempfile

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import COUPLED, mpmd, said  # noqa: E402

STEPS, MIDDLE, STEP = 5, 3, 0.01
SOURCE, BIN = (pathlib.Path(path).resolve() for path in sys.argv[1:3])
RANKS = sys.argv[3]
COUNTS = {"n_side = 80": "n_side = 20", "n_side = 160": "n_side = 40", "n_tip = 8": "n_tip = 4", "n_tip = 16": "n_tip = 8",
          "growth = 1.12; ": "growth = 1.25; ", "wall_cells = 10": "wall_cells = 5"}


def run(folder, interval, restart=None):
    words = [f"--set=simulation.end-time={STEPS * STEP}", f"--set=simulation.checkpoint={{interval: {interval}, keep: 100}}",
             f"--set=simulation.output={{folder: {folder.name}, interval: 0}}", *(["--restart", restart] if restart else [])]
    said(mpmd([[BIN / program, "case.yaml", *words] for program in COUPLED], (1, RANKS, RANKS, RANKS)), cwd=folder.parent)
    return folder


def last_state(folder):
    state = {}
    for file in sorted((folder / "checkpoints" / f"step-{STEPS:08d}").glob("*.h5")):
        with h5py.File(file) as data:
            data.visititems(lambda name, item: state.update({f"{file.stem}: {name}": item[()]})
                            if isinstance(item, h5py.Dataset) else None)
    return state


def main():
    with tempfile.TemporaryDirectory(prefix="couplet-checkpoints-") as name:
        here = pathlib.Path(name)
        shutil.copy(SOURCE / "case.yaml", here)
        for mesh in ("fluid.geo", "solid.geo"):
            text = (SOURCE / mesh).read_text()
            for old, new in COUNTS.items():
                text = text.replace(old, new)
            (here / mesh).write_text(text)
        wanted = last_state(run(here / "end", 1))
        if len(wanted) < 40:
            sys.exit(f"only {len(wanted)} tables were saved")
        run(here / "middle", MIDDLE * STEP)
        others = {"one checkpoint in the middle": here / "middle", "one a step": run(here / "each", STEP)}
        shutil.copytree(here / "middle" / "checkpoints" / f"step-{MIDDLE:08d}", here / "set")
        others["gone on from the middle"] = run(here / "on", STEP, here / "set")
        failed = False
        for what, folder in others.items():
            state = last_state(folder)
            apart = [key for key in sorted(wanted.keys() | state.keys())
                     if key not in wanted or key not in state or not numpy.array_equal(wanted[key], state[key], equal_nan=True)]
            print(f"{what}: {len(apart)} of {len(wanted)} tables differ{': ' + ', '.join(apart[:8]) if apart else ''}")
            failed = failed or bool(apart)
        sys.exit(failed)


main()
