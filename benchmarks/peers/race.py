# SPDX-License-Identifier: Apache-2.0
"""What one run costs: whole process, started without mpirun, one core, in processor seconds (user and system: all
contenders run one thread, and other work on the machine disturbs these least). Plate of configs/elliptic-plate and vibrating
beam of configs/vibrating-cantilever with solid_solver; the plate with OpenFOAM's solidDisplacementFoam and CalculiX, the bent
beam with CalculiX."""
import pathlib
import shutil
import statistics
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "client/python"), str(ROOT / "benchmarks/peers")]
import calculix_beam  # noqa: E402
import calculix_plate  # noqa: E402
import openfoam_plate  # noqa: E402
import plate as geometry  # noqa: E402
from couplet.runs import Results, launch  # noqa: E402
from couplet import read_csv  # noqa: E402
from runs import foam_environment  # noqa: E402

METHODS = {  # keys of solution-method as in the thesis's table 3.1, and ours; its tolerance
    "S": "type: segregated, acceleration: none, face-gradient: thesis",
    "SA": "type: segregated, acceleration: aitken, face-gradient: thesis",
    "C": "type: block-coupled, linear-solver: bicgstab-ilu, face-gradient: thesis",
    "newton-krylov": "type: newton-krylov, preconditioner: multigrid, face-gradient: symmetric",
}


def cost(command, folder):
    """Returns the cost of a program and its output."""
    log = pathlib.Path(folder) / "race.log"
    taken = launch(command, log, folder, env=foam_environment())
    taken.output = log.read_text(errors="replace")
    return taken


def ours(job, case, sets, times=1):
    """solid_solver on configs/<case>: the median of so many runs as (Cost, output folder, iterations of all steps)."""
    folder = job.scratch / "race" / case
    folder.mkdir(parents=True, exist_ok=True)
    command = [job.build / "bin/solid_solver", job.root / "configs" / case / "case.yaml",
               f"--set=simulation.output.folder={folder / 'out'}", *(f"--set={s}" for s in sets)]
    runs = [cost(command, folder) for _ in range(times)]
    solver = read_csv(folder / "out/solid/solver.csv")
    median = statistics.median(r.cpu for r in runs)
    chosen = min(runs, key=lambda r: abs(r.cpu - median))
    chosen.report = Results(folder / "out").report("solid")
    return chosen, folder / "out", solver["iterations"]


def plate_sets(n, method, tolerance):
    return ["participants.solid.mesh-parameters={nr: %d, nt: %d, nz: %d, shape: 0}" % n,
            "participants.solid.solution-method={%s, relative-tolerance: %g, max-iterations: 20000}" % (method, tolerance)]


def our_plate(job, n, method, tolerance=1e-8, times=1):
    """Seconds, those of the solution alone (from the mesh in memory to the end), memory, iterations, cells, and the error of the displacement at the nine
    points. The mesh is made before the clock starts."""
    def make():
        job.once(("meshed", n), lambda: ours(job, "elliptic-plate", plate_sets(n, METHODS[method], 1e-2)))
        run, folder, iterations = ours(job, "elliptic-plate", plate_sets(n, METHODS[method], tolerance), times)
        return {"seconds": run.cpu, "memory": 1048576 * run.report["memory-all"], "iterations": int(iterations[-1]), "solution": run.report["wall"],
                "cells": n[0] * n[1] * n[2], "error": geometry.nine_points.errors(folder / "solid")[0]}
    return job.once(("our plate", n, method, tolerance, times), make)


def foam_plate(job, n, times=1):
    """solidDisplacementFoam; None where OpenFOAM is not installed."""
    program = shutil.which("solidDisplacementFoam")
    if not program:
        return None

    def make():
        folder = job.scratch / ("foam-%d-%d-%d" % n)
        openfoam_plate.write(folder, n, 1e-5, "GAMG", 0.9)
        runs = [cost([program], folder) for _ in range(times)]
        return {"seconds": statistics.median(r.cpu for r in runs), "error": openfoam_plate.plate_error(folder, n)}
    return job.once(("foam", n, times), make)


def calculix(job, n, element, solver, times=1):
    """CalculiX; None where it is not installed."""
    program = shutil.which("ccx")
    if not program:
        return None

    def make():
        folder = job.scratch / f"ccx-{element}-{n[0]}-{solver.split()[-1]}"
        folder.mkdir(parents=True, exist_ok=True)
        calculix_plate.write(folder / "plate.inp", n, element, solver)
        runs = [cost([program, "plate"], folder) for _ in range(times)]
        return {"seconds": statistics.median(r.cpu for r in runs), "error": calculix_plate.plate_error(folder / "plate.frd", n, element)}
    return job.once(("ccx", n, element, solver, times), make)


def our_beam(job, across, along, load):
    """Case E, Saint Venant-Kirchhoff, in one load step: (processor seconds of the whole process, deflection over the length, iterations)."""
    force = load * calculix_beam.CASE_E.young * 0.2**4 / 12 / (0.04 * 2.0**2) / 2**0.5
    sets = ["participants.solid.mesh-parameters={n: %d, m: %d}" % (across, along), "participants.solid.material.law=saint-venant-kirchhoff",
            f"participants.solid.boundaries.tip.value=[{force!r}*t, {force!r}*t, 0]"]
    run, folder, iterations = ours(job, "bent-beam", sets)
    tip = read_csv(pathlib.Path(folder) / "solid/probes.csv")
    return run.cpu, (tip["tip x [m]"][-1]**2 + tip["tip y [m]"][-1]**2)**0.5 / 2, iterations


def calculix_bent(job, across, along, load, element):
    """Runs the same case in CalculiX. Returns (processor seconds, deflection over the length), or None if it is not installed."""
    program = shutil.which("ccx")
    if not program:
        return None
    place = job.scratch / f"ccx-beam-{element}"
    place.mkdir(parents=True, exist_ok=True)
    calculix_beam.write(place / "beam.inp", across, along, element, load)
    seconds = cost([program, "beam"], place).cpu
    return seconds, calculix_beam.deflection(place / "beam.dat")


def bent_beam(job, across, along, load, times=3):
    """Case E by solid_solver and CalculiX, turn by turn: {who: (processor seconds of
    the whole process, the median; deflection over the length)}; CalculiX's are left out where it is not installed."""
    seconds, deflection = {}, {}
    for turn in range(times):
        for who in ("ours", "C3D8", "C3D8I"):
            found = our_beam(job, across, along, load)[:2] if who == "ours" else calculix_bent(job, across, along, load, who)
            if found:
                seconds.setdefault(who, []).append(found[0])
                deflection[who] = found[1]
    return {who: (statistics.median(s), deflection[who]) for who, s in seconds.items()}


def beam(job, method, tolerance=1e-7, step=0.01, steps=60, times=3, extra=()):
    """Seconds a time step of the vibrating beam (5120 cells): the difference of a long and a short run, the median of some."""
    def one(n):
        sets = ["participants.solid.solution-method={%s, relative-tolerance: %g, max-iterations: 20000}" % (method, tolerance),
                f"simulation.time-step={step}", f"simulation.end-time={n * step}", "simulation.output.interval=1000",
                "participants.solid.time-scheme={type: three-point}", *extra]
        run, _, iterations = ours(job, "vibrating-cantilever", sets)
        return run.cpu, iterations
    first = max(1, steps // 6)
    pairs = [(one(first), one(steps)) for _ in range(times)]
    seconds = statistics.median(long[0] - short[0] for short, long in pairs)
    return seconds / (steps - first), statistics.mean(pairs[0][1][1])
