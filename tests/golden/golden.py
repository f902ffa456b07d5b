#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Golden file of the shipped cases: what each ends with, so that a change of the code that should change no answer can prove it.

  golden.py record  [--bin FOLDER] [CASE ...]   runs the cases and writes them to golden.json; others stay
  golden.py compare [--bin FOLDER] [CASE ...]   runs them and lists what differs from golden.json; with --quick only those that took
                                                less than QUICK seconds when they were recorded
  golden.py resume  [--bin FOLDER] [CASE ...]   runs them whole, and again from a checkpoint in their middle; lists what differs

A CASE is a file below configs, such as cavity/case.yaml, or the name of a folder there, for all its cases. Cases run for at most
STEPS of their steps. Recorded are the exit code, each participant's findings, error budget and place on the maps (run.json), and
the last row of each of its tables. A commit that records a case anew says in its message why the case moved."""
import argparse
import csv
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

import yaml

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
STEPS = 24
QUICK = 1  # second
SECONDS = 240  # limit of one run
NOT_RESULTS = {"steps.csv", "participants.csv", "residuals.csv", "solver.csv"}  # of time and iterations
TOLERANCE = 1e-5  # relative; iterative solvers leave 1e-8 to 1e-6
ROUNDING = 1e-8  # errors and numbers of findings below are made of rounding


def cases():
    """The shipped cases, with the time in seconds of their first STEPS steps and their own end."""
    sys.path.insert(0, str(ROOT / "client/python"))
    for path in sorted((ROOT / "configs").glob("*/*.yaml")):
        data = yaml.safe_load(path.read_text())
        if "participants" in data:
            yield path.relative_to(ROOT / "configs").as_posix()


def chosen(names):
    """The shipped cases of these names, all of them without names, and files of other folders as they are."""
    shipped = list(cases())
    found = [case for name in names for case in ([name] if pathlib.Path(name).is_absolute() else
             [one for one in shipped if name in (one, one.partition("/")[0])] or sys.exit(f"golden.py: configs has no case '{name}'"))]
    return found or shipped


def seconds(value):
    """'0.1 ms' in seconds."""
    number, _, unit = str(value).partition(" ")
    return float(number) * {"": 1, "s": 1, "ms": 1e-3, "us": 1e-6, "min": 60, "h": 3600, "day": 86400}[unit]


def run(case, binaries, folder, *, end, every=None, restart=None, seconds=SECONDS):
    command = [sys.executable, "-m", "couplet", "run", "-q", "--bin", str(pathlib.Path(binaries).resolve()), "--set", f"simulation.output.folder={folder}",
               "--set", f"simulation.end-time={end!r} s", "--set", "simulation.output.interval=0 s"]
    if every:
        command += ["--set", f"simulation.checkpoint.interval={every!r} s", "--set", "simulation.checkpoint.keep=1000"]
    if restart:
        command += ["--restart", str(restart)]
    folder = pathlib.Path(folder)
    here = folder if folder.exists() else folder.parent  # programs of ours may write beside the results
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "client/python"), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    try:
        done = subprocess.run([*command, str(ROOT / "configs" / case)], env=environment, capture_output=True, text=True,
                              timeout=seconds, cwd=here)
        return done.returncode, (done.stdout + done.stderr)[-2000:]
    except subprocess.TimeoutExpired:
        return "timeout", ""


def value(text):
    try:
        return float(text)
    except ValueError:
        return text


def outcome(folder, code):
    result = {"exit code": code, "participants": {}}
    for report in sorted(pathlib.Path(folder).glob("*/run.json")):
        data = json.loads(report.read_text())
        one = {"findings": [[f["id"], f["severity"], f["number"]] for f in data["findings"]],
               "errors": {k: v for k, v in data["errors"].items() if isinstance(v, float | int)},
               "place": {c["quantity"]: c["value"] for c in data["atlas"]}, "tables": {}}
        for table in sorted(report.parent.rglob("*.csv")):
            if table.name in NOT_RESULTS:
                continue
            rows = [row for row in csv.reader(table.open()) if row and not row[0].startswith("#")]
            if rows:
                one["tables"][table.relative_to(report.parent).as_posix()] = [len(rows), [value(cell) for cell in rows[-1]]]
        result["participants"][report.parent.name] = one
    return result


def differences(a, b, where="", scale=0.):
    """Places where two outcomes differ; a row of a table is compared with its largest number."""
    if isinstance(a, dict) and isinstance(b, dict):
        return [d for key in sorted({*a, *b}) for d in differences(a.get(key), b.get(key), f"{where}/{key}")]
    if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        numbers = [abs(x) for x in a[1:] if isinstance(x, float) and math.isfinite(x)]
        return [d for k, (x, y) in enumerate(zip(a, b)) for d in differences(x, y, f"{where}[{k}]", max(numbers, default=0))]
    if isinstance(a, float | int) and isinstance(b, float | int) and not isinstance(a, bool):
        if a == b or (math.isnan(a) and math.isnan(b)) or abs(a - b) <= TOLERANCE * max(abs(a), abs(b), 1e-3 * scale):
            return []
    return [] if a == b else [f"{where}: {a} and {b}"]


def whole(case, binaries, folder, checkpoints=False):
    data = yaml.safe_load((ROOT / "configs" / case).read_text())
    simulation = data.get("simulation", {})
    step, end = seconds(simulation.get("time-step", "1 s")), seconds(simulation["end-time"])
    steps = min(STEPS, max(1, round(end / step)))
    end = min(end, steps * step)
    middle = max(1, steps // 2)
    code, text = run(case, binaries, folder, end=end, every=step if checkpoints else None)
    return outcome(folder, code), end, middle, text


def record(args):
    shipped, recorded = set(cases()), json.loads(args.file.read_text()) if args.file.is_file() else {}
    golden = {case: one for case, one in recorded.items() if case in shipped}
    for case in args.cases:
        start = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            golden[case] = whole(case, args.bin, folder)[0]
        golden[case]["seconds"] = round(time.monotonic() - start, 1)
        print(case, golden[case]["exit code"], f'{golden[case]["seconds"]} s', flush=True)
        args.file.write_text(json.dumps(golden, indent=0, sort_keys=True) + "\n")
    return 0


def answers(outcome):
    """Without the time, and what tells of rounding and iterative solvers only: their part of the error, and their iterations."""
    outcome.pop("seconds", None)
    for one in outcome["participants"].values():
        one["errors"] = {part: error for part, error in one["errors"].items() if part != "linear" and error > ROUNDING}
        one["findings"] = [[*name, number if (number or 0) > ROUNDING else None] for *name, number in one["findings"]]
        one["tables"].pop("solver.csv", None)
        if len(one["tables"].get("balance.csv", [0, []])[1]) == 10:  # of a fluid; the last column counts iterations
            one["tables"]["balance.csv"][1].pop()
    return outcome


def compare(args):
    golden, bad = json.loads(args.file.read_text()), 0
    for case in args.cases:
        if case not in golden:
            bad += 1
            print(case, f"is not recorded: golden.py record {case}", flush=True)
            continue
        if golden[case]["exit code"] == "timeout" or (args.quick and golden[case].get("seconds", 0) > QUICK):
            continue
        start = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            found, _, _, text = whole(case, args.bin, folder)
        apart = differences(answers(golden[case]), answers(found))
        bad += bool(apart)
        print(case, "same" if not apart else "DIFFERS", f"{time.monotonic() - start:.1f} s", flush=True)
        for line in apart[:12]:
            print("  ", line, flush=True)
        if found["exit code"] != golden[case]["exit code"]:
            print(text)
    return int(bad > 0)


def resume(args):
    bad = 0
    for case in args.cases:
        with tempfile.TemporaryDirectory() as folder:
            first, again = pathlib.Path(folder, "whole"), pathlib.Path(folder, "resumed")
            found, end, middle, _ = whole(case, args.bin, first, checkpoints=True)
            kept = sorted((first / "checkpoints").glob("step-*"))
            if found["exit code"] == "timeout" or len(kept) < 2:
                continue
            code, text = run(case, args.bin, again, end=end, restart=kept[min(middle, len(kept) - 1) - 1])
            resumed = outcome(again, code)
        for one in (found, resumed):  # what tables hold of a resumed run is under test elsewhere
            for participant in one["participants"].values():
                participant["tables"] = {}
        apart = differences(found, resumed)
        findings = sum(len(p["findings"]) for p in found["participants"].values())
        bad += bool(apart)
        print(case, f"{findings} findings", "same" if not apart else "DIFFERS", flush=True)
        for line in apart[:12]:
            print("  ", line, flush=True)
        if code != found["exit code"]:
            print(text)
    return int(bad > 0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("task", choices=["record", "compare", "resume"])
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/bin")
    parser.add_argument("--file", type=pathlib.Path, default=HERE / "golden.json")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("cases", nargs="*")
    args = parser.parse_intermixed_args()
    args.cases = chosen(args.cases)
    return {"record": record, "compare": compare, "resume": resume}[args.task](args)


if __name__ == "__main__":
    sys.exit(main())
