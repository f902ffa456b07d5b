# SPDX-License-Identifier: Apache-2.0
"""Time, instructions and memory of steps, start-up, and the command."""
import importlib.machinery
import importlib.util
import os
import re
import resource
import shutil
import statistics
import sys
import time

from couplet.runs import launch


# -- step -------------------------------------------------------------------------------------------------------------
BEFORE = "b350924"
# (cells a side, dimension): dt [s], the steps between which is counted, and the instructions of b350924 by the same count
COUNTED = {(128, 2): (0.004, 10, 30, 1183), (32, 3): (0.008, 20, 30, 2471)}
TOLERANCE = 1e-6


def benchmark_module(job):
    loader = importlib.machinery.SourceFileLoader("couplet_benchmark_fluid", str(job.root / "benchmarks/fluid"))
    spec = importlib.util.spec_from_loader(loader.name, loader)
    module = importlib.util.module_from_spec(spec)
    loader.exec_module(module)
    return module


def scene(job, what, steps):
    """Folder with the case of so many steps; its mesh is made once."""
    n, dimension = what
    dt = COUNTED[what][0]
    folder = job.scratch / f"cavity-{n}-{dimension}"
    folder.mkdir(exist_ok=True)
    job.once(("benchmark module",), lambda: benchmark_module(job)).cavity_case(folder, dimension, n, dt, steps, TOLERANCE)
    return folder


def instructions(job, program, what):
    """Per cell and step, of the whole process between two lengths of the run."""
    n, dimension = what
    dt, first, last, _ = COUNTED[what]
    totals = []
    for steps in (first, last):
        folder = scene(job, what, steps)
        job.once(("meshed", what), lambda: job.run([program, "case.yaml"], cwd=folder))
        counts = folder / "counts"
        job.done(["valgrind", "--tool=callgrind", f"--callgrind-out-file={counts}", program, "case.yaml"], cwd=folder)
        totals.append(int(re.search(r"^(?:totals|summary): (\d+)", counts.read_text(), re.M)[1]))
    return (totals[1] - totals[0]) / (n**dimension * (last - first))


def counted(job, what, share):
    got, before = instructions(job, job.build / "bin/fluid_solver", what), COUNTED[what][3]
    return f"{got:.0f}, {got / before:.2f} of the {before} of {BEFORE}", got <= share * before


# -- cells ------------------------------------------------------------------------------------------------------------
TEST = "verification_fluid_fourth_order"
PEAK, HEIGHT = 9.0, 0.0128  # of -dk/dt at Re 1600
KEY = "participants.fluid.face-values="
ORDERS = {"second": KEY + "second-order", "fourth": KEY + "fourth-order"}
PAIRS = 5
WHOLE = 0.025  # steps that either order takes whole [s]; twice as long ones are divided by fourth order, whose limit is lower


def order_of_lines(job):
    (u,), passed = job.recorded(TEST, "are_fourth_order", "velocity_slope")
    (p,), _ = job.recorded(TEST, "are_fourth_order", "pressure_slope")
    (gain,), _ = job.recorded(TEST, "are_fourth_order", "gain")
    return f"velocity {u:.2f}, pressure {p:.2f}; 64^2: {gain:.0f} times less error than second order", passed and min(u, p) >= 3.8


def cavity(job):
    """The largest deviation of the three extrema by order, and the processor minutes."""
    found = {}
    for name, setting in ORDERS.items():
        run = job.alone("cavity-3d", [setting], timeout=7200)
        found[name] = job.beside("configs/cavity-3d/extrema.py").errors(run.folder / "fluid"), run.cost.cpu / 60
    return found


def extrema_of_cavity(job):
    found = cavity(job)
    texts = [f"{name} order {', '.join(f'{key} {100 * off:.2f} %' for key, off in errors.items())} ({minutes:.1f} processor minutes)" for name, (errors, minutes) in found.items()]
    return "; ".join(reversed(texts)), max(found["fourth"][0].values()) <= 0.02


def peak(job, n, name, *sets):
    folder, _ = job.solve("taylor-green-3d", [f"participants.fluid.mesh-parameters.n={n}", ORDERS[name], *sets], timeout=48 * 3600)
    return job.beside("configs/taylor-green-3d/budget.py").budget(folder / "fluid")


def vortices(job, n, what, share):
    key, wanted = {"time": ("peak_time", PEAK), "height": ("peak", HEIGHT)}[what]
    sets = ["simulation.time-step=0.02 s"] if n > 64 else []
    got = {name: peak(job, n, name, *sets)[key] for name in ORDERS}
    texts = [f"{name} order {got[name]:.5g} ({100 * (got[name] / wanted - 1):+.1f} %)" for name in ("fourth", "second")]
    return ", ".join(texts), abs(got["fourth"] / wanted - 1) <= share


def step_of_fourth(job):
    """Processor time of 40 steps of 48^3 cells that neither order divides, in pairs."""
    def seconds(setting, turn):
        of = {}
        for steps in (5, 45):
            sets = ["participants.fluid.mesh-parameters.n=48", "participants.fluid.turbulence=null", "participants.fluid.output=null", f"simulation.time-step={WHOLE}",
                    f"simulation.end-time={steps * WHOLE:g}", "simulation.output.interval=100", setting]
            run = job.case_run(job.root / "configs/taylor-green-3d/case.yaml", job.scratch / f"cost-{turn}-{steps}", sets, {"fluid": 1}, 1800)
            of[steps] = run.cost.cpu
            if run.column("fluid", "balance.csv", "sub-steps [-]").max() > 1:
                raise RuntimeError(f"steps of {WHOLE} s are divided")
        return of[45] - of[5]
    ratios = [seconds(ORDERS["fourth"], f"f{i}") / seconds(ORDERS["second"], f"s{i}") for i in range(PAIRS)]
    return f"{statistics.median(ratios):.2f} times, median of {PAIRS} pairs ({min(ratios):.2f} to {max(ratios):.2f}), Taylor-Green 48^3", statistics.median(ratios) <= 1.3


# -- start ------------------------------------------------------------------------------------------------------------
EMPTY = """#include <mpi.h>
int main(int argc, char** argv) { MPI_Init(&argc, &argv); MPI_Finalize(); return 0; }
"""
STARTS = 15


def solid(job):
    """Folder of a cantilever of 1000 cells from a .msh of its own."""
    def make():
        folder = job.scratch / "small-solid"
        folder.mkdir()
        shutil.copy(job.root / "configs/cantilever/cantilever.geo", folder)
        job.done(["gmsh", "-3", "-setnumber", "n_length", "40", "-setnumber", "n_side", "5", "cantilever.geo", "-o", "mesh.msh"], cwd=folder)
        case = (job.root / "configs/cantilever/case.yaml").read_text().split("\n# scripts/couplet study")[0]
        case = re.sub(r"^ *mesh-parameters:.*\n", "", case, flags=re.M).replace("cantilever.geo", "mesh.msh")
        (folder / "case.yaml").write_text(case)
        return folder
    return job.once(("small solid",), make)


def cpu(command, folder):
    return launch(command, folder / "start.log", folder).cpu


def phases(text):
    """Seconds of the run by its own account: in all, solve, accept_step, files."""
    account = {m[1]: float(m[2]) for m in re.finditer(r"^(\w+) +([\d.]+) +[\d.]+ %", text, re.M)}
    return account["total"], account["solve"], account["accept_step"], account["write_output"] + account["save"]


def beside_empty(job):
    folder = solid(job)
    (folder / "empty.c").write_text(EMPTY)
    job.run(["mpicc", "-O2", "empty.c", "-o", "empty"], cwd=folder)
    turns = []
    for _ in range(STARTS):
        empty, own = cpu([folder / "empty"], folder), cpu([job.build / "bin/solid_solver", "case.yaml"], folder)
        turns.append((empty, own, *phases((folder / "start.log").read_text())))
    middle = [statistics.median(values) for values in zip(*turns)]
    more = statistics.median(own - empty for empty, own, *_ in turns)
    return (f"{more:.3f} s more than {middle[0]:.3f} s, median of {STARTS} pairs; the run's own account: {middle[2]:.3f} s, of which solve {middle[3]:.3f}, "
            f"judgement of the answer {middle[4]:.3f}, files {middle[5]:.3f}"), more <= 0.04


# -- speed ------------------------------------------------------------------------------------------------------------
def benchmark(job, only):
    def make():
        result = job.done([sys.executable, job.root / "benchmarks/fluid", "--build", job.build, "--only", only])
        return result.stdout
    return job.once(("benchmark", only), make)


def ratio(job, only, wanted):
    text = benchmark(job, only)
    found = re.search(r"ratio ([\d.]+)", text)
    if not found:
        raise LookupError("OpenFOAM is not installed")
    return f"{found[1]} times", float(found[1]) >= wanted


def memory(job):
    found = re.search(r"([\d.]+) kB per cell", benchmark(job, "cavity-3d"))
    return f"{found[1]} kB per cell", float(found[1]) <= 1.5


def second_core(job, wanted):
    found = re.search(r"two ranks: .*, ([\d.]+) times", benchmark(job, "cavity-3d"))
    return f"{found[1]} times", float(found[1]) >= wanted


# -- jobs -------------------------------------------------------------------------------------------------------------
def overhead(job):
    """Wall and processor time of couplet run less those of mpirun with the same line; the programs do nothing, the runs alternate. What the
    machine does besides lengthens both: the quickest of all runs counts."""
    couplet, folder, programs = job.root / "scripts/couplet", job.scratch / "overhead", job.scratch / "idle/bin"
    job.run([couplet, "new", folder], check=True)
    programs.mkdir(parents=True)
    for name in ("coupler", "fluid_solver", "solid_solver", "mesh_mover"):
        (programs / name).write_text("#!/bin/sh\nexit 0\n")
        (programs / name).chmod(0o755)
    command = [couplet, "run", folder, "--bin", programs]
    line = job.run([*command, "--print"], check=True).stdout
    wall, processor = {"couplet": [], "mpirun": []}, {"couplet": [], "mpirun": []}
    for _ in range(20):
        for name, words in (("couplet", command), ("mpirun", ["sh", "-c", "exec " + line])):
            start, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
            job.run(words, check=True)
            wall[name].append(time.monotonic() - start)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            processor[name].append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    seconds, used = (min(t["couplet"]) - min(t["mpirun"]) for t in (wall, processor))
    return f"{seconds:.2f} s, {used:.2f} s of the processor (mpirun {min(wall['mpirun']):.2f} s; load {os.getloadavg()[0]:.0f})", seconds < 0.2
