#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The solid's free vibrations in a file, as plate_modal takes them: a bracket let go under its own weight moves as twelve
modes as it does in finite volumes. Usage: solid_modes.py CONFIGS BIN"""
import csv
import pathlib
import shutil
import subprocess
import sys
import tempfile

configs, binaries = map(pathlib.Path, sys.argv[1:3])


def motion(file):
    with open(file, encoding="utf-8") as f:
        return [[float(v) for v in row] for row in list(csv.reader(f))[1:]]


with tempfile.TemporaryDirectory(prefix="couplet-modes-") as name:
    folder = pathlib.Path(name)
    for file in ("bracket.geo", "solid.yaml", "modal.yaml"):
        shutil.copy(configs / "bracket-modes" / file, folder)
    for program, case in (("solid_solver", "solid.yaml"), ("plate_modal", "modal.yaml")):
        subprocess.run([binaries / program, case, "--set", "simulation.end-time=5 ms"], cwd=folder, check=True,
                       stdout=subprocess.DEVNULL)
    volumes, modes = (motion(folder / out / "bracket/probes.csv") for out in ("out", "out-modal"))
if len(volumes) != len(modes) or len(volumes) < 50:
    sys.exit(f"{len(volumes)} and {len(modes)} times")
size = max(abs(row[2]) for row in volumes)
apart = max(abs(a - b) for p, q in zip(volumes, modes) for a, b in zip(p[1:], q[1:]))
print(f"largest deflection {size:.4e} m, at most {100 * apart / size:.3f} % apart")
if not (size > 1e-5 and apart < 2e-3 * size):
    sys.exit("the modes move another way")
