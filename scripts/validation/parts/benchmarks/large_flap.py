# SPDX-License-Identifier: Apache-2.0
"""Measures of the flap at twice the flow's speed: large deflection, finite strain beside linear."""
import json

import numpy as np

import couplet

CASE = "configs/perpendicular-flap/case.yaml"
FAST = ["participants.fluid.boundaries.inlet.velocity=[20 m/s, 0 m/s]", "participants.mover.method=barrier", "simulation.end-time=1 s"]


def tip(job, name, *more):
    """Motion of the tip (times, 2) [m], and the folder of the solid."""
    folder = job.coupled(job.root / CASE, f"flap-20-{name}", [*FAST, *more]) / "solid"
    rows = couplet.read_csv(folder / "probes.csv")
    return np.array([rows["tip x [m]"], rows["tip y [m]"]]).T, folder


def verdict(job):
    (linear, folder), (finite, _) = tip(job, "linear"), tip(job, "finite", "participants.solid.kinematics=finite-strain")
    size = np.hypot(*finite.T).max()
    apart = np.hypot(*(linear - finite).T).max() / size
    share = json.loads((folder / "run.json").read_text())["errors"]["model"]
    text = (f"largest motion of the tip {linear[:, 0].max():.4f} m along the flow linear, {finite[:, 0].max():.4f} m at finite strain; {apart:.3f} of the motion apart "
            f"at most, the linear run's verdict {share:.3f}")
    return text, 1 / 1.5 <= share / apart <= 1.5
