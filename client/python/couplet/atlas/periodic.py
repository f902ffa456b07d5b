# SPDX-License-Identifier: Apache-2.0
"""Map of a flow that repeats: a pulsating force in a channel (Womersley), on the mesh of configs/pulsing-channel."""
import numpy as np

from couplet import series
from couplet.places import ROOT

from .atlas import Axis, Map

CASE = """simulation: {{name: womersley, end-time: {end}, time-step: {dt}, output: {{folder: out, interval: {end}}}}}
participants:
  fluid:
    program: fluid_solver
    mesh: channel.geo
    mesh-parameters: {{n: 16}}
    dimension: 2
    density: 1
    viscosity: {mu}
    viscous: {viscous}
    body-force: ["0.2 + cos(2*pi*t)", 0]
    boundaries:
      inlet: {{type: periodic, partner: outlet}}
      outlet: {{type: periodic, partner: inlet}}
      walls: {{type: no-slip}}
    probes: {{low: {{point: [2, 0.03]}}, quarter: {{point: [2, 0.2]}}, middle: {{point: [2, 0.5]}}}}
"""
PERIODS, FINE = 4, 320


def pulses(panel, steps, alpha, runner):
    """Velocities of the last period, a row per time."""
    folder = runner.folder("pulses", panel, steps, alpha)
    code, doubted = runner.alone("fluid_solver", folder, {
        "channel.geo": (ROOT / "configs/pulsing-channel/channel.geo").read_text(),
        "case.yaml": CASE.format(end=PERIODS, dt=1 / steps, mu=0.5 * np.pi / alpha ** 2, viscous=panel)})
    if code != 0:
        return None, code, doubted
    rows = series.read_csv(folder / "out" / "fluid" / "probes.csv")
    late = rows["time [s]"] > PERIODS - 1 + 1e-9
    return np.array([rows[k][late] for k in rows if "x [m/s]" in k]).T, code, doubted


def repeats(panel, steps, alpha, runner):
    """Largest difference of the profile from that of 320 steps per period, over the largest profile."""
    found, code, doubted = pulses(panel, int(steps), alpha, runner)
    fine, *_ = runner.once(alpha, lambda: pulses("auto", FINE, alpha, runner))
    if found is None:
        return float("nan"), code, doubted
    at = fine[round(FINE / steps) - 1::round(FINE / steps)]
    return float(np.linalg.norm(found - at, axis=1).max() / np.linalg.norm(at, axis=1).max()), code, doubted


MAPS = [
    Map("fluid-periodic", "Fluid: a flow that repeats", "largest difference of the profile from that of short steps",
        Axis("steps per period", [5, 10, 20, 40, 80]), Axis("Womersley number alpha", [1, 3, 10, 30]), ["auto", "implicit"], repeats, lambda e: e,
        about="""Mechanism: a force that pulsates is met at the middle of each step, and layers of thickness 1/alpha follow it. Criterion: the profile
in the fourth period, beside the same mesh with 320 steps per period. No phase is lost from period to period where a clock drives the flow."""),
]
