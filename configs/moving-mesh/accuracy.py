# SPDX-License-Identifier: Apache-2.0
"""Runs for scripts/couplet accuracy: what each method of mesh motion leaves of the cells against its time. A plate is turned by 30 degrees."""
import couplet

PROGRAM = "mesh_mover"
TITLE = "Plate in a square turned by 30 degrees in 50 steps"
MESHES = (8, 16, 32)


def runs(method, form, volumes):
    return {f"n {n}": {"participants.mover.mesh-parameters": "{n: %d}" % n, "participants.mover.method": method, "participants.mover.form": form,
                       "participants.mover.stiffening-volumes": volumes, "participants.mover.boundaries.plate.motion": '{angle: "pi/6*t"}'}
            for n in MESHES}


SERIES = {"laplacian, total": runs("laplacian", "total", "reference"), "rotations, total": runs("rotations", "total", "reference"),
          "pseudo-solid, total": runs("pseudo-solid", "total", "reference"), "pseudo-solid, incremental": runs("pseudo-solid", "incremental", "current")}


def errors(folder):
    rows = couplet.read_csv(folder / "mover" / "quality.csv")
    return {"1 - least scaled Jacobian": 1 - float(rows["least scaled Jacobian [1]"][-1]), "largest f_AR": float(rows["largest f_AR [1]"][-1])}
