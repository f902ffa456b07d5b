# SPDX-License-Identifier: Apache-2.0
"""Runs for scripts/couplet accuracy: meshes with even cells and with cells that are finer towards the walls."""
import pathlib
import sys

import numpy as np
from matplotlib.tri import LinearTriInterpolator, Triangulation

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parents[1] / "client/python"))
import couplet  # noqa: E402

PROGRAM = "fluid_solver"
TITLE = "Lid-driven cavity, Re = 100"


def runs(bump, meshes=(8, 16, 32, 64)):
    return {f"{n}x{n}": {"participants.fluid.mesh-parameters": "{n: %d, bump: %g}" % (n, bump),
                         "simulation.end-time": 16, "simulation.output.interval": 16} for n in meshes}


SERIES = {"even cells": runs(1), "finer towards the walls": runs(0.25)}


def reference(file, reynolds):
    rows = [line.split(",") for line in (here / "reference" / file).read_text().splitlines() if line[0] != "#"]
    column = next(i for i, name in enumerate(rows[0]) if name.endswith(f"_Re{reynolds}"))
    misprint = "0.9063" if reynolds == 400 else ""  # of v in the printed table: far off its neighbours
    return np.array([[float(r[0]), float(r[column])] for r in rows[1:] if r[0] != misprint]).T


def centre_lines(series):
    """u(y) at x = 0.5 and v(x) at y = 0.5 of the last time, linear between cell centres and walls."""
    i = len(series.times) - 1
    points, velocity = series.coordinates(i), series.field(i, "velocity")
    centres = np.array([points[c].mean(axis=0)[:2] for c in series.cells])
    edges = points[series.edges_on_boundary()].mean(axis=1)[:, :2]
    lid = np.where(edges[:, 1] > 1 - 1e-9, 1.0, 0.0)
    places = np.vstack([centres, edges])
    mesh = Triangulation(*places.T)
    u = LinearTriInterpolator(mesh, np.concatenate([velocity[:, 0], lid]))
    v = LinearTriInterpolator(mesh, np.concatenate([velocity[:, 1], 0 * lid]))
    s = np.linspace(0.001, 0.999, 400)
    return s, np.asarray(u(0 * s + 0.5, s)), np.asarray(v(s, 0 * s + 0.5))


def gaps(folder, reynolds=100):
    """Largest differences of u and v to Ghia on the two centre lines, in speeds of the lid."""
    s, u, v = centre_lines(couplet.find_series(folder))
    found = {}
    for name, line, file in (("u", u, "ghia_u_x0.5.csv"), ("v", v, "ghia_v_y0.5.csv")):
        place, wanted = reference(file, reynolds)
        inside = (place > 0.001) & (place < 0.999)
        found[name] = np.abs(np.interp(place[inside], s, line) - wanted[inside]).max()
    return found


def errors(folder):
    found = gaps(folder / "fluid")
    return {"largest error of u or v over the lid's speed": max(found.values()), **found}
