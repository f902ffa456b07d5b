#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""scripts/couplet accuracy on the two coarsest meshes of a case. Usage: accuracy.py BUILD"""
import csv
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]

with tempfile.TemporaryDirectory() as folder:
    picture = pathlib.Path(folder) / "accuracy.png"
    result = subprocess.run([sys.executable, ROOT / "scripts/couplet", "accuracy", "cantilever", "--build", sys.argv[1], "--only", "direct",
                             "--meshes", "20x2x2", "40x4x4", "--picture", picture], capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr
    rows = list(csv.DictReader(open(picture.with_suffix(".csv"), newline="")))
    assert [row["mesh"] for row in rows] == ["20x2x2", "40x4x4"], rows
    errors = [float(row["relative error of the tip's displacement"]) for row in rows]
    assert 0.1 > errors[1] > 0 and errors[1] < 0.5 * errors[0], errors
    assert all(0 < float(row["wall [s]"]) < 60 and 20 < float(row["memory [MB]"]) < 2000 for row in rows), rows
    assert picture.stat().st_size > 10_000
wrong = subprocess.run([sys.executable, ROOT / "scripts/couplet", "accuracy", "nothing"], capture_output=True, text=True)
assert wrong.returncode != 0 and "Cases that have one: " in wrong.stderr and "cantilever" in wrong.stderr, wrong.stderr
