# SPDX-License-Identifier: Apache-2.0
"""The flap from heavy to light and from viscous to thin fluids, refined in the step: order of the tip and cost, by default settings. Cost needs a build of
commit b350924: COUPLET_OTHER_BUILD names its folder."""
import json
import math
import os
import pathlib
import resource

import couplet
from couplet.runs.process import RunFailed
from validation.job import Job
from validation.parts.strong.flap import COARSE, FLAP

STEPS = (0.01, 0.005, 0.0025, 0.00125)  # s
RHO, MU = (1000, 100, 10, 1), (10, 1, 0.1, 0.01)


def changes(rho, mu, step):
    return ("simulation.end-time=0.2", f"simulation.time-step={step}", "simulation.output.interval=0", "simulation.checkpoint.interval=0",
            "participants.fluid.boundaries.inlet.ramp=0.4", f"participants.fluid.viscosity={mu}", f"participants.solid.material.density={rho}",
            "coupling.convergence.max-iterations=100", *COARSE)


def processor_seconds(job, out, rho, mu, step):
    """Of all programs of the job's build; None where the run ended before."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        job.case_run(job.root / FLAP, out, changes(rho, mu, step), {}, 3000)
    except RunFailed:
        return None
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def cost(job):
    """Pairs of runs, one build after the other."""
    other = Job(job.root, pathlib.Path(os.environ["COUPLET_OTHER_BUILD"]), job.quick)
    total, ratios = [0, 0], {}
    for rho in RHO:
        for mu in MU:
            pairs = [[processor_seconds(j, job.scratch / "cost", rho, mu, step) for j in (other, job)] for step in STEPS]
            both = [p for p in pairs if None not in p]
            sums = [sum(p[i] for p in both) for i in (0, 1)]
            ratios[rho, mu] = sums[1] / sums[0]
            total = [a + b for a, b in zip(total, sums)]
    most = max(ratios, key=ratios.get)
    return (f"{total[1] / total[0]:.2f} times all rungs together; {min(ratios.values()):.2f} to {ratios[most]:.2f} times, most with rho_s {most[0]}, mu {most[1]}",
            total[1] <= 1.5 * total[0])


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
