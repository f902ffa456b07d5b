# SPDX-License-Identifier: Apache-2.0
"""Runs for scripts/couplet accuracy: schemes, accelerations and tolerances of a light flap (density 42) in a flow
that starts smoothly; 20 steps of 10 ms on a coarse mesh. A flap is wet on both sides: Robin foresees half its thickness."""
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "client/python"))
import couplet  # noqa: E402

TITLE = "Light flap: coupling error at 10 ms"
# Tip [m] at 0.02, 0.04, ... 0.2 s: this case on this mesh, implicit, IQN-ILS, relative 1e-8, the same steps
REFERENCE = np.array([
    2.039379922e-04, 1.793996953e-03, 5.973057447e-03, 1.329850833e-02, 2.357776506e-02,
    3.596078828e-02, 4.921421320e-02, 6.180804176e-02, 7.258278719e-02, 8.081206800e-02])
COARSE = {"participants.solid.mesh-parameters": "{n_side: 80, n_tip: 8}",
          **{f"participants.{name}.mesh-parameters": "{n_side: 40, n_tip: 4, growth: 1.2, wall_growth: 1.2, wall_cells: 8}"
             for name in ("fluid", "mover")}}
ROBIN = {"coupling.order": "structure-first", "participants.fluid.boundaries.flap.surface-density": "2.1"}


def runs(scheme, acceleration, more=(), tolerances=("1e-2", "1e-4", "1e-6")):
    return {tolerance: {"simulation.end-time": "0.2", "simulation.output.interval": "0", "simulation.checkpoint.interval": "0",
                        "participants.fluid.boundaries.inlet.ramp": "0.4", "participants.fluid.pressure-tolerance": "1e-9",
                        "participants.solid.material.density": "42", "coupling.scheme": scheme, "coupling.acceleration.type": acceleration,
                        "coupling.convergence.relative": tolerance, "coupling.convergence.max-iterations": "100", **COARSE, **dict(more)}
            for tolerance in tolerances}


SERIES = {
    "semi-implicit, IQN-ILS": runs("semi-implicit", "iqn-ils"),
    "semi-implicit, Aitken": runs("semi-implicit", "aitken"),
    "semi-implicit, Robin, IQN-ILS": runs("semi-implicit", "iqn-ils", ROBIN),
    "implicit, IQN-ILS": runs("implicit", "iqn-ils"),
    "implicit, Aitken": runs("implicit", "aitken"),
    "implicit on the guessed mesh, IQN-ILS": runs("implicit", "iqn-ils", {"coupling.mesh-on-guess": "true"}),
}


def motion(folder):
    return np.array(couplet.read_csv(folder / "solid" / "probes.csv")["tip x [m]"])[1::2]


def errors(folder):
    tip = motion(folder)
    return {"largest error of the tip over its maximum": np.abs(tip - REFERENCE).max() / np.abs(REFERENCE).max(),
            "passes per step": couplet.passes_a_step(folder), "tip at 0.2 s [m]": tip[-1]}
