#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Limit cycles of FSI2 and FSI3 on their coarse meshes and the first opening of the reed valve, beside cycles.json: a change of an operator that moves a
benchmark cannot pass unseen. A commit that records them anew says in its message why they moved.

  cycles.py record  [--bin FOLDER] [NAME ...]   runs the cases whole and writes their figures
  cycles.py compare [--bin FOLDER] [NAME ...]   runs them and fails where a figure differs by more than half a percent"""
import argparse
import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import golden  # noqa: E402

sys.path[:0] = [str(golden.ROOT / "client/python"), str(golden.ROOT / "configs/turek-hron")]
import summary  # noqa: E402
from couplet.runs.results import read_csv  # noqa: E402

FILE = golden.HERE / "cycles.json"
WITHIN = 0.005
SECONDS = 1800


def cycle(folder):
    found = summary.summary(folder)
    return {name: found[name] for name in ("uy_amp", "uy_f", "drag_mean", "lift_harmonic")}


def opening(folder):
    probes = read_csv(folder / "reed/probes.csv")
    return {name: float(max(values)) for name, values in probes.items() if name.endswith("z [m]")}


CASES = {"FSI2": ("turek-hron/fsi2.yaml", 14, cycle), "FSI3": ("turek-hron/case.yaml", 10, cycle), "valve": ("reed-valve/case.yaml", 12e-3, opening)}


def figures(name, binaries):
    case, end, read = CASES[name]
    with tempfile.TemporaryDirectory() as folder:
        code, text = golden.run(case, binaries, folder, end=end, seconds=SECONDS)
        if code not in (0, 4):
            sys.exit(f"{name}: exit code {code}\n{text}")
        return read(pathlib.Path(folder))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("task", choices=["record", "compare"])
    parser.add_argument("--bin", type=pathlib.Path, default=golden.ROOT / "build/bin")
    parser.add_argument("names", nargs="*", choices=[[], *CASES])
    args = parser.parse_intermixed_args()
    kept, apart = json.loads(FILE.read_text()) if FILE.is_file() else {}, 0
    for name in args.names or CASES:
        found = figures(name, args.bin)
        if args.task == "record":
            kept[name] = found
        for key, value in found.items():
            right = kept[name][key]
            bad = not abs(value - right) <= WITHIN * abs(right)
            apart += bad
            print(f"{name} {key}: {value:.6g}, recorded {right:.6g}{' DIFFERS' if bad else ''}", flush=True)
    if args.task == "record":
        FILE.write_text(json.dumps(kept, indent=1, sort_keys=True) + "\n")
    return int(apart > 0)


if __name__ == "__main__":
    sys.exit(main())
