# SPDX-License-Identifier: Apache-2.0
"""Runs for scripts/accuracy: meshes with even cells and with cells that are finer towards the walls."""
from plot import gaps

PROGRAM = "fluid_solver"
TITLE = "Lid-driven cavity, Re = 100"


def runs(bump, meshes=(8, 16, 32, 64)):
    return {f"{n}x{n}": {"participants.fluid.mesh-parameters": "{n: %d, bump: %g}" % (n, bump),
                         "simulation.end-time": 16, "simulation.output.interval": 16} for n in meshes}


SERIES = {"even cells": runs(1), "finer towards the walls": runs(0.25)}


def errors(folder):
    found = gaps(folder / "fluid")
    return {"largest error of u or v over the lid's speed": max(found.values()), **found}
