# SPDX-License-Identifier: Apache-2.0
"""Runs for scripts/couplet accuracy: meshes of 16 to 48 cells over the height, each until the flow stands."""
from lengths import GARTLING, lengths

PROGRAM = "fluid_solver"
TITLE = "Flow behind a step, Re = 800"
SERIES = {"cells over the height": {f"{n}": {"participants.fluid.mesh-parameters": "{n: %d}" % n} for n in (16, 24, 32, 48)}}


def errors(folder):
    found = lengths(folder / "fluid")
    off = {name: abs(found[name] / wanted - 1) for name, wanted in GARTLING.items()}
    return {"largest error of a length over Gartling's": max(off.values()), **off}
