# SPDX-License-Identifier: Apache-2.0
"""Maps of the coupler: two small participants (tests/coupling/toy), a mass on a spring and a fluid that is an added mass."""
import numpy as np

import couplet_series as series

from .atlas import Axis, Map

CASE = """simulation: {{end-time: {end}, time-step: {dt}, output: {{folder: out}}, max-step-halvings: 0}}
participants:
  fluid: {{program: toy_piston, vertices: 3, added-mass: 1 kg, driving-force: 1 N}}
  solid: {{program: toy_spring, vertices: 3, mass: {mass} kg, stiffness: 3 N/m}}
coupling:
  scheme: {scheme}
  fluid: {{participant: fluid}}
  structure: {{participant: solid}}
  predictor: {{order: {order}}}
  {more}
"""
PANELS = {
    "explicit, predictor 1": ("explicit", 1, ""),
    "explicit, predictor 2": ("explicit", 2, ""),
    "semi-implicit, Aitken": ("semi-implicit", 2, "convergence: {relative: 1e-8, max-iterations: 200}"),
    "implicit, Aitken": ("implicit", 2, "convergence: {relative: 1e-8, max-iterations: 200}"),
    "implicit, relaxation 1": ("implicit", 2,
                               "acceleration: {type: constant, initial-relaxation: 1}\n  convergence: {relative: 1e-8, max-iterations: 200}"),
    "implicit, IQN-ILS": ("implicit", 2, "acceleration: {type: iqn-ils}\n  convergence: {relative: 1e-8, max-iterations: 200}"),
}
STEPS = 60


def run(panel, ratio, dt, runner):
    """Largest velocity over what the energy of the exact motion allows; masses: two faces of 1 kg on three vertices."""
    scheme, order, more = PANELS[panel]
    folder = runner.folder("mass", panel, ratio, dt)
    # Of the middle vertex both halves of its faces push back: its added mass is that of a face.
    code, doubted = runner.job(["coupler", "toy_piston", "toy_spring"], folder, {"case.yaml": CASE.format(
        end=STEPS * dt, dt=dt, mass=ratio, scheme=scheme, order=order, more=more)})
    if code != 0:
        return float("nan"), code, doubted
    v = series.read_csv(folder / "out" / "fluid" / "motion.csv")["velocity [m/s]"]
    # m v' + k y = F from rest: v never exceeds F / sqrt(k m) of the vertex, with 1/2 N at an end.
    return float(np.max(np.abs(v)) / (1 / np.sqrt(3 * ratio))), code, doubted


MAPS = [
    Map("coupling-mass", "Coupling: mass of the structure over the added mass", "largest velocity over F/sqrt(k m)",
        Axis("mass over added mass", [0.02, 0.1, 0.3, 0.7, 1.1, 2, 10]), Axis("step [s]", [0.01, 0.1, 0.5]), list(PANELS), run, lambda v: v < 3,
        theory=[(["explicit, predictor 1", "explicit, predictor 2"], "added mass = mass", [(1, 0.01), (1, 0.5)]),
                (["implicit, relaxation 1"], "added mass = mass", [(1, 0.01), (1, 0.5)])],
        about="""Mechanism: the structure feels the fluid's inertia one pass late; the error grows by the ratio of the masses each step (explicit) or pass
(relaxation 1), whatever the step. Aitken and IQN find the factor that holds. The coupler's guards name the mechanism and stop."""),
]
