# SPDX-License-Identifier: Apache-2.0
"""Maps of the coupler: two small participants (tests/coupling/toy), a mass on a spring and a fluid that is an added mass."""
import numpy as np

from couplet import series

from .atlas import Axis, Map

CASE = """simulation: {{end-time: {end}, time-step: {dt}, output: {{folder: out}}}}
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
STEPS = 120
# Each face of 1 kg moves with the mean of its two ends: of the added masses of three vertices, the eigenvalues of B^T B, the largest is
# 0.75 kg.
ADDED, STIFFNESS = 0.75, 3


def run(panel, ratio, dt, runner):
    """Largest velocity over what the energy of the exact motion allows."""
    scheme, order, more = PANELS[panel]
    folder = runner.folder("mass", panel, ratio, dt)
    code, doubted = runner.job(["coupler", "toy_piston", "toy_spring"], folder, {"case.yaml": CASE.format(
        end=STEPS * dt, dt=dt, mass=ratio * ADDED, scheme=scheme, order=order, more=more)})
    if code != 0:
        return float("nan"), code, doubted
    v = series.read_csv(folder / "out" / "fluid" / "motion.csv")["velocity [m/s]"]
    # m v' + k y = F from rest: v never exceeds F / sqrt(k m) of the vertex, with 1/2 N at an end.
    return float(np.max(np.abs(v)) / (1 / np.sqrt(STIFFNESS * ratio * ADDED))), code, doubted


MAPS = [
    Map("coupling-mass", "Coupling: mass of the structure over the added mass", "largest velocity over F/sqrt(k m)",
        Axis("mass over added mass", [0.02, 0.1, 0.3, 0.7, 0.9, 1.1, 2, 10]), Axis("step [s]", [0.01, 0.1, 0.5]), list(PANELS), run, lambda v: max(0, v - 1),
        theory=[(["explicit, predictor 1"], "mass = added mass", [(1, 0.01), (1, 0.5)]),
                (["implicit, relaxation 1"], "mass + k dt^2/4 = added mass",
                 [(1 - STIFFNESS * dt * dt / (4 * ADDED), dt) for dt in np.geomspace(0.01, 0.5, 40)])],
        about="""Mechanism: the structure feels the fluid's inertia one pass late; the error grows by the ratio of the masses each step (explicit) or pass
(relaxation 1), whatever the step. A predictor of second
order looks farther ahead and needs a heavier structure. Aitken and IQN find the factor that holds. The coupler's guards name the mechanism and stop."""),
]
