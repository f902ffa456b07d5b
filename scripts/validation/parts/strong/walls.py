# SPDX-License-Identifier: Apache-2.0
"""Bars of strong coupling: closed fluids and the Robin interface."""
import pathlib

import numpy as np

import couplet
from couplet.atlas import strong
from couplet.atlas.atlas import Runner
from couplet.runs.process import RunFailed
from validation.job import Bar

CAVITY = [f"participants.{name}.mesh-parameters={{n: 8}}" for name in ("fluid", "lid", "mover")]


def case(job, name, overrides=()):
    """The coupler's tables of a whole run of configs/<name>."""
    def make():
        run = job.case_run(job.root / "configs" / name / "case.yaml", job.scratch / f"{name}-{len(overrides)}", list(overrides), {}, 3000)
        return run.folder / "coupler", run.cost
    folder, _ = job.once(("walls", name, tuple(overrides)), make)
    return couplet.read_csv(folder / "volume.csv"), couplet.read_csv(folder / "residuals.csv")


def volume_of_a_step(name, fluid, bound, overrides=()):
    def measure(job):
        volume, passes = case(job, name, overrides)
        change, inflow = (np.diff(volume[f"{fluid} {what} [m^3]"], prepend=0) for what in ("volume change", "inflow"))
        worst = float(np.max(np.abs(change - inflow)) / np.max(np.abs(inflow)))
        total = float(np.max(np.abs(volume[f"{fluid} volume error [m^3]"])) / np.max(np.abs(volume[f"{fluid} inflow [m^3]"])))
        return f"{worst:.1e}, of the whole inflow {total:.1e}, {len(change)} steps", max(worst, total) <= bound
    return measure


def nearly_closed(kind, holds):
    """Passes per step of the box with an opening of one cell, in boxes of 8, 16 and 32 cells per side, 10 steps."""
    def measure(job):
        found = []
        for n in (8, 16, 32):
            sets = [f"participants.{name}.mesh-parameters={{n: {n}}}" for name in ("fluid", "lid", "mover")]
            run = job.case_run(job.root / "configs" / "closed-cavity" / "nearly-closed.yaml", job.scratch / f"nearly-{kind}-{n}",
                               [*sets, "simulation.end-time=0.2", f"coupling.acceleration.type={kind}"], {}, 600)
            rows = couplet.read_csv(run.folder / "coupler" / "residuals.csv")
            found.append(float(np.unique(rows["step"], return_counts=True)[1].mean()))
        return ", ".join(f"{passes:.1f}" for passes in found), holds(found)
    return measure


def passes_of_a_step(name, overrides=()):
    def measure(job):
        _, rows = case(job, name, overrides)
        counts = np.unique(rows["step"], return_counts=True)[1]
        return f"{counts.mean():.2f} on average, {counts.max()} at most", counts.mean() <= 6
    return measure


def refused_without_key(job):
    try:
        job.case_run(job.root / "configs" / "closed-cavity" / "case.yaml", job.scratch / "no-level",
                     [*CAVITY, "participants.fluid.volume-level=none"], {}, 300)
    except RunFailed:
        said = "set 'volume-level: structure'" in (job.scratch / "no-level" / "run.log").read_text()
        return "refused by name" if said else "failed otherwise", said
    return "not refused", False


def robin(panel, most, inverses):
    """Largest mean number of passes over mass ratios and two decades of steps."""
    def measure(job):
        runner = Runner(job.build, pathlib.Path(job.scratch) / f"robin-{panel.replace(' ', '-')}")
        values = {(i, dt): strong.wall(panel, i, dt, runner)[0] for i in inverses for dt in (1e-4, 1e-3, 1e-2)}
        worst = max(values, key=lambda key: values[key] if np.isfinite(values[key]) else np.inf)
        return f"{values[worst]:.2f} at most, for {worst[0]:g} and steps of {worst[1]:g} s", \
            all(np.isfinite(v) for v in values.values()) and values[worst] <= most
    return measure


def tested(pattern):
    def measure(job):
        passed, total, _, _ = job.ctest(pattern)
        return f"{passed} of {total} tests passed", passed == total > 0
    return measure


SHORT = "a wall in sine modes over a channel, 8 steps from rest, mesh at rest"
WALLS = [
    Bar("balloon in a channel: volume of a step over its inflow", "<= 1e-10", volume_of_a_step("balloon", "inside", 1e-10),
        but="meshes at rest, 50 steps"),
    Bar("balloon in a channel: passes per step", "<= 6 on average", passes_of_a_step("balloon")),
    Bar("closed box, moving mesh: volume of a step over its inflow", "<= 1e-10",
        volume_of_a_step("closed-cavity", "fluid", 1e-10, CAVITY), but="8 x 8 cells, 50 steps"),
    Bar("closed box, moving mesh: passes per step", "<= 6 on average", passes_of_a_step("closed-cavity", CAVITY), but="8 x 8 cells"),
    Bar("closed box, moving mesh: volume over 1000 steps", "<= 1e-10 of the inflow", volume_of_a_step(
        "closed-cavity", "fluid", 1e-10, [*CAVITY, "simulation.time-step=0.002", "simulation.end-time=2", "simulation.output.interval=0"]),
        long=True, but="8 x 8 cells"),
    Bar("two cavities under one wall, levels, halved steps, restart", "tests pass", tested("^coupling_volume_level$")),
    Bar("closed fluids: ranks, restart bit for bit, balloon", "test passes", tested("^coupling_cavity$"), long=True),
    Bar("closed box without the key", "refused", refused_without_key),
    Bar("box with an opening of 1/8, 1/16, 1/32 of its side: passes per step", "<= 6 on average",
        nearly_closed("iqn-ils", lambda found: max(found) <= 6), but="10 steps; the bar asks for closed ones"),
    Bar("the same with Aitken", "reported: the neighbour", nearly_closed("aitken", lambda found: None)),
    Bar("Robin and IQN-ILS: passes per step, rho_s h/(rho_f mu_1) 0.05 to 20, steps of 0.1 to 10 ms", "<= 4.5 on average",
        robin("Robin, IQN-ILS", 4.5, (0.05, 0.3, 1, 5, 20)), but=SHORT),
    Bar("IQN-ILS without Robin: passes per step, rho_s h/(rho_f mu_1) 0.01 to 100", "<= 30",
        robin("IQN-ILS", 30, (0.01, 0.1, 1, 10, 100)), but=SHORT + "; semi-implicit, which is implicit there"),
    Bar("Robin: closed domain, ranks, restart bit for bit, refusals", "test passes", tested("^coupling_robin$"), long=True),
]
