#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Instructions of a few runs beside those of an older commit, counted by valgrind, and seconds of steps in alternating turns.

  git worktree add --detach ../older COMMIT, and build its programs there
  pairs.py run ../older [--build BUILD] [--only NAME]   prints ratios and keeps them in BUILD/pairs.json
  pairs.py time ../older [--build BUILD] [--only NAME]  the same by processor seconds, three turns of both
  pairs.py write [--build BUILD]                        docs/validation/pairs.md from that file

Both commits run their own case files with the same settings. Two runs of different length are made of each: their difference has the instructions of
steps, without those of the start. A run of one step counts as a whole. Instructions inside MPI are left out, since a process that waits polls."""
import argparse
import datetime
import importlib.machinery
import json
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "client/python"))
from couplet.runs.process import launch as launched  # noqa: E402

PAGE = ROOT / "docs/validation/pairs.md"
MPI = re.compile(r"libmpi|libopen-|/mca_|libpmix|libevent|libuc[pst]|libfabric|libhwloc")
FLUID, SOLID = "participants.fluid.", "participants.solid."
CASES = {  # name: programs, folder of the case, seconds of a step, numbers of steps, settings
    "flagship": (("coupler", "fluid_solver", "solid_solver", "mesh_mover"), "perpendicular-flap", 0.01, (2, 6), ()),
    "cavity 128^2": (("fluid_solver",), "cavity", 0.005, (2, 12), (FLUID + "mesh-parameters={n: 128}", "simulation.time-step=0.005 s")),
    "cavity 64^3": (("fluid_solver",), "cavity-3d", 0.1, (1, 3), (FLUID + "mesh-parameters={n: 64}", "simulation.time-step=0.1 s")),
    "plate B, 16x24x12": (("solid_solver",), "elliptic-plate", 1, (1,), ()),
    "plate B, 32x48x24": (("solid_solver",), "elliptic-plate", 1, (1,), (SOLID + "mesh-parameters={nr: 32, nt: 48, nz: 24, shape: 0}",)),
    "tank, a day": (("thermocline",), "thermocline-andasol", 86400, (2, 7), ("participants.tank.report.run-in=0 s",)),
}
TURNS = 3
SECTION = """n = {n};
Point(1) = {{0, 0, 0}}; Point(2) = {{20, 0, 0}}; Point(3) = {{20, 2, 0}}; Point(4) = {{0, 2, 0}};
Line(1) = {{1, 2}}; Line(2) = {{2, 3}}; Line(3) = {{3, 4}}; Line(4) = {{4, 1}};
Transfinite Curve {{1, 3}} = 10 * n + 1; Transfinite Curve {{2, 4}} = n + 1;
Curve Loop(1) = {{1:4}}; Plane Surface(1) = {{1}}; Transfinite Surface {{1}}; Recombine Surface {{1}};
Physical Curve("root") = {{4}}; Physical Curve("tip") = {{2}}; Physical Curve("sides") = {{1, 3}}; Physical Surface("beam") = {{1}};
"""
PLANE = """simulation: {{name: plane, end-time: {end} s, time-step: 0.1 s, output: {{folder: out, interval: 0}}}}
participants:
  solid:
    program: solid_solver
    mesh: section.geo
    dimension: 2
    plane: strain
    material: {{density: 2600, youngs-modulus: 10 MPa, poissons-ratio: 0.3}}
    time-scheme: {{type: trapezoidal}}
    boundaries:
      root: {{type: fixed-displacement, value: [0, 0]}}
      tip: {{type: traction, value: [0, "t <= 7 ? -125*t/7 : 0"]}}
      sides: {{type: free}}
"""


def cavity(n, dimension, dt):
    """The cavity that benchmarks/fluid times."""
    case = importlib.machinery.SourceFileLoader("fluid", str(ROOT / "benchmarks/fluid")).load_module().cavity_case

    def command(_, build, folder, steps):
        case(folder, dimension, n, dt, steps, 1e-6)
        return build / "bin/fluid_solver", "case.yaml"
    return command


def beam(*sizes):
    def command(tree, build, folder, steps):
        sets = (SOLID + "mesh-parameters={n_length: %d, n_side: %d}" % sizes, f"simulation.end-time={0.1 * steps!r} s", "simulation.output.interval=0",
                f"simulation.output.folder={folder}/out")
        return build / "bin/solid_solver", tree / "configs/vibrating-cantilever/case.yaml", *(f"--set={s}" for s in sets)
    return command


def section(n):
    """A beam of 10 n x n quadrilaterals."""
    def command(_, build, folder, steps):
        (folder / "section.geo").write_text(SECTION.format(n=n))
        (folder / "case.yaml").write_text(PLANE.format(end=0.1 * steps))
        return build / "bin/solid_solver", "case.yaml"
    return command


TIMED = {  # name: function that writes the case of so many steps and gives its command, two numbers of steps
    "cavity 128^2": (cavity, (128, 2, 0.004), (20, 320)),
    "cavity 64^3": (cavity, (64, 3, 0.008), (5, 35)),
    "oscillating cylinder, 24 000 cells": (None, (), ()),
    "beam, 1280 hexahedra": (beam, (80, 4), (1, 201)),
    "beam, 5120 hexahedra": (beam, (80, 8), (1, 61)),
    "beam, 98 304 hexahedra": (beam, (384, 16), (1, 6)),
    "beam, 1000 quadrilaterals": (section, (10,), (1, 2001)),
    "beam, 10 240 quadrilaterals": (section, (32,), (1, 151)),
    "beam, 100 000 quadrilaterals": (section, (100,), (1, 16)),
}


def seconds(tree, build, name, folder):
    """Processor seconds of a step: of two runs the difference, of the cylinder what its test says."""
    make, sizes, counts = TIMED[name]
    if make is None:
        launched([build / "tests/speed/fluid/speed_fluid", "--gtest_filter=*/0", "--gtest_output=json:result.json"], folder / "log", folder)
        (test,) = (t for t in json.loads((folder / "result.json").read_text())["testsuites"][0]["testsuite"] if "cells" in t)
        return float(test["cells"]) / float(test["cells_steps_per_second"])
    few, many = (launched(make(*sizes)(tree, build, folder, n), folder / "log", folder).cpu for n in counts)
    return (many - few) / (counts[1] - counts[0])


def time(arguments):
    file, known = kept(arguments)
    both = (arguments.older, arguments.older / "build"), (ROOT, arguments.build)
    for name in TIMED:
        if arguments.only in name:
            with tempfile.TemporaryDirectory(prefix="couplet-pairs-") as folder:
                for pair in both:  # meshes
                    seconds(*pair, name, pathlib.Path(folder))
                turns = [[seconds(*pair, name, pathlib.Path(folder)) for pair in both] for _ in range(TURNS)]
            known.setdefault("seconds", {})[name] = {"commits": [revision(arguments.older), revision(ROOT)], "turns": turns}
            file.write_text(json.dumps(known, indent=1))
            print(timed_row(name, known["seconds"][name]), flush=True)


def timed_row(name, entry):
    old, new = (statistics.median(turn[k] for turn in entry["turns"]) for k in (0, 1))
    ratios = sorted(turn[1] / turn[0] for turn in entry["turns"])
    return f"| {name} | {1e3 * old:.3g} | {1e3 * new:.3g} | {statistics.median(ratios):.2f} ({ratios[0]:.2f} to {ratios[-1]:.2f}) | {' '.join(entry['commits'])} |"


def counted(file):
    """Instructions of a profile outside of MPI. Lines of cost stand below their function; the line after `calls=` repeats what is counted elsewhere."""
    names, here, total, called = {}, "", 0, False
    with open(file, errors="replace") as lines:
        for line in lines:
            if line.startswith("ob="):
                number, _, name = line[3:].strip().partition(" ")
                here = names.setdefault(number, name or number)
            elif line.startswith("calls="):
                called = True
            elif line[0] in "+-*0123456789":
                total += 0 if called or MPI.search(here) else int(line.split()[-1])
                called = False
    return total


def launch(programs, case, folder, sets):
    words = ["--allow-commands", *(f"--set={s}" for s in sets)]  # gmsh's sandbox does not start under valgrind
    parts = [[":", "-n", "1", "valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/{p.name}.count", str(p), str(case), *words] for p in programs]
    with open(folder / "log", "w") as log:
        line = ["mpirun", "--oversubscribe", "--bind-to", "none", *[w for part in parts for w in part][1:]]
        code = subprocess.run(line, stdout=log, stderr=log, cwd=folder, timeout=3600).returncode
    if code not in (0, 4):
        raise SystemExit(f"exit code {code}:\n" + (folder / "log").read_text()[-2000:])
    return {p.name: counted(folder / f"{p.name}.count") for p in programs}


def instructions(tree, build, name):
    """By program: of a step, or of the run if it has one step."""
    programs, case, step, counts, sets = CASES[name]
    with tempfile.TemporaryDirectory(prefix="couplet-pairs-") as temporary:
        folder, found = pathlib.Path(temporary), []
        shutil.copytree(tree / "configs" / case, folder / case)
        (folder / "weather").symlink_to(tree / "configs/weather")
        places = [build / "bin" / p for p in programs]
        for n in counts:
            more = (f"simulation.output.folder={folder}/out", f"simulation.end-time={n * step!r} s", "simulation.output.interval=1000 day")
            found.append(launch(places, folder / case / "case.yaml", folder, (*sets, *more)))
        if len(counts) == 1:
            return found[0]
        return {p: (found[1][p] - found[0][p]) / (counts[1] - counts[0]) for p in programs}


def kept(arguments):
    file = arguments.build / "pairs.json"
    return file, json.loads(file.read_text()) if file.exists() else {}


def revision(tree):
    return subprocess.run(["git", "-C", tree, "rev-parse", "--short=8", "HEAD"], capture_output=True, text=True, check=True).stdout.strip()


def run(arguments):
    file, known = kept(arguments)
    for name in CASES:
        if arguments.only in name:
            old, new = (instructions(tree, build, name) for tree, build in ((arguments.older, arguments.older / "build"), (ROOT, arguments.build)))
            known[name] = {"commits": [revision(arguments.older), revision(ROOT)], "counts": {p: [old[p], new[p]] for p in old}}
            file.write_text(json.dumps(known, indent=1))
            print("\n".join(rows_of(name, known[name])), flush=True)


def rows_of(name, entry):
    pairs = dict(entry["counts"])
    if len(pairs) > 1:
        pairs["all"] = [sum(c) for c in zip(*pairs.values())]
    what = "a step" if len(CASES[name][3]) > 1 else "the run"
    return [f"| {name} | {p} | {what} | {old / 1e6:.1f} | {new / 1e6:.1f} | {new / old - 1:+.1%} | {' '.join(entry['commits'])} |" for p, (old, new) in pairs.items()]


def write(arguments):
    _, known = kept(arguments)
    lines = [row for name in CASES if name in known for row in rows_of(name, known[name])]
    timed = known.get("seconds", {})
    lines += ["", f"Processor milliseconds per step, as medians of {TURNS} turns of both commits, written by `benchmarks/pairs.py time` and `write`. The ratio is the median of the",
              "ratios of the turns, with minimum and maximum in parentheses.", "", "| case | before | now | ratio of now to before | commits |", "|---|---|---|---|---|",
              *(timed_row(name, timed[name]) for name in TIMED if name in timed)] if timed else []
    note = PAGE.read_text().partition("\n## ")[2] if PAGE.exists() else ""
    PAGE.write_text(f"# Instructions compared with an older commit\n\n**Counted on {datetime.date.today()}.** This page was written by `benchmarks/pairs.py write`. The numbers are millions of instructions of one process each, counted by valgrind, without those inside MPI.\n\n"
                    "| case | program | unit | before | now | change | commits |\n|---|---|---|---|---|---|---|\n" + "\n".join(lines) + "\n" + (f"\n## {note}" if note else ""))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("run", "time", "write"))
    parser.add_argument("older", type=pathlib.Path, nargs="?")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()
    arguments.build, arguments.older = arguments.build.resolve(), arguments.older and arguments.older.resolve()
    {"run": run, "time": time, "write": write}[arguments.what](arguments)


if __name__ == "__main__":
    main()
