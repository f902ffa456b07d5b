#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Messages, bytes, reductions and waits of each program per step, by number of ranks, counted in MPI's profiling interface (counts.cpp).
Each scene runs with two numbers of steps; per step is the difference over the extra steps, so that start-up and end cancel.
Usage: benchmarks/scaling/counts.py [SCENE ...] [--ranks 1 2 4 8 16] [--build build] [--case FILE --steps 3 6 --set A=B ...] [--write]
  SCENE    fluid, solid, mover, flap (coupled; each participant gets the ranks); all but the flap if none is named
  --case   any case instead; its time step must be `simulation.time-step`
  --write  counts.json beside this file, which model.py reads
Exit code 1 if a bar is missed: no gather or scatter in a step; no rank of eight or more with messages to all others; messages to each neighbour bounded by the iterations; reductions of
each iteration the same on any number of ranks. More ranks than cores change no count (only the waits)."""
import argparse
import csv
import dataclasses
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import yaml

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "client/python"))
from couplet.runs import Case, environment, launch  # noqa: E402

F, S, M = "participants.fluid.", "participants.solid.", "participants.mover."
LOAD = S + 'boundaries.tip.value=[0, "125*t", 0]'  # grows, so that each step has something to solve


@dataclasses.dataclass
class Scene:
    case: str
    steps: tuple           # of the short and the long run
    sets: tuple = ()
    cells: int = 0         # of the case, for model.py
    dimension: int = 2
    scratch: pathlib.Path = None


SCENES = {
    "fluid": Scene("configs/cavity/case.yaml", (5, 15), cells=64 * 64),
    "solid": Scene("configs/cantilever/case.yaml", (2, 5), (LOAD,), 80 * 8 * 8, 3),
    "mover": Scene("configs/moving-mesh/case.yaml", (2, 4), cells=2600),
    "flap": Scene("configs/perpendicular-flap/case.yaml", (2, 5)),
}
GATHERS = ("gather", "scatter")                  # what a root collects or hands out grows with the ranks
EVERYWHERE = ("allgather", "alltoall")           # what every rank gets grows with the ranks
REDUCTIONS = ("allreduce", "reduce", "scan", "reduce_scatter", "barrier", "bcast")


def library(folder):
    file = pathlib.Path(folder) / "libcounts.so"
    if not file.exists():
        subprocess.run(["mpicxx", "-std=c++20", "-O1", "-shared", "-fPIC", HERE / "counts.cpp", "-o", file], check=True)
    return file


def counted(command, folder, counter, timeout=1200):
    """Returns [tally of each rank of the job] of one run."""
    folder.mkdir(parents=True)
    if command[0] != "mpirun":
        command = ["mpirun", "--oversubscribe", "-n", 1, *command]
    launch(command, folder / "run.log", None, timeout, {
        **environment(), "OMPI_MCA_mca_base_env_list": f"LD_PRELOAD={counter};COUPLET_COUNTS={folder}"})
    files = sorted(folder.glob("[0-9]*.json"), key=lambda f: int(f.stem))
    return [json.loads(f.read_text()) for f in files]


def steps_of(folder, fewer):
    """Mean iterations of linear solvers and seconds of the extra steps, by participant; of those without a record none."""
    found = {}
    for file in folder.glob("*/steps.csv"):
        rows = list(csv.DictReader(file.open()))[fewer:]
        mean = lambda key: sum(float(row[key]) for row in rows) / len(rows)  # noqa: E731
        found[file.parent.name] = (mean("iterations"), mean("seconds [s]"))
    return found


def difference(short, long, extra, programs):
    """Returns the work of one rank per step; neighbors are those of its own program. `programs`: of each rank of the job."""
    peers = {p: (n - short["peers"].get(p, 0)) / extra for p, n in long["peers"].items()}
    kinds = {k: (n - short["collectives"].get(k, 0)) / extra for k, n in long["collectives"].items()}
    each = {k: (long[k] - short[k]) / extra for k in ("bytes", "waited", "in_collectives")}
    return {**each, "messages": sum(peers.values()), "neighbours": sum(n > 0 and programs[int(p)] == long["program"] for p, n in peers.items()),
            "most_to_one": max(peers.values(), default=0), "collectives": {k: n for k, n in kinds.items() if n}}


def row_of(scene, program, ranks, tallies, iterations, seconds):
    """The most of any rank; gathers and reductions are the same on all of a communicator."""
    most = {k: max(t[k] for t in tallies) for k in ("messages", "bytes", "neighbours", "most_to_one", "waited", "in_collectives")}
    kinds = {k: max(t["collectives"].get(k, 0) for t in tallies) for t in tallies for k in t["collectives"]}
    kinds = {k: max(t["collectives"].get(k, 0) for t in tallies) for k in sorted(kinds)}
    total = lambda names: sum(kinds.get(name, 0) for name in names)  # noqa: E731
    return {"scene": scene, "program": program, "ranks": ranks, **most, "iterations": iterations, "seconds": seconds,
            "reductions": total(REDUCTIONS), "gathers": total(GATHERS), "everywhere": total(EVERYWHERE), "collectives": kinds}


def measure(name, scene, ranks, build, scratch):
    """The rows of one scene on one number of ranks: one of each program."""
    case = Case(ROOT / scene.case, build)
    dt = float(str(yaml.safe_load((ROOT / scene.case).read_text())["simulation"]["time-step"]).split()[0])
    runs, names = [], list(case.participants)
    for steps in scene.steps:
        folder = scratch / f"{name}-{ranks}-{steps}"
        command = case.command({"simulation.output.folder": str(folder / "out")}, ranks=dict.fromkeys(names, ranks),
                               raw=(*scene.sets, f"simulation.end-time={steps * dt!r}"))
        runs.append(counted(command, folder, library(scratch)))
    extra = scene.steps[1] - scene.steps[0]
    reported = steps_of(folder / "out", scene.steps[0])
    if len(runs[0]) != len(runs[1]) or len(runs[1]) < ranks:
        raise RuntimeError(f"{name} on {ranks} ranks: {len(runs[0])} and {len(runs[1])} ranks wrote their counts")
    by_program = {}
    programs = [tally["program"] for tally in runs[1]]
    for short, long in zip(*runs):
        by_program.setdefault(long["program"], []).append(difference(short, long, extra, programs))
    of = {case.participants[n]["program"]: n for n in names}
    return [row_of(name, program, len(tallies), tallies, *reported.get(of.get(program), (0, 0))) for program, tallies in by_program.items()]


def failures(rows):
    """The bars that these rows miss, in words. Reductions and messages go with the iterations of the solvers, which are divided out."""
    found = []
    for program in dict.fromkeys((r["scene"], r["program"]) for r in rows):
        own = sorted((r for r in rows if (r["scene"], r["program"]) == program and r["ranks"] > 1), key=lambda r: r["ranks"])
        for row in own:
            first, label = own[0], f"{row['program']} on {row['ranks']} ranks"
            work = max(1, row["iterations"]) / max(1, first["iterations"])
            if row["gathers"]:
                found.append(f"{label}: {row['gathers']:g} gathers or scatters per step")
            if row["ranks"] >= 8 and row["neighbours"] == row["ranks"] - 1:
                found.append(f"{label}: a rank exchanges messages with all others")
            if row["most_to_one"] > 2 * max(1, work) * first["most_to_one"] + 2:
                found.append(f"{label}: {row['most_to_one']:g} messages to one neighbour per step, {first['most_to_one']:g} on {first['ranks']} ranks")
            if row["reductions"] > 1.1 * max(1, work) * first["reductions"] + 2:
                found.append(f"{label}: {row['reductions']:g} reductions per step, {first['reductions']:g} on {first['ranks']} ranks")
    return found


HEAD = ("scene", "program", "ranks", "iterations", "messages", "to one", "bytes", "neighbours", "reductions", "gathers", "all-gathers", "waits [s]")


def line(row):
    numbers = [row[k] for k in ("iterations", "messages", "most_to_one", "bytes", "neighbours", "reductions", "gathers", "everywhere")]
    cells = [row["scene"], row["program"], str(row["ranks"]), *(f"{n:.0f}" if abs(n - round(n)) < 0.05 or n > 100 else f"{n:.1f}" for n in numbers),
             f"{row['waited'] + row['in_collectives']:.4f}"]
    return "| " + " | ".join(cells) + " |"


def table(rows):
    return "\n".join(["| " + " | ".join(HEAD) + " |", "|" + "---|" * len(HEAD), *map(line, rows)])


def scan(scenes, ranks, build, say=lambda rows: None):
    """Rows of all scenes on all numbers of ranks; `say` is told of all rows so far after each."""
    rows = []
    with tempfile.TemporaryDirectory(prefix="couplet-counts-") as scratch:
        for name, scene in scenes.items():
            for n in ranks:
                for row in measure(name, scene, n, build, pathlib.Path(scratch)):
                    row.update(cells=scene.cells, dimension=scene.dimension)
                    rows.append(row)
                    say(rows)
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2, 4, 8, 16])
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    parser.add_argument("--case")
    parser.add_argument("--steps", type=int, nargs=2, default=(3, 6))
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    unknown = set(arguments.scenes) - set(SCENES)
    if unknown:
        parser.error(f"unknown scene {', '.join(sorted(unknown))}; known: {', '.join(SCENES)}")
    if min(arguments.ranks) < 1 or arguments.steps[1] <= arguments.steps[0] or arguments.steps[0] < 1:
        parser.error("ranks must be at least 1, and the second number of --steps larger than the first")
    scenes = {n: SCENES[n] for n in arguments.scenes or ("fluid", "solid", "mover")}
    if arguments.case:
        scenes = {pathlib.Path(arguments.case).resolve().parent.name: Scene(os.path.abspath(arguments.case), tuple(arguments.steps), tuple(arguments.set))}

    def say(rows):
        print(line(rows[-1]), flush=True)
        if arguments.write:
            (HERE / "counts.json").write_text("[\n" + ",\n".join(json.dumps(row) for row in rows) + "\n]\n")
    print(table([]))
    rows = scan(scenes, arguments.ranks, arguments.build.resolve(), say)
    wrong = failures(rows)
    print("\n" + ("\n".join(wrong) if wrong else "in order"))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
