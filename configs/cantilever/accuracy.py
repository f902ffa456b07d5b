# SPDX-License-Identifier: Apache-2.0
"""Runs for scripts/couplet accuracy: meshes of cubes, direct and iterative solves."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "client/python"))
import couplet  # noqa: E402

PROGRAM = "solid_solver"
TITLE = "Cantilever under a transverse load"
TIP = 0.10008  # [m], converged three-dimensional finite elements


def runs(method, sides=(2, 4, 8, 16)):
    return {f"{10 * n}x{n}x{n}": {"participants.solid.mesh-parameters": "{n_length: %d, n_side: %d}" % (10 * n, n),
                                  "participants.solid.solution-method": "{%s}" % method} for n in sides}


SERIES = {
    "direct": runs("type: block-coupled, linear-solver: direct", (2, 4, 8)),
}


def errors(folder):
    tip = couplet.read_csv(folder / "solid" / "probes.csv")["tip y [m]"][-1]
    return {"relative error of the tip's displacement": abs(tip / TIP - 1), "tip [m]": tip}
