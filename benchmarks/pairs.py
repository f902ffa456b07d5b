#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Instructions of a few runs beside those of an older commit, counted by valgrind.

  git worktree add --detach ../older COMMIT, and build its programs there
  pairs.py run ../older [--build BUILD] [--only NAME]   prints ratios and keeps them in BUILD/pairs.json
  pairs.py write [--build BUILD]                        docs/validation/pairs.md from that file

Both commits run their own case files with the same settings. Two runs of different length are made of each: their difference has the instructions of
steps, without those of the start. A run of one step counts as a whole. Instructions inside MPI are left out, since a process that waits polls."""
import argparse
import json
import pathlib
import re
import shutil
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs/validation/pairs.md"
MPI = re.compile(r"libmpi|libopen-|/mca_|libpmix|libevent|libuc[pst]|libfabric|libhwloc")
FLUID, SOLID = "participants.fluid.", "participants.solid."
CASES = {  # name: programs, folder of the case, seconds of a step, numbers of steps, settings
    "flagship": (("coupler", "fluid_solver", "solid_solver", "mesh_mover"), "perpendicular-flap", 0.01, (2, 6), ()),
    "cavity 128^2": (("fluid_solver",), "cavity", 0.005, (2, 12), (FLUID + "mesh-parameters={n: 128}", "simulation.time-step=0.005 s")),
    "cavity 64^3": (("fluid_solver",), "cavity-3d", 0.1, (1, 3), (FLUID + "mesh-parameters={n: 64}", "simulation.time-step=0.1 s")),
    "plate B, 16x24x12": (("solid_solver",), "elliptic-plate", 1, (1,), ()),
    "plate B, 32x48x24": (("solid_solver",), "elliptic-plate", 1, (1,), (SOLID + "mesh-parameters={nr: 32, nt: 48, nz: 24, shape: 0}",)),
}


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
        places = [build / "bin" / p for p in programs]
        for n in counts:
            more = (f"simulation.output.folder={folder}/out", f"simulation.end-time={n * step!r} s", "simulation.output.interval=1000 s")
            found.append(launch(places, folder / case / "case.yaml", folder, (*sets, *more)))
        if len(counts) == 1:
            return found[0]
        return {p: (found[1][p] - found[0][p]) / (counts[1] - counts[0]) for p in programs}


def run(arguments):
    file = arguments.build / "pairs.json"
    known = json.loads(file.read_text()) if file.exists() else {}
    revision = lambda tree: subprocess.run(["git", "-C", tree, "rev-parse", "--short=8", "HEAD"], capture_output=True, text=True, check=True).stdout.strip()  # noqa: E731
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
    known = json.loads((arguments.build / "pairs.json").read_text())
    lines = [row for name in CASES if name in known for row in rows_of(name, known[name])]
    note = PAGE.read_text().partition("\n## ")[2] if PAGE.exists() else ""
    PAGE.write_text("# Instructions beside an older commit\n\nWritten by `benchmarks/pairs.py write`. Millions of instructions, counted by valgrind, of one process each and without those inside MPI.\n\n"
                    "| case | program | of | before | now | change | commits |\n|---|---|---|---|---|---|---|\n" + "\n".join(lines) + "\n" + (f"\n## {note}" if note else ""))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("run", "write"))
    parser.add_argument("older", type=pathlib.Path, nargs="?")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()
    arguments.build, arguments.older = arguments.build.resolve(), arguments.older and arguments.older.resolve()
    {"run": run, "write": write}[arguments.what](arguments)


if __name__ == "__main__":
    main()
