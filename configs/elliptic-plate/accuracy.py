# SPDX-License-Identifier: Apache-2.0
"""Runs for scripts/couplet accuracy: meshes, the least-squares and the corrected face gradient, methods, tolerances."""
import nine_points

PROGRAM = "solid_solver"
TITLE = "Thick elliptic plate"
MESHES = ((4, 6, 3), (8, 12, 6), (16, 24, 12), (32, 48, 24), (64, 96, 48))


def runs(method, meshes=MESHES):
    """Settings of each mesh; `method`: the keys of solution-method."""
    points = {}
    for mesh in meshes:
        points["x".join(map(str, mesh))] = {
            "participants.solid.mesh-parameters": "{nr: %d, nt: %d, nz: %d}" % mesh,
            "participants.solid.solution-method": "{%s}" % method}
    return points


SERIES = {
    "newton-krylov, corrected, 1e-4": runs("type: newton-krylov, face-gradient: corrected, relative-tolerance: 1e-4"),
    "newton-krylov, corrected, 1e-8": runs("type: newton-krylov, face-gradient: corrected, relative-tolerance: 1e-8"),
    "newton-krylov, thesis, 1e-8": runs("type: newton-krylov, face-gradient: thesis, relative-tolerance: 1e-8"),
    "segregated with Anderson, thesis, 1e-6": runs(
        "type: segregated, face-gradient: thesis, acceleration: anderson, relative-tolerance: 1e-6", MESHES[:4]),
    "segregated with Aitken, thesis, 1e-6": runs(
        "type: segregated, face-gradient: thesis, acceleration: aitken, relative-tolerance: 1e-6", MESHES[:4]),
    "block-coupled (ILU), thesis, 1e-6": runs(
        "type: block-coupled, face-gradient: thesis, linear-solver: bicgstab-ilu, relative-tolerance: 1e-6", MESHES[:4]),
}


def errors(folder):
    u, stress, cells = nine_points.errors(folder / "solid")
    return {"error of the displacement": u, "error of the von Mises stress": stress, "cells": cells}
