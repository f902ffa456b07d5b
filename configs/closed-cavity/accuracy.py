# SPDX-License-Identifier: Apache-2.0
"""Runs for scripts/couplet accuracy: schemes, accelerations and steps of a closed box under a light lid; to 0.4 s, on 8 x 8 cells."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "client/python"))
import couplet  # noqa: E402

TITLE = "Closed box under an elastic lid"
LID = 0.020633703  # [m], its middle at 0.4 s: this case, semi-implicit with the level and IQN-ILS, steps of 1.25 ms
MESHES = {f"participants.{name}.mesh-parameters": "{n: 8}" for name in ("fluid", "lid", "mover")}
ROBIN = {"coupling.order": "structure-first", "participants.fluid.volume-level": "none",
         "participants.fluid.boundaries.lid.surface-density": "50"}


def runs(scheme, acceleration, more=(), steps=(0.04, 0.02, 0.01)):
    return {f"{1e3 * dt:g} ms": {"simulation.time-step": str(dt), "simulation.end-time": "0.4", "simulation.output.interval": "0",
                                 "coupling.scheme": scheme, "coupling.acceleration.type": acceleration, **MESHES, **dict(more)}
            for dt in steps}


SERIES = {
    "semi-implicit, level, IQN-ILS": runs("semi-implicit", "iqn-ils"),
    "semi-implicit, level, Aitken": runs("semi-implicit", "aitken"),
    "semi-implicit, Robin, IQN-ILS": runs("semi-implicit", "iqn-ils", ROBIN),
    "implicit, level, IQN-ILS": runs("implicit", "iqn-ils"),
    "implicit, level, Aitken": runs("implicit", "aitken"),
    "implicit on the guessed mesh, level, IQN-ILS": runs("implicit", "iqn-ils", {"coupling.mesh-on-guess": "true"}),
}


def errors(folder):
    lid = couplet.read_csv(folder / "lid" / "probes.csv")["middle y [m]"][-1]
    return {"relative error of the lid's middle": abs(lid / LID - 1), "passes per step": couplet.passes_a_step(folder), "lid [m]": lid}
