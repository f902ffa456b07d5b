# SPDX-License-Identifier: Apache-2.0
"""The estimate at the end of a run: what dominates in settings made so that one part must, the same on 1, 2, 3 ranks, over a
restart, and nothing where it is switched off.
Usage: run.py BIN CONFIGS alone|ranks|coupled"""
import json
import pathlib
import subprocess
import sys
import tempfile

programs, configs, kind = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
failed = 0


def check(good, *what):
    global failed
    failed += not good
    print("ok    " if good else "FAILED", *what)


def run(program, case, sets, folder, ranks=1, more=(), code=0):
    start = [] if ranks == 1 else ["mpirun", "--oversubscribe", "-np", str(ranks)]
    command = [*start, str(programs / program), str(configs / case / "case.yaml"), *(f"--set={s}" for s in sets),
               f"--set=simulation.output.folder={folder}", *more]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    if done.returncode != code:
        print(done.stdout[-1500:], done.stderr[-1500:])
        sys.exit(f"FAILED: {case} ended with exit code {done.returncode}")
    return done.stdout + done.stderr


def errors(folder, participant):
    return json.loads((pathlib.Path(folder) / participant / "run.json").read_text())["errors"]


def discretisation(folder, participant):
    """The parts that the settings of these cases decide."""
    return {k: v for k, v in errors(folder, participant).items() if k in ("mesh", "step", "linear")}


def beam(side, step):
    return ["participants.solid.mesh-parameters={n_length: %d, n_side: %d}" % (10 * side, side), f"simulation.time-step={step}", "simulation.end-time=20"]


PULLED = ["participants.solid.mesh-parameters={n_length: 20, n_side: 2}", "participants.solid.solution-method={type: segregated, relative-tolerance: 1e-3}",
          "participants.solid.material.poissons-ratio=0", "participants.solid.boundaries.tip={type: traction, value: [1.25e-3, 0, 0]}"]


def green(n, step):
    return ["participants.fluid.mesh-parameters={n: %d}" % n, f"simulation.time-step={step}", "simulation.end-time=1"]


ALONE = {  # settings of which one part must dominate: program, case, participant, settings, the part
    "solid, coarse mesh": ("solid_solver", "vibrating-cantilever", "solid", beam(2, 0.1), "mesh"),
    "solid, long step": ("solid_solver", "vibrating-cantilever", "solid", beam(8, 2), "step"),
    "solid, loose solver": ("solid_solver", "cantilever", "solid", PULLED, "linear tolerance"),
    "solid, symmetric operator, whose energies agree on any mesh": (
        "solid_solver", "cantilever", "solid",
        ["participants.solid.mesh-parameters={n_length: 20, n_side: 2}", "participants.solid.solution-method.face-gradient=symmetric"], "mesh"),
    "tank, few cells": ("thermocline", "schumann", "tank", ["participants.tank.bed.cells=100", "participants.tank.bed.advection=upwind"], "mesh"),
    "tank, long step": ("thermocline", "schumann", "tank", ["participants.tank.bed.cells=800", "participants.tank.bed.advection=implicit",
                                                            "participants.tank.exchange-step=60 s"], "step"),
    "fluid, coarse mesh": ("fluid_solver", "taylor-green-2d", "fluid", green(16, 0.02), "mesh"),
}


def alone(folder):
    for name, (program, case, participant, sets, part) in ALONE.items():
        text = run(program, case, sets, folder)
        found = discretisation(folder, participant)
        known = {k: v for k, v in found.items() if v is not None}
        largest = {"mesh": "mesh", "step": "step", "linear": "linear tolerance"}[max(known, key=known.get)]
        check("estimated error" in text and largest == part and (len(known) < 2 or f"({part.split()[0]}" in text), name, found)
    # The loosest tolerance that is allowed: the first pass over an oblique mesh asked for ten times as much, which is none.
    run("fluid_solver", "cylinder", ["participants.fluid.mesh-parameters={n: 8}", "participants.fluid.pressure-tolerance=0.1", "simulation.end-time=0.01",
                                     "simulation.time-step=0.005"], folder)
    check(True, "fluid, loosest tolerance")
    whole(folder)
    worthless(folder)
    off(folder)
    young_front(folder)


def worthless(folder):
    """An estimated error as large as the solution makes the answer useless, a smaller one does not."""
    for step, length, doubted in (("10", "200", True), ("0.5", "20", False)):
        text = run("solid_solver", "vibrating-cantilever", [*beam(2, step), f"simulation.end-time={length}"], folder, code=4 if doubted else 0)
        check(("result not reliable" in text) == doubted, f"steps of {step} s: {'' if doubted else 'not '}doubted", text[-300:])


def ranks(folder):
    for program, case, participant, sets in (("solid_solver", "vibrating-cantilever", "solid", beam(2, 0.5)),
                                             ("fluid_solver", "taylor-green-2d", "fluid", green(16, 0.1))):
        run(program, case, sets, folder)
        one = errors(folder, participant)
        for number in (2, 3):
            run(program, case, sets, folder, number)
            more = errors(folder, participant)
            # What a solver leaves below its tolerance is not the same on other ranks.
            near = all(abs(more[k] - one[k]) <= 1e-3 * abs(one[k]) for k in ("mesh", "step"))
            check(near, f"{program} on {number} ranks", more, one)


def whole(folder):
    """A run that was stopped in the middle knows the errors of its first half: only the two steps after it are not judged."""
    sets = beam(2, 0.5)
    run("solid_solver", "vibrating-cantilever", sets, folder)
    one = errors(folder, "solid")["step"]
    run("solid_solver", "vibrating-cantilever", [*sets, "simulation.end-time=10"], folder)
    half = errors(folder, "solid")["step"]
    run("solid_solver", "vibrating-cantilever", sets, folder, 1, ["--restart", newest(folder)])
    both = errors(folder, "solid")["step"]
    check(half < 0.7 * one and 0.8 * one < both <= 1.05 * one, "restart: step", half, one, both)


def young_front(folder):
    """A front that has just come in has been spread over the little way that it came, not over the height: within a factor of 2."""
    def profile(cells, advection, time):
        run("thermocline", "schumann", [f"participants.tank.bed.cells={cells}", f"participants.tank.bed.advection={advection}",
                                        f"simulation.end-time={time} s", f"simulation.time-step={time} s"], folder)
        rows = [[float(v) for v in line.split(",")] for line in (pathlib.Path(folder) / "tank/bed.csv").read_text().splitlines()[1:]]
        return [row[3] for row in rows if row[0] == rows[-1][0]]
    for time in (50, 200, 1000):
        fine, coarse = profile(3200, "tvd", time), profile(200, "upwind", time)
        estimated, mean = errors(folder, "tank")["mesh"], sum(coarse) / len(coarse)
        true = sum(abs(t - sum(fine[16 * i:16 * i + 16]) / 16) for i, t in enumerate(coarse)) / sum(abs(t - mean) for t in coarse)
        check(true / 2 <= estimated <= 2 * true, f"tank, front after {time} s: estimated and true error", estimated, true)


def newest(folder):
    return str(max((f for f in (pathlib.Path(folder) / "checkpoints").iterdir() if f.is_dir()), key=lambda f: f.stat().st_mtime))


def off(folder):
    """Off: nothing is said, and the results are those of a run that estimates, byte for byte."""
    results = []
    for word in ("standard", "without-errors"):
        text = run("solid_solver", "vibrating-cantilever", [*beam(2, 0.5), f"simulation.diagnostics={word}"], folder)
        results.append((pathlib.Path(folder) / "solid/probes.csv").read_bytes())
        known = [v for v in errors(folder, "solid").values() if v is not None]
        check(("estimated error" in text) == (word == "standard") == bool(known), f"diagnostics: {word}", known)
    check(results[0] == results[1], "the results are the same")


def flap(folder, n, sets, code=0):
    """All programs as couplet.runs starts them; n cells along the flap's side."""
    sys.path.insert(0, str(configs.parent / "client/python"))
    from couplet.runs import Case
    case = Case(configs / "perpendicular-flap/study.yaml", programs.resolve().parent)
    sizes = "{n_side: %d, n_tip: %d, growth: 1.35, wall_growth: 1.35, wall_cells: 5}" % (n, n // 10)
    changes = {"participants.fluid.mesh-parameters": sizes, "participants.mover.mesh-parameters": sizes,
               "participants.solid.mesh-parameters": "{n_side: %d, n_tip: %d}" % (2 * n, n // 5), "simulation.output.folder": folder, **sets}
    done = subprocess.run([str(c) for c in case.command(changes)], capture_output=True, text=True, timeout=280)
    if done.returncode != code:
        sys.exit(f"FAILED: flap: {done.stdout[-2000:]} {done.stderr[-1000:]}")
    return done.stdout + done.stderr


def flap_settings(step, end, tolerance):
    return {"simulation.time-step": f"{step} s", "simulation.end-time": f"{end} s", "coupling.convergence.relative": str(tolerance)}


SLOW = {"coupling.predictor.order": "0", "coupling.acceleration": "{type: constant, initial-relaxation: 0.1}"}
COUPLED = {  # cells, settings, the part
    "flap, coarse mesh": (10, flap_settings(0.005, 0.2, 1e-6), "mesh"), "flap, long step": (30, flap_settings(0.1, 0.4, 1e-5), "step"),
    "flap, loose coupling": (10, {**flap_settings(0.02, 0.2, 0.9), **SLOW}, "coupling tolerance")}


def coupled(folder):
    for name, (n, sets, part) in COUPLED.items():
        text = flap(folder, n, sets, 4 if part == "coupling tolerance" else 0)  # useless, and said to be
        told = [line for line in text.splitlines() if line.startswith("[coupler 0] estimated")]
        check(len(told) == 1 and f"of the solution: {part} " in told[0], name, *told)
    text = flap(folder, 10, {**flap_settings(0.05, 0.1, 1e-6), "simulation.diagnostics": "without-errors"})
    check("estimated error" not in text, "flap, off")


with tempfile.TemporaryDirectory() as scratch:
    {"alone": alone, "ranks": ranks, "coupled": coupled}[kind](scratch)
sys.exit(failed > 0)
