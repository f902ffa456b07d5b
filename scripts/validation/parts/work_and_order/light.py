# SPDX-License-Identifier: Apache-2.0
"""The Robin interface on light walls, wet on both sides or on one, and what the exchange itself costs."""
import numpy as np

import couplet
from validation.job import Bar
from validation.parts.coupler.runs import exchanged
from validation.parts.strong.tube import IQN, TUBE
from validation.parts.strong.tube import ROBIN as TUBE_ROBIN
from validation.strong_coupling import COARSE, FLAP

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


def tube(tolerance, most, *more):
    def measure(job):
        counts = passes(job, TUBE, f"light-tube-{tolerance}-{len(more)}", "simulation.end-time=2 ms", f"coupling.convergence.relative={tolerance}", *IQN, *more)
        return f"{counts.mean():.2f} on average, {counts.max()} at most, {len(counts)} steps", bool(counts.mean() <= most)
    return measure


BARS = [
    Bar("flap, rho_s 10, mu 1, dt 0.01 s, Robin and IQN-ILS: passes per step", "at most those of IQN-ILS alone", flap, but="20 cells per side, to 0.2 s"),
    Bar("tube, dt 1e-4 s, Robin and IQN-ILS to a relative 1e-4: passes per step", "<= 4.5", tube("1e-4", 4.5, *TUBE_ROBIN), long=True, but="20 steps"),
    Bar("tube, dt 1e-4 s, Robin and IQN-ILS to a relative 1e-6: passes per step", "<= 5.5", tube("1e-6", 5.5, *TUBE_ROBIN), long=True, but="20 steps"),
    Bar("tube, dt 1e-4 s, IQN-ILS alone to a relative 1e-6: passes per step", "<= 9", tube("1e-6", 9), long=True, but="20 steps"),
    Bar("exchange of 1e5 3-vectors, Aitken, over MPI's own time for the same bytes", "at most 3 times", exchanged("aitken", lambda ms, plain: ms <= 3 * plain)),
]
