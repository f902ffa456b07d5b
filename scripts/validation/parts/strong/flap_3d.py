# SPDX-License-Identifier: Apache-2.0
"""Measures of strong coupling on a flap in three dimensions: light, in a viscous fluid; with the Robin interface, too."""
import numpy as np

import couplet
from validation.parts.strong.tube import IQN

CASE = "configs/perpendicular-flap/flap-3d.yaml"
ROBIN = ("coupling.order=structure-first", "participants.fluid.boundaries.flap.impedance=structure",
         "participants.solid.interface={surface-density: true}")


def flap(job, rho, *more):
    """Tip at the end of each step and passes of each."""
    name = f"flap-3d-{rho}-{len(more)}-{'-'.join(m.split('=')[0].split('.')[-1] for m in more)}"
    folder = job.coupled(job.root / CASE, name, [f"participants.solid.material.density={rho}", *more])
    tip = couplet.read_csv(folder / "solid" / "probes.csv")["tip x [m]"]
    return tip, np.unique(couplet.read_csv(folder / "coupler" / "residuals.csv")["step"], return_counts=True)[1]


def rung(job, rho):
    from validation.parts.strong.flap import zigzag
    tip, passes = flap(job, rho)
    value = zigzag(tip)
    return f"{len(tip)} steps, tip {tip[-1]:.5f} m, {passes.mean():.1f} passes, zigzag {value:.3f}", len(tip) == 20 and value < 0.15


def beside_implicit(job):
    tip, fine = flap(job, 10)[0], flap(job, 10, "coupling.scheme=implicit", *IQN, "simulation.time-step=0.0025")[0]
    same = flap(job, 10, "coupling.scheme=implicit", *IQN)[0]
    gap = abs(tip[-1] / fine[-1] - 1)
    return f"tips {tip[-1]:.5f} m and {fine[-1]:.5f} m, {100 * gap:.2f} % apart (implicit at 0.01 s: {same[-1]:.5f} m)", gap <= 0.01


def robin(job):
    tip, passes = flap(job, 10, *ROBIN, *IQN)
    other, without = flap(job, 10, *IQN)
    gap = np.abs(tip - other).max() / np.abs(other).max()
    return f"{gap:.1e} apart; {passes.mean():.2f} passes per step, {without.mean():.2f} without Robin", len(tip) == 20 and gap <= 1e-3
