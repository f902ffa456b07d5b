# SPDX-License-Identifier: Apache-2.0
"""Measures of strong coupling: the Robin interface in the elastic tube, passes and cost beside the other choices."""
import numpy as np

import couplet

TUBE = "configs/tube-3d/case.yaml"
ROBIN = ("coupling.order=structure-first", "participants.fluid.boundaries.wall.impedance=structure",
         "participants.solid.interface={surface-density: true}")
IQN, AITKEN = ("coupling.acceleration.type=iqn-ils",), ("coupling.acceleration={type: aitken}",)
CHOICES = {"Robin": ("semi-implicit", ROBIN + IQN), "implicit Aitken": ("implicit", AITKEN), "implicit IQN-ILS": ("implicit", IQN)}


def tube(job, choice):
    """Passes of each step and cpu seconds of all programs for 20 steps of 0.1 ms."""
    scheme, more = CHOICES[choice]
    run = job.coupled_run(job.root / TUBE, "tube-" + choice.replace(" ", "-"), [
        "simulation.end-time=2 ms", "simulation.output.interval=0", "simulation.checkpoint.interval=0", f"coupling.scheme={scheme}", *more])
    rows = couplet.read_csv(run.folder / "coupler" / "residuals.csv")
    return np.unique(rows["step"], return_counts=True)[1], run.cost.cpu, rows


def passes(job):
    counts, _, rows = tube(job, "Robin")
    number, residual = (np.array(rows[name]) for name in ("iteration", "relative residual"))
    guess, last = residual[number == 1], residual[np.cumsum(counts) - 1]
    factor = np.mean(np.log10(last / guess) / (counts - 1))
    return (f"{counts.mean():.2f} on average, {counts.max()} at most, {len(counts)} steps; the guess leaves {np.median(guess):.2g} of the load, and a "
            f"pass takes {-factor:.2f} decades off"), bool(counts.mean() <= 4.5)


def cheaper(job, than, times):
    (few, seconds, _), (many, other, _) = tube(job, "Robin"), tube(job, than)
    return f"{other / seconds:.2f} times ({other:.1f} and {seconds:.1f} cpu s; {many.mean():.1f} and {few.mean():.1f} passes per step)", \
        bool(other >= times * seconds)
