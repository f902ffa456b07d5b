# SPDX-License-Identifier: Apache-2.0
"""The flap from heavy to light and from viscous to thin fluids, refined in the step: order of the tip, by default settings."""
import math

import couplet
from couplet.runs.process import RunFailed
from validation.job import Bar
from validation.strong_coupling import COARSE, FLAP

STEPS = (0.01, 0.005, 0.0025, 0.00125)  # s


def tip(job, rho, mu, step):
    """At 0.2 s [m]; None where the run ended before."""

    def make():
        try:
            folder = job.case_run(job.root / FLAP, job.scratch / f"rung-{rho}-{mu}-{step}", (
                "simulation.end-time=0.2", f"simulation.time-step={step}", "simulation.output.interval=0", "simulation.checkpoint.interval=0",
                "participants.fluid.boundaries.inlet.ramp=0.4", f"participants.fluid.viscosity={mu}", f"participants.solid.material.density={rho}",
                "coupling.convergence.max-iterations=100", *COARSE), {}, 3000).folder
        except RunFailed:
            return None
        return couplet.read_csv(folder / "solid" / "probes.csv")["tip x [m]"][-1]
    return job.once(("rung", rho, mu, step), make)


def rung(rho, mu):
    def measure(job):
        tips = [tip(job, rho, mu, step) for step in STEPS]
        text = ", ".join("ended before" if t is None else f"{t:.6f}" for t in tips)
        if None in tips:
            return f"tip {text} m", False
        gaps = [abs(a - b) for a, b in zip(tips, tips[1:])]
        order = math.log2(gaps[-2] / gaps[-1]) if gaps[-1] > 0 else math.inf
        return f"tip {text} m: order {order:.2f}, last difference {gaps[-1] / abs(tips[-1]):.1e} of the tip", order >= 1.8 or gaps[-1] <= 1e-4 * abs(tips[-1])
    return measure


BARS = [Bar(f"ladder of flaps, rho_s {rho}, mu {mu}: tip at 0.2 s, steps of 10, 5, 2.5, 1.25 ms", "order >= 1.8 between the finest, or 1e-4 apart",
            rung(rho, mu), long=True) for rho in (1000, 100, 10, 1) for mu in (10, 1, 0.1, 0.01)]
