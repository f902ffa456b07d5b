# SPDX-License-Identifier: Apache-2.0
"""The Robin interface on light walls, wet on both sides or on one, and what the exchange itself costs."""
import numpy as np

import couplet
from validation.parts.strong.tube import IQN, TUBE
from validation.parts.strong.flap import COARSE, FLAP

ROBIN = ("coupling.order=structure-first", "participants.fluid.boundaries.flap.impedance=structure", "participants.solid.interface={surface-density: true}")
QUIET = ("simulation.output.interval=0", "simulation.checkpoint.interval=0")


def passes(job, case, name, *sets):
    """Of each step."""
    run = job.coupled_run(job.root / case, name, (*QUIET, *sets))
    return np.unique(couplet.read_csv(run.folder / "coupler" / "residuals.csv")["step"], return_counts=True)[1]


def flap(job):
    light = ("simulation.end-time=0.2", "participants.fluid.boundaries.inlet.ramp=0.4", "participants.solid.material.density=10", *COARSE, *IQN)
    robin, alone = passes(job, FLAP, "light-robin", *light, *ROBIN), passes(job, FLAP, "light-alone", *light)
    return f"{robin.mean():.2f} with Robin, {alone.mean():.2f} by IQN-ILS alone, {len(alone)} steps", bool(robin.mean() <= alone.mean())


def tube(job, tolerance, most, *more):
    counts = passes(job, TUBE, f"light-tube-{tolerance}-{len(more)}", "simulation.end-time=2 ms", f"coupling.convergence.relative={tolerance}", *IQN, *more)
    return f"{counts.mean():.2f} on average, {counts.max()} at most, {len(counts)} steps", bool(counts.mean() <= most)
