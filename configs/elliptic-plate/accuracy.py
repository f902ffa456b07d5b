# SPDX-License-Identifier: Apache-2.0
"""Runs for scripts/accuracy: the thesis's meshes and one finer, thesis's and corrected face gradient, methods, tolerances."""
import nine_points

PROGRAM = "solid_solver"
TITLE = "Thick elliptic plate"
MESHES = ((4, 6, 3), (8, 12, 6), (16, 24, 12), (32, 48, 24))


def runs(method, meshes=MESHES):
    """Settings of each mesh; `method`: the keys of solution-method."""
    points = {}
    for mesh in meshes:
        points["x".join(map(str, mesh))] = {
            "participants.solid.mesh-parameters": "{nr: %d, nt: %d, nz: %d}" % mesh,
            "participants.solid.solution-method": "{%s}" % method}
    return points


SERIES = {
    "block-coupled": runs("type: block-coupled, linear-solver: bicgstab-ilu, relative-tolerance: 1e-6"),
}


def errors(folder):
    u, stress, cells = nine_points.errors(folder / "solid")
    return {"error of the displacement": u, "error of the von Mises stress": stress, "cells": cells}
