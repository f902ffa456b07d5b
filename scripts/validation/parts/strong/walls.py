# SPDX-License-Identifier: Apache-2.0
"""Measures of strong coupling: closed fluids and the Robin interface."""
import pathlib

import numpy as np

import couplet
from couplet.atlas import strong
from couplet.atlas.atlas import Runner
from couplet.runs.process import RunFailed

CAVITY = [f"participants.{name}.mesh-parameters={{n: 8}}" for name in ("fluid", "lid", "mover")]


def case(job, name, overrides=()):
    """The coupler's tables of a whole run of configs/<name>."""
    def make():
        run = job.case_run(job.root / "configs" / name / "case.yaml", job.scratch / f"{name}-{len(overrides)}", list(overrides), {}, 3000)
        return run.folder / "coupler", run.cost
    folder, _ = job.once(("walls", name, tuple(overrides)), make)
    return couplet.read_csv(folder / "volume.csv"), couplet.read_csv(folder / "residuals.csv")


def volume_of_a_step(job, name, fluid, bound, overrides=()):
    volume, passes = case(job, name, overrides)
    change, inflow = (np.diff(volume[f"{fluid} {what} [m^3]"], prepend=0) for what in ("volume change", "inflow"))
    worst = float(np.max(np.abs(change - inflow)) / np.max(np.abs(inflow)))
    total = float(np.max(np.abs(volume[f"{fluid} volume error [m^3]"])) / np.max(np.abs(volume[f"{fluid} inflow [m^3]"])))
    return f"{worst:.1e}, of the whole inflow {total:.1e}, {len(change)} steps", max(worst, total) <= bound


def nearly_closed(job, kind, most=None):
    """Passes per step of the box with an opening of one cell, in boxes of 8, 16 and 32 cells per side, 10 steps."""
    found = []
    for n in (8, 16, 32):
        sets = [f"participants.{name}.mesh-parameters={{n: {n}}}" for name in ("fluid", "lid", "mover")]
        run = job.case_run(job.root / "configs" / "closed-cavity" / "nearly-closed.yaml", job.scratch / f"nearly-{kind}-{n}",
                           [*sets, "simulation.end-time=0.2", f"coupling.acceleration.type={kind}"], {}, 600)
        rows = couplet.read_csv(run.folder / "coupler" / "residuals.csv")
        found.append(float(np.unique(rows["step"], return_counts=True)[1].mean()))
    return ", ".join(f"{passes:.1f}" for passes in found), None if most is None else max(found) <= most


def passes_of_a_step(job, name, overrides=()):
    _, rows = case(job, name, overrides)
    counts = np.unique(rows["step"], return_counts=True)[1]
    return f"{counts.mean():.2f} on average, {counts.max()} at most", counts.mean() <= 6


def refused_without_key(job):
    try:
        job.case_run(job.root / "configs" / "closed-cavity" / "case.yaml", job.scratch / "no-level",
                     [*CAVITY, "participants.fluid.volume-level=none"], {}, 300)
    except RunFailed:
        said = "set 'volume-level: structure'" in (job.scratch / "no-level" / "run.log").read_text()
        return "refused by name" if said else "failed otherwise", said
    return "not refused", False


def robin(job, panel, most, inverses):
    """Largest mean number of passes over mass ratios and two decades of steps."""
    runner = Runner(job.build, pathlib.Path(job.scratch) / f"robin-{panel.replace(' ', '-')}")
    values = {(i, dt): strong.wall(panel, i, dt, runner)[0] for i in inverses for dt in (1e-4, 1e-3, 1e-2)}
    worst = max(values, key=lambda key: values[key] if np.isfinite(values[key]) else np.inf)
    return f"{values[worst]:.2f} at most, for {worst[0]:g} and steps of {worst[1]:g} s", \
        all(np.isfinite(v) for v in values.values()) and values[worst] <= most
