# SPDX-License-Identifier: Apache-2.0
"""Map of viscous coupling: a flap in a channel (configs/perpendicular-flap, coarse) that weighs less and less beside what friction drags along."""
import numpy as np

from couplet import series
from couplet.places import ROOT

from .atlas import Axis, Map
from .strong import changed

CASE = ROOT / "configs" / "perpendicular-flap"
STEPS, VISCOSITY = 24, 1.0
PANELS = {"auto": "auto", "explicit": "explicit", "semi-implicit": "semi-implicit", "implicit": "implicit"}
COARSE = "{n_side: 8, n_tip: 1, growth: 1.5, wall_growth: 1.5, wall_cells: 4}"


def zigzag(x):
    """rms of the third differences over that of the first, of the later half: 0.1 where smooth, 4 where each step turns round."""
    late = x[len(x) // 2 - 1:]
    first, third = np.diff(late), np.diff(late, 3)
    return float(np.sqrt(np.mean(third ** 2)) / max(np.sqrt(np.mean(first ** 2)), 1e-30))


def run(panel, ratio, dt, runner):
    """Zigzag of the tip. `ratio`: rho_s / mu."""
    folder = runner.folder("viscous", panel, ratio, dt)
    text = changed((CASE / "case.yaml").read_text(), (r"end-time: .*", f"end-time: {STEPS * dt}"),
                   (r"time-step: .*", f"time-step: {dt}"), (r"interval: 0.05 s", "interval: 1000 s"), (r"interval: 1 s", "interval: 1000 s"),
                   (r"density: 3000 kg/m\^3", f"density: {ratio * VISCOSITY}"), (r"coupling:\n", f"coupling:\n  scheme: {PANELS[panel]}\n"),
                   (r"inlet, velocity: \[10 m/s, 0 m/s\]", f"inlet, velocity: [1 m/s, 0 m/s], ramp: {STEPS * dt}"),
                   (r"max-iterations: 30", "max-iterations: 100"), (r"initial-relaxation: 1", "initial-relaxation: 0.3"),
                   (r"(solid:\n    program: solid_solver)\n    mesh: solid.geo", r"\1\n    mesh: solid.geo\n    mesh-parameters: {n_side: 16, n_tip: 2}"),
                   (r"(fluid:\n    program: fluid_solver\n    mesh: fluid.geo)", rf"\1\n    mesh-parameters: {COARSE}"),
                   (r"(mover:\n    program: mesh_mover\n    mesh: fluid.geo)", rf"\1\n    mesh-parameters: {COARSE}"))
    files = {"case.yaml": text, **{f: (CASE / f).read_text() for f in ("fluid.geo", "solid.geo")}}
    code, doubted = runner.job(["coupler", "fluid_solver", "solid_solver", "mesh_mover"], folder, files)
    return (zigzag(series.read_csv(folder / "out/solid/probes.csv")["tip x [m]"]) if code == 0 else float("nan")), code, doubted


MAPS = [
    Map("coupling-viscous", "Coupling: a light structure in a viscous fluid", "zigzag of the tip: third over first differences",
        Axis("rho_s / mu [s/m^2]", [1, 10, 100, 1000, 10000]), Axis("step [s]", [1e-4, 1e-3, 1e-2]), list(PANELS), run,
        lambda v: 0 if v < 1 else 0.1 if v < 2 else np.inf,
        about="""Mechanism: friction drags a layer of fluid along with the wall, of the thickness sqrt(nu dt) at most that of a cell. What takes it at a guessed
velocity (explicit, and semi-implicit before its friction followed the wall's velocity of the pass) oscillates with a period of two steps
where that layer weighs more than the wall: light structures, viscous fluids; a smaller step is no cure. Criterion: below 2 no oscillation from
step to step (one that turns round in each has 4); from 1 up it is pale. rho_f = 1, mu = 1. In short steps the explicit scheme ends
whatever the density: between the wall and the first cell's centre lies half a cell h of solid without mass, which gives way at once, and
rho_f L h/(2 (lambda + 2 mu_s) dt^2) takes the place of the mass ratio (the run measures 2.3 at 1e-4 s and 1e4 s/m^2)."""),
]
