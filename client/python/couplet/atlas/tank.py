# SPDX-License-Identifier: Apache-2.0
"""Maps of thermocline."""
import numpy as np

from .atlas import Axis, Map

CASE = """simulation: {{name: bed, end-time: 4050, time-step: 4050, output: {{folder: out}}}}
participants:
  tank:
    program: thermocline
    diameter: 1.1283791671 m
    fluid: {{type: custom, density: 1800, specific-heat: 1500, temperature: [200 K, 500 K], conductivity: [0.5, 0.5], viscosity: [1.0e-3, 1.0e-3]}}
    filler: {{density: 2500, specific-heat: 900, conductivity: {conductivity}}}
    exchange-step: {step}
    bed:
      cells: {cells}
      advection: {advection}
      initial-temperature: 300 K
      shells: {shells}
      layers: [{{height: 5 m, porosity: 0.4, diameter: 20 mm}}]
      closures: {{conduction: constant, conductivity: 0, film-coefficient: {film}}}
    flow:
      type: schedule
      rows: [{{at: 0 s, mass-flow: 1 kg/s, inlet-temperature: 400 K}}]
"""


def bounds(folder):
    """How far any temperature lies outside of [300 K, 400 K], over the range."""
    rows = np.genfromtxt(folder / "out" / "tank" / "bed.csv", delimiter=",", skip_header=1)
    t = rows[rows[:, 0] > 0][:, 2:] + 273.15
    return float(max(0, np.max(t) - 400, 300 - np.min(t)) / 100)


def run(runner, key, **values):
    given = dict(conductivity=1e7, step=60, cells=200, advection="tvd", shells=1, film=33.3333) | values
    folder = runner.folder(*key)
    code, doubted = runner.alone("thermocline", folder, {"case.yaml": CASE.format(**given)})
    return (bounds(folder) if code == 0 else float("nan")), code, doubted, folder


def front(advection, step, transfer, runner):
    """A hot fluid enters a cold bed. `transfer`: heights of a cell in the length of the front, G c/(h a)."""
    return run(runner, ("front", advection, step, transfer), advection=advection, step=step, film=8.3333 * 40 / transfer)[:3]


def profile(folder):
    rows = np.genfromtxt(folder / "out" / "tank" / "bed.csv", delimiter=",", skip_header=1)
    return rows[rows[:, 0] == rows[-1, 0]][:, 2]


def resolved(runner, biot):
    *_, folder = run(runner, ("grains", "reference", biot), shells=20, step=1, conductivity=333.333 * 0.01 / biot, film=333.333)
    return profile(folder)


def grains(shells, step, biot, runner):
    """`biot`: film radius over conductivity; the film stays, the conductivity falls. Mean difference of the fluid's last profile from
    that of 20 shells, over the range; infinite out of bounds."""
    out, code, doubted, folder = run(runner, ("grains", shells, step, biot), shells=int(shells.split()[0]), step=step,
                                     conductivity=333.333 * 0.01 / biot, film=333.333)
    if code != 0 or out > 1e-6:
        return float("inf"), code, doubted
    return float(np.mean(np.abs(profile(folder) - runner.once(biot, lambda: resolved(runner, biot)))) / 100), code, doubted


MAPS = [
    Map("tank-front", "Tank: sharpness of the front", "temperatures outside of their bounds, over the range",
        Axis("exchange step [s]", [1, 10, 60, 300, 1000]), Axis("length of the front in cells", [0.1, 1, 4, 10, 40]), ["upwind", "tvd", "implicit"],
        front, lambda v: v,
        about="""Mechanism: a scheme of higher order overshoots at a steep front. Criterion: no temperature outside of the inlet's and the start's. The bed
divides the exchange step by its own Courant limit; `implicit` takes it whole."""),
    Map("tank-biot", "Tank: Biot number of the grains", "mean difference of the fluid from 20 shells, over the range",
        Axis("exchange step [s]", [1, 10, 60, 300, 1000]), Axis("Biot number", [0.01, 0.1, 1, 10, 100]), ["1 shell", "5 shells", "10 shells"],
        grains, lambda v: v,
        about="""Mechanism: heat goes between film and grain faster than a step follows. The grains are eliminated implicitly: no step is too long. One
shell takes a parabola inside a grain: good to 0.1 % up to a Biot number of 10; a run warns from 20.
The bounds are kept, or the square is infinitely wrong."""),
]
