# SPDX-License-Identifier: Apache-2.0
"""Map of a soft flap whose mesh follows it: configs/perpendicular-flap on coarse cells, at large strain."""
import math

import numpy as np

from couplet import series
from couplet.places import ROOT

from .atlas import Axis, Map
from .strong import changed

CASE = ROOT / "configs" / "perpendicular-flap"
MOVERS = {"auto": "", "laplacian": "\n    method: laplacian", "pseudo-solid": "\n    method: pseudo-solid",
          "pseudo-solid, incremental": "\n    method: pseudo-solid\n    form: incremental\n    stiffening-volumes: current"}
END, FINE = 0.8, 0.01  # [s]; the step of the reference
COARSE = "{n_side: 8, n_tip: 1, growth: 1.5, wall_growth: 1.5, wall_cells: 4}"


def deflection(mover, modulus, dt, runner):
    """Largest displacement of the tip over the height of the flap, 1 m."""
    folder = runner.folder("soft", mover, modulus, dt)
    text = changed((CASE / "case.yaml").read_text(), (r"end-time: .*", f"end-time: {END}"), (r"time-step: .*", f"time-step: {dt}"),
                   (r"interval: 0.05 s", "interval: 1000 s"), (r"interval: 1 s", "interval: 1000 s"), (r"youngs-modulus: 4 MPa", f"youngs-modulus: {modulus:g} Pa"),
                   (r"density: 3000 kg/m\^3", "density: 300 kg/m^3"),
                   (r"analysis: dynamic", "analysis: dynamic\n    kinematics: finite-strain"),
                   (r"(solid:\n    program: solid_solver)\n    mesh: solid.geo", r"\1\n    mesh: solid.geo\n    mesh-parameters: {n_side: 16, n_tip: 2}"),
                   (r"(fluid:\n    program: fluid_solver\n    mesh: fluid.geo)", rf"\1\n    mesh-parameters: {COARSE}"),
                   (r"(mover:\n    program: mesh_mover\n    mesh: fluid.geo)", rf"\1\n    mesh-parameters: {COARSE}{MOVERS[mover]}"))
    files = {"case.yaml": text, **{f: (CASE / f).read_text() for f in ("fluid.geo", "solid.geo")}}
    code, doubted = runner.job(["coupler", "fluid_solver", "solid_solver", "mesh_mover"], folder, files)
    if code != 0:
        return math.nan, code, doubted
    rows = series.read_csv(folder / "out/solid/probes.csv")
    return float(np.max(np.hypot(rows["tip x [m]"], rows["tip y [m]"]))), code, doubted


def run(mover, modulus, dt, runner):
    value, code, doubted = deflection(mover, modulus, dt, runner)
    if code != 0:
        return value, code, doubted
    fine, *_ = runner.once(modulus, lambda: deflection("pseudo-solid, incremental", modulus, FINE, runner))
    return value, code, doubted, abs(value / fine - 1)


MAPS = [
    Map("coupling-soft", "Coupling: a soft flap whose mesh follows it", "largest displacement of the tip over its height",
        Axis("Young's modulus [Pa]", [2e5, 5e5, 1e6, 4e6]), Axis("step [s]", [0.02, 0.04, 0.08]), list(MOVERS), run,
        about="""Mechanism: the softer the flap (configs/perpendicular-flap on coarse cells, 300 kg/m^3, at large strain), the farther its tip goes and the more the cells around it
are sheared and turned, until one folds, with the methods `laplacian` and `pseudo-solid`; shorter steps do not help, `form: incremental` does for a while. The default,
`auto`, continues with the barrier. Criterion: beside steps of 0.01 s with the incremental mesh. A run that stops names the cell that folds."""),
]
