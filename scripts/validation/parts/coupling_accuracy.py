# SPDX-License-Identifier: Apache-2.0
"""Work, order in time, tolerances and restart of coupled runs."""
import csv
import json
import math
import re
import sys

import numpy as np

import couplet
from couplet.runs.process import RunFailed
from validation.parts.strong_coupling import COARSE, FLAP, IQN, TUBE


# -- damping ----------------------------------------------------------------------------------------------------------
TUREK_HRON = "configs/turek-hron"
MESHES = {"1:1": ("participants.solid.mesh={root}/scripts/validation/parts/plate-matched.geo", "participants.solid.mesh-parameters={n: 12}"),
          "3:2": ("participants.solid.mesh-parameters={nx: 62, ny: 9}",)}  # 41 and 6 faces of the fluid
END = 20  # s


def run(job, mesh, *more):
    """Summary of the last 1.2 s, work [J] of fluid and structure over the run, energies of the plate."""
    sets = [one.replace("{root}", str(job.root)) for one in MESHES[mesh]]
    folder = job.coupled(job.root / TUREK_HRON / "case.yaml", f"fsi3-long-{mesh.replace(':', '-')}-{len(more)}", (
        f"simulation.end-time={END} s", "simulation.output.interval=0", "simulation.checkpoint.interval=0", "participants.solid.output.energies=true",
        *sets, *more), timeout=20000)
    balance = couplet.read_csv(folder / "coupler" / "balance.csv")
    works = [float(np.sum(balance[name])) for name in balance if name.endswith("work of the step [J]")]
    return job.beside(f"{TUREK_HRON}/summary.py").summary(folder), works, couplet.read_csv(folder / "solid" / "energies.csv")


def text(found):
    return f"{1e3 * found['uy_mean']:.2f} +- {1e3 * found['uy_amp']:.2f} mm, {found['uy_f']:.2f} Hz"


def work(job, mesh):
    found, (given, taken, *_), _ = run(job, mesh)
    apart = abs(given + taken if given * taken < 0 else given - taken) / max(abs(given), abs(taken))
    return f"{END} s; {text(found)}; work {given:.8g} and {taken:.8g} J: {apart:.1e} apart", apart <= 1e-10


def amplitude(job):
    one, three = run(job, "1:1")[0], run(job, "3:2")[0]
    off = three["uy_amp"] / one["uy_amp"] - 1
    return f"{text(three)} for {text(one)}: {100 * off:+.2f} %", abs(off) <= 0.03


def ledger(job, mesh):
    """What the plate's own time scheme loses or makes, of what it holds at most and of what went in."""
    energies = run(job, mesh)[2]
    lost = np.array(energies["lost by the scheme [J]"])
    held = np.array(energies["strain [J]"]) + np.array(energies["kinetic [J]"])
    worst = np.abs(lost).max() / held.max()
    return f"{worst:.1e} of the most energy that it holds", worst <= 1e-3


# -- loads ------------------------------------------------------------------------------------------------------------
AT = 1.25  # s
SWING = ("participants.fluid.viscosity=1 Pa s", "participants.fluid.viscous=implicit",
         'participants.fluid.motion.translation=["-(5/(4*pi))*(1-cos(0.4*pi*t))", 0]')


def force(job, step, cells):
    """x force [N] of a cylinder that moves by -(5/4 pi)(1 - cos 0.4 pi t), viscosity 1 Pa s: given at the middle of the steps."""
    def make():
        run = job.alone("oscillating-cylinder",
                            (*SWING, "participants.fluid.mesh-parameters={n: %d}" % cells, f"simulation.end-time={AT + 2 * step}", f"simulation.time-step={step}"))
        with open(run.folder / "fluid" / "forces.csv", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        parts = [i for i, name in enumerate(rows[0]) if name.endswith(" x [N]")]
        found = {round(float(row[0]) / step): sum(float(row[i]) for i in parts) for row in rows[1:]}
        n = round(AT / step)
        return (found[n] + found[n + 1]) / 2
    return job.once(("oscillating cylinder", step, cells), make)


def in_time(job):
    a, b, c = (force(job, step, 48) for step in (0.025, 0.0125, 0.00625))
    order = math.log2((a - b) / (b - c))
    return f"{a:.5f}, {b:.5f}, {c:.5f} N: order {order:.2f}", order >= 1.9


def beside_finer(job):
    fine, got = force(job, 0.0025, 192), force(job, 0.01, 48)
    return f"{100 * (got / fine - 1):+.3f} % of {fine:.5f} N", abs(got / fine - 1) <= 1e-3


def power(job):
    """Of the last step to 1.25 s: what the wall gives beside what the fluid gains and its viscosity takes, by forces.csv and energy.csv."""
    step = 0.01
    run = job.alone("oscillating-cylinder", (
        *SWING, "participants.fluid.mesh-parameters={n: 48}", f"simulation.end-time={AT}", f"simulation.time-step={step}", "participants.fluid.output.energy-budget=true"))
    forces, energy = (couplet.read_csv(run.folder / "fluid" / name) for name in ("forces.csv", "energy.csv"))
    force = sum(forces[name][-1] for name in forces if name.endswith(" x [N]"))
    moved = -(5 / (4 * math.pi)) * (math.cos(0.4 * math.pi * (AT - step)) - math.cos(0.4 * math.pi * AT))
    given = -force * moved / step
    taken = (energy["kinetic energy [J]"][-1] - energy["kinetic energy [J]"][-2]) / step + energy["viscous power [W]"][-2:].mean()
    return f"wall {given:.5f} W, fluid {taken:.5f} W: {100 * (taken / given - 1):+.2f} %", abs(taken / given - 1) < 1e-10


# -- ladder -----------------------------------------------------------------------------------------------------------
STEPS = (0.01, 0.005, 0.0025, 0.00125)  # s
RHO, MU = (1000, 100, 10, 1), (10, 1, 0.1, 0.01)


def changes(rho, mu, step):
    return ("simulation.end-time=0.2", f"simulation.time-step={step}", "simulation.output.interval=0", "simulation.checkpoint.interval=0",
            "participants.fluid.boundaries.inlet.ramp=0.4", f"participants.fluid.viscosity={mu}", f"participants.solid.material.density={rho}",
            "coupling.convergence.max-iterations=100", *COARSE)


def tip_and_estimate(job, rho, mu, step):
    """At 0.2 s [m], and the run's own estimate of the step's error (a share); None where the run ended before."""

    def make():
        try:
            folder = job.case_run(job.root / FLAP, job.scratch / f"rung-{rho}-{mu}-{step}", changes(rho, mu, step), {}, 3000).folder
        except RunFailed:
            return None
        estimate = json.loads((folder / "coupler" / "run.json").read_text())["errors"]["step"]
        return couplet.read_csv(folder / "solid" / "probes.csv")["tip x [m]"][-1], estimate
    return job.once(("rung", rho, mu, step), make)


def tip(job, rho, mu, step):
    found = tip_and_estimate(job, rho, mu, step)
    return found and found[0]


def estimates(job):
    """Of steps of 10, 5 and 2.5 ms in the rungs that end: beside the limit of the two finest, of the order that they show, 1 to 2."""
    ratios = []
    for rho in RHO:
        for mu in MU:
            tips = [tip(job, rho, mu, step) for step in STEPS]
            if None in tips:
                continue
            order = min(2, max(1, math.log2(abs(tips[1] - tips[2]) / abs(tips[2] - tips[3]))))
            limit = tips[3] + (tips[3] - tips[2]) / (2**order - 1)
            for step, value in zip(STEPS[:3], tips):
                truth = abs(value / limit - 1)
                if truth > 1e-4:  # what the coupling's tolerance leaves
                    ratios.append(tip_and_estimate(job, rho, mu, step)[1] / truth)
    good = sum(1 / 3 <= r <= 3 for r in ratios)
    ratios.sort()
    return (f"{good} of {len(ratios)}; {sum(r > 3 for r in ratios)} above three times the truth, {sum(r < 1 / 3 for r in ratios)} below a third; "
            f"{ratios[0]:.2f} to {ratios[-1]:.1f} times it"), good >= 0.8 * len(ratios)


def rung(job, rho, mu):
    tips = [tip(job, rho, mu, step) for step in STEPS]
    text = ", ".join("ended before" if t is None else f"{t:.6f}" for t in tips)
    if None in tips:
        return f"tip {text} m", False
    gaps = [abs(a - b) for a, b in zip(tips, tips[1:])]
    order = math.log2(gaps[-2] / gaps[-1]) if gaps[-1] > 0 else math.inf
    return f"tip {text} m: order {order:.2f}, last difference {gaps[-1] / abs(tips[-1]):.1e} of the tip", order >= 1.8 or gaps[-1] <= 1e-4 * abs(tips[-1])


# -- tolerances -------------------------------------------------------------------------------------------------------
PISTON = "tests/coupling/piston/case.yaml"
DEFAULTS = ("participants.fluid.pressure-tolerance=1e-6", "coupling.convergence.relative=1e-5")
BY_HAND = {10: 34, 91: 37, 1000: 44}  # passes of ten steps with a pressure tolerance of 1e-9


def passes(job, density):
    """Of ten steps; None if one of them failed."""
    out = job.scratch / f"piston-{density}"
    try:
        log = job.case_run(job.root / PISTON, out, (*DEFAULTS, f"participants.fluid.density={density}"), {}, 120).log
    except RunFailed:
        return None
    halvings, mean = re.search(r"(\d+) halvings.*iterations: mean ([\d.]+)", log).groups()
    return None if int(halvings) else round(10 * float(mean))


def piston(job, ratio):
    found = [passes(job, round(1000 * ratio * (1 + 1e-4 * k), 4)) for k in range(12)]
    done = [n for n in found if n is not None]
    text = f"{len(found) - len(done)} of {len(found)} runs with failed steps; {min(done)} to {max(done)} passes in the others"
    return text, len(done) == len(found) and max(done) <= BY_HAND[ratio]


# -- restart ----------------------------------------------------------------------------------------------------------
TOLERANCE = 1e-5  # of the coupling's convergence


def lines(job, case):
    def make():
        script = job.root / "tests" / "coupling" / "restart" / "ranks.py"
        result = job.run([sys.executable, script, case, job.root / "configs", job.build / "bin"], 3600)
        if f"{case}: 3 to 1" not in result.stdout:
            raise RuntimeError(result.stdout[-1000:] + result.stderr[-1000:])
        return result.stdout
    return job.once(("restart", case), make)


def equal(job, case):
    found = {int(n): int(differ) for n, differ in re.findall(r": (\d) to \1: (\d+) tables differ", lines(job, case))}
    return "; ".join(f"{n} {'rank' if n == 1 else 'ranks'}: {d} tables differ" for n, d in found.items()), sorted(found) == [1, 2, 3] and not any(found.values())


def other(job, case):
    found = re.findall(r": (\d) to (\d): apart by (\S+) .*?ranks by (\S+)", lines(job, case))
    text = ", ".join(f"{a} to {b}: {off}" for a, b, off, _ in found)
    return f"{text} of the largest value; uninterrupted runs on other ranks: {max(float(r) for *_, r in found):.2g}", len(found) == 4 and all(float(off) <= max(TOLERANCE, float(r)) for *_, off, r in found)


# -- light ------------------------------------------------------------------------------------------------------------
ROBIN = ("coupling.order=structure-first", "participants.fluid.boundaries.flap.impedance=structure", "participants.solid.interface={surface-density: true}")
QUIET = ("simulation.output.interval=0", "simulation.checkpoint.interval=0")


def passes_of_each_step(job, case, name, *sets):
    """Of each step."""
    run = job.coupled_run(job.root / case, name, (*QUIET, *sets))
    return np.unique(couplet.read_csv(run.folder / "coupler" / "residuals.csv")["step"], return_counts=True)[1]


def flap(job):
    light = ("simulation.end-time=0.2", "participants.fluid.boundaries.inlet.ramp=0.4", "participants.solid.material.density=10", *COARSE, *IQN)
    robin, alone = passes_of_each_step(job, FLAP, "light-robin", *light, *ROBIN), passes_of_each_step(job, FLAP, "light-alone", *light)
    return f"{robin.mean():.2f} with Robin, {alone.mean():.2f} by IQN-ILS alone, {len(alone)} steps", bool(robin.mean() <= alone.mean())


def tube(job, tolerance, most, *more):
    counts = passes_of_each_step(job, TUBE, f"light-tube-{tolerance}-{len(more)}", "simulation.end-time=2 ms", f"coupling.convergence.relative={tolerance}", *IQN, *more)
    return f"{counts.mean():.2f} on average, {counts.max()} at most, {len(counts)} steps", bool(counts.mean() <= most)
