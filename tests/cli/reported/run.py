#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the inputs of cases.yaml, which went wrong when users brought their problems to the programs. Each must end with the right value, or the right refusal.
Usage: run.py BIN [I/N] [WORD ...]   (with I/N: every N-th run from the I-th on; with words: only the cases whose name has one of them)"""
import csv
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

import yaml

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parents[1] / "support"))
from checks import check, end, mpmd, share  # noqa: E402

programs = pathlib.Path(sys.argv[1]).resolve()
WAYS = {"last": lambda v: v[-1], "largest": max, "least": min, "spread": lambda v: (max(v) - min(v)) / max(map(abs, v))}


def number(folder, text):
    """'FILE.csv: WAY COLUMN' of the output, or the part of the error: 'solid/run.json: mesh'."""
    file, what = text.split(": ", 1)
    if file.endswith(".json"):
        return json.loads((folder / "out" / file).read_text())["errors"][what]
    way, column = what.split(" ", 1)
    with open(folder / "out" / file, newline="") as rows:
        return WAYS[way]([float(row[column]) for row in csv.DictReader(rows)])


def run(name, case, sets):
    with tempfile.TemporaryDirectory(prefix="couplet-reported-") as temporary:
        folder = pathlib.Path(temporary) / "case"
        shutil.copytree(here, folder, ignore=shutil.ignore_patterns("*.py", "*.cache.*"))
        *names, file = case["run"].split()
        words = [file, *(f"--set={s}" for s in [*sets, "simulation.output.folder=out"]), *case.get("words", "").split()]
        parts = [[programs / program, *words] for program in names]
        line = mpmd(parts) if len(parts) > 1 else [*case.get("start", "").split(), *map(str, parts[0])]
        done = subprocess.run(line, cwd=folder, capture_output=True, text=True, timeout=250)
        said = done.stdout + done.stderr
        wrong = [f"exit code {done.returncode} instead of {case['code']}"] if done.returncode != case["code"] else []
        wrong += [f"does not say '{text}'" for text in case.get("says", []) if text not in " ".join(said.split())]
        wrong += [f"says '{text}'" for text in case.get("silent", []) if text in said]
        found = []
        for text, (wanted, within) in case.get("numbers", {}).items() if not wrong else ():
            found.append(number(folder, text))
            wrong += [] if abs(found[-1] - wanted) <= within else [f"{text} is {found[-1]:.6g} instead of {wanted:g}"]
        check(f"{name}{' ' if sets else ''}{' '.join(sets)}", not wrong, "; ".join(wrong) + said[-1500:] if wrong else " ".join(f"{v:.6g}" for v in found))


cases, words = yaml.safe_load((here / "cases.yaml").read_text()), sys.argv[2:]
for name, sets in share([(name, sets) for name, case in cases.items() for sets in case.get("each", [[]])], words):
    if not words or any(word in name for word in words):
        run(name, cases[name], [*cases[name].get("sets", []), *([sets] if isinstance(sets, str) else sets)])
end()
