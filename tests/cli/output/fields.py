#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What of the fields is written: each n-th output, none but those of patches, the cells in a box, compressed; fields of a box and
compressed ones hold what those of the whole do.
Usage: fields.py BIN CASES"""
import pathlib
import shutil
import sys
import tempfile

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import require, said  # noqa: E402

BIN, CASES = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])


def run(here, name, out, output, ranks=1):
    words = ["mpirun", "--oversubscribe", "-n", str(ranks), str(BIN / f"{name}_solver"), f"{name}.yaml", f"--set=simulation.output={{folder: {out}, interval: 0.25, {output}}}",
             f"--set=participants.{name}.output.surfaces=[bottom]", "--set=simulation.time-step=0.25",
             "--set=simulation.diagnostics=without-errors"]
    said(words, 100, cwd=here)
    return here / out / name


def series(file):
    """{time: {place/field: {id: value}}}"""
    found = {}
    with h5py.File(file) as data:
        ids = {"cells": data["mesh/cell-id"][...], "points": data["mesh/point-id"][...]}
        for step in data["steps"].values():
            found[round(float(step.attrs["time"]), 9)] = {f"{place}/{field}": dict(zip(ids[place], table[...])) for place in ids for field, table in step.get(place, {}).items()}
    return found


def same(part, whole):
    """Whether what stands in `part` stands in `whole`, with the same value."""
    return all(numpy.array_equal(value, whole[time][field][key]) for time, fields in part.items() for field, values in fields.items() for key, value in values.items())


with tempfile.TemporaryDirectory(prefix="couplet-fields-") as folder:
    here = pathlib.Path(folder)
    for file in ("square.msh", "fluid.yaml", "solid.yaml"):
        shutil.copy(CASES / file, here)
    for name in ("fluid", "solid"):
        whole = series(run(here, name, "whole", "steps: true") / f"{name}.h5")
        times = sorted(whole)
        require(f"{name}: outputs", len(times) >= 5, times)
        every = run(here, name, "every", "every: 2")
        require(f"{name}: each second output", sorted(series(every / f"{name}.h5")) == times[::2])
        require(f"{name}: patches at each output", len(series(every / "surface-bottom.h5")) >= len(times) - 1)
        none = run(here, name, "none", "every: 0")
        require(f"{name}: patches alone", not (none / f"{name}.h5").exists() and (none / "surface-bottom.h5").exists())
        for ranks in (1, 2):
            box = series(run(here, name, f"box-{ranks}", "box: {from: [0, 0, 0], to: [0.5, 0.5, 0]}, compression: 4", ranks) / f"{name}.h5")
            cells = [len(next(values for field, values in fields.items() if field.startswith("cells"))) for fields in (box[times[-1]], whole[times[-1]])]
            require(f"{name}: a box, compressed, {ranks} rank(s)", sorted(box) == times and 0 < cells[0] < cells[1] and (ranks > 1 or same(box, whole)), cells)
