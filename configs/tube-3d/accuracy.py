# SPDX-License-Identifier: Apache-2.0
"""Runs for scripts/couplet accuracy: schemes, accelerations and tolerances of the elastic tube, 20 steps of 0.2 ms on a coarse mesh. Within a
series only the error of early stopping differs; implicit and semi-implicit differ by their splitting, too."""
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "client/python"))
import couplet  # noqa: E402

TITLE = "Elastic tube: coupling error at 0.2 ms"
# Radial motion of A [m] at 0.4, 0.8, ... 4 ms: this case on this mesh, implicit, IQN-ILS, relative 1e-10, the same steps
REFERENCE = np.array([
    2.766812695e-09, 1.809133302e-08, 7.753537044e-08, 2.808997142e-07, 7.175156917e-07,
    9.278079400e-07, 2.061138872e-06, 9.338077321e-06, 1.440609471e-05, 7.176026755e-06])
COARSE = {**{f"participants.{name}.mesh-parameters": "{n: 3, n_ring: 2, n_z: 30}" for name in ("fluid", "mover")},
          "participants.solid.mesh-parameters": "{n: 3, n_wall: 2, n_z: 30}"}
ROBIN = {"coupling.order": "structure-first", "participants.fluid.boundaries.wall.surface-density": "1.2"}  # 1200 kg/m^3, 1 mm


def runs(scheme, acceleration, more=(), tolerances=("1e-2", "1e-4", "1e-6")):
    return {tolerance: {"simulation.time-step": "0.2 ms", "simulation.end-time": "4 ms", "simulation.output.interval": "0",
                        "simulation.checkpoint.interval": "0", "participants.fluid.pressure-tolerance": "1e-9",
                        "coupling.scheme": scheme, "coupling.acceleration.type": acceleration,
                        "coupling.convergence.relative": tolerance, **COARSE, **dict(more)} for tolerance in tolerances}


SERIES = {
    "semi-implicit, IQN-ILS": runs("semi-implicit", "iqn-ils"),
    "semi-implicit, Aitken": runs("semi-implicit", "aitken"),
    "semi-implicit, Robin, IQN-ILS": runs("semi-implicit", "iqn-ils", ROBIN),
    "implicit, IQN-ILS": runs("implicit", "iqn-ils"),
    "implicit, Aitken": runs("implicit", "aitken"),
    "implicit, Robin, IQN-ILS": runs("implicit", "iqn-ils", ROBIN),
}


def motion(folder):
    return np.array(couplet.read_csv(folder / "solid" / "probes.csv")["A y [m]"])[1::2]


def errors(folder):
    y = motion(folder)
    return {"largest error of A's radial motion over its maximum": np.abs(y - REFERENCE).max() / np.abs(REFERENCE).max(),
            "passes per step": couplet.passes_a_step(folder), "A at 4 ms [m]": y[-1]}
