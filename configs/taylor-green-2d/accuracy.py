# SPDX-License-Identifier: Apache-2.0
"""Runs for scripts/couplet accuracy: face values of second and of fourth order, on meshes refined with the step."""
import pathlib
import sys

import numpy as np

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parents[1] / "client/python"))
import couplet  # noqa: E402

PROGRAM = "fluid_solver"
TITLE = "Taylor-Green vortices in a periodic square, t = 2 s"
VISCOSITY, END = 0.05, 2.0


def runs(order, meshes):
    fluid = "participants.fluid."
    return {f"{n}x{n}": {fluid + "mesh-parameters": f"{{n: {n}}}", "simulation.end-time": END, "simulation.time-step": min(0.25, 3.2 / n), "simulation.output.interval": END,
                         fluid + "face-values": order, fluid + "projection": "incremental", fluid + "scheme": "runge-kutta",
                         fluid + "pressure-tolerance": 1e-8} for n in meshes}


SERIES = {"second order": runs("second-order", (8, 16, 32, 64, 128)), "fourth order": runs("fourth-order", (8, 16, 32, 64))}


def errors(folder):
    """Root mean square and largest error of the velocity, over the largest speed at that time."""
    series = couplet.find_series(folder / "fluid")
    last = len(series.times) - 1
    x, y = series.centres()[:, :2].T
    decay = np.exp(-2 * VISCOSITY * series.times[last])
    exact = decay * np.stack([np.sin(x) * np.cos(y), -np.cos(x) * np.sin(y)], axis=1)
    off = np.linalg.norm(series.field(last, "velocity")[:, :2] - exact, axis=1) / decay
    return {"error of the velocity (root mean square over the largest speed)": float(np.sqrt((off**2).mean())), "largest": float(off.max())}
