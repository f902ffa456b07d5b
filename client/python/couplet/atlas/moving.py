# SPDX-License-Identifier: Apache-2.0
"""Maps of meshes that move far: mesh_mover alone, and gaps of fluid_solver that close."""
import math

import numpy as np

from couplet import series
from couplet.places import ROOT

from .atlas import Axis, Map

CONFIGS = ROOT / "configs"
MOVE = """simulation: {{name: turn, end-time: 1, time-step: 0.05, output: {{folder: out, interval: 1}}}}
participants:
  mover:
    program: mesh_mover
    mesh: square.geo
    mesh-parameters: {{n: 12}}
    dimension: 2
    method: {method}
    form: {form}
    stiffening: {chi}
    stiffening-volumes: {volumes}
    boundaries:
      plate: {{type: moving, motion: {{angle: "{angle}*t"}}}}
      floor: {{type: slip}}
      right: {{type: slip}}
      lid: {{type: slip}}
      left: {{type: slip}}
"""
METHODS = {"laplacian, total": ("laplacian", "total", "reference"), "pseudo-solid, incremental": ("pseudo-solid", "incremental", "current"),
           "rotations, total": ("rotations", "total", "reference")}


def turned(panel, degrees, chi, runner):
    """A plate in a square turned in 20 steps: least scaled Jacobian at the end; the guard refuses what turns over."""
    method, form, volumes = METHODS[panel]
    folder = runner.folder("turned", panel, degrees, chi)
    code, doubted = runner.alone("mesh_mover", folder, {
        "square.geo": (CONFIGS / "moving-mesh" / "square.geo").read_text(),
        "case.yaml": MOVE.format(method=method, form=form, chi=chi, volumes=volumes, angle=np.radians(degrees))})
    file = folder / "out" / "mover" / "quality.csv"
    if code != 0 or not file.exists():
        return float("nan"), code, doubted
    return float(series.read_csv(file)["least scaled Jacobian [1]"][-1]), code, doubted


def closed(panel, left, limit, runner):
    """configs/closing-gap on coarse cells, closed to a share of its height: sub-steps of a step while it is shut."""
    text = (CONFIGS / "closing-gap" / "case.yaml").read_text()
    text = text.replace("time-step: 0.02 s", "time-step: 0.04 s").replace("-0.99*y", f"-{1 - left:g}*y").replace("0.01 Pa s", "0.01 Pa s\n    mesh-parameters: {n: 6}")
    text = text.replace("opening: 0.02 m", f"opening: {0.5 * limit:g} m") if limit > 0 else "\n".join(
        line for line in text.split("\n") if "slot: {between" not in line and line.strip() != "gaps:")
    text = text.replace("viscosity:", f"viscous: {panel}\n    viscosity:")
    folder = runner.folder("closed", panel, left, limit)
    code, doubted = runner.alone("fluid_solver", folder, {"slot.geo": (CONFIGS / "closing-gap" / "slot.geo").read_text(), "case.yaml": text})
    if code != 0:
        return float("nan"), code, doubted
    rows = series.read_csv(folder / "out" / "fluid" / "balance.csv")
    shut = (rows["time [s]"] > 3) & (rows["time [s]"] < 3.5)
    return float(np.mean(rows["sub-steps [-]"][shut])), code, doubted


MAPS = [
    Map("mover-rotation", "Mesh mover: a plate turned in a square", "least scaled Jacobian at the end of 20 steps",
        Axis("angle [degrees]", [15, 30, 45, 60, 90, 120], log=False), Axis("stiffening chi", [0, 1, 2], log=False), list(METHODS), turned,
        lambda j: 0 if j > 0.05 else 0.1 if j > 0 else math.inf,
        about="""Mechanism: cells at the plate's ends are turned by the plate and held by what is around them. Stiffening by volume lets the small cells
follow; the rotations method turns the surroundings with the plate and does not ask chi for it. The guard refuses the mesh that turns over. Pale: above 0 and below 0.05."""),
    Map("fluid-gap", "Fluid: a channel that closes", "sub-steps of a step while it is shut",
        Axis("share of the height that is left", [0.003, 0.01, 0.03, 0.1, 0.3]), Axis("blocked below this share (0: never)", [0, 0.02, 0.04, 0.08], log=False),
        ["implicit"], closed, lambda n: 0 if n <= 10 else 0.1,
        about="""Mechanism: in a film the cells become thin, and the step of convection falls with the speed of
what is pressed out (an explicit viscous one with the square of their height: hours). Blocked cells ask for no step. The failing neighbour is the row 'never'. Pale: over ten sub-steps."""),
]
