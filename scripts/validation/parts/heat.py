# SPDX-License-Identifier: Apache-2.0
"""Heat in the fluid and between programs."""
import json
import re
import sys

import numpy as np

PLATE, CAVITY = "heated-plate", "heated-cavity"
WATCH = ("simulation.output.interval=1e6", "simulation.checkpoint.interval=1e6")


def conjugate(job, pattern, limit):
    """Numbers of tests/coupling/conjugate/conjugate.py by their claims, each at most `limit`."""

    def make():
        file = job.scratch / "conjugate.json"
        job.run(
            [sys.executable, job.root / "tests/coupling/conjugate/conjugate.py", job.build / "bin", "all", file], 3600
        )
        return json.loads(file.read_text())

    numbers = {k: v for k, v in job.once("conjugate", make)["numbers"].items() if re.search(pattern, k)}
    judged = [v for k, v in numbers.items() if not k.endswith("most")]
    return "; ".join(
        f"{v:.3g}" + (" in the worst step" if k.endswith("most") else "") for k, v in numbers.items()
    ), bool(judged and max(judged) <= limit)


def surface(job, n, *keys):
    """Temperature in the middle of the plate's surface, from 0 of the inflow to 1 of its lower side."""
    sizes = [f"participants.{who}.mesh-parameters.n={n}" for who in ("fluid", "plate")]
    return (float(job.case(PLATE, (*WATCH, *sizes, *keys)).probes("plate")["middle temperature [K]"][-1]) - 300) / 10


def interface(job):
    said, worst = [], 0
    for ratio in (1, 5, 20):
        a, b, c = (surface(job, n, f"participants.plate.material.conductivity={100 * ratio}") for n in (20, 40, 80))
        limit = c + (c - b) / 3
        worst = max(worst, abs(b / limit - 1))
        said.append(f"{ratio}: {a:.4f}, {b:.4f}, {c:.4f} ({100 * (b / limit - 1):+.2f} %)")
    return "; ".join(said), bool(worst <= 0.03)


def slow_plate(job):
    """A plate whose temperature takes much longer than the flow: all steps of 0.2 s, or the temperature alone after 40 s in steps of 10 s."""
    slow = (
        *WATCH,
        "participants.plate.material.density=100",
        "simulation.end-time=4000",
        "simulation.until-steady=1e-4",
    )
    runs = {
        "marching": job.case(PLATE, slow),
        "frozen": job.case(PLATE, (*slow, "simulation.time-step=10", "participants.fluid.heat.frozen-flow=40")),
    }
    heat = {name: float(run.table("coupler", "amounts.csv")["plate takes heat [W]"][-1]) for name, run in runs.items()}
    time = {name: run.cost.cpu for name, run in runs.items()}
    ratio = time["marching"] / time["frozen"]
    said = "; ".join(f"{name} {time[name]:.1f} s, {heat[name]:.2f} W" for name in runs)
    return f"{ratio:.1f} ({said})", bool(ratio >= 5 and abs(heat["frozen"] / heat["marching"] - 1) < 1e-3)


def nusselt(run):
    return float(run.table("fluid", "heat.csv")["hot [W]"][-1]) / 0.25827


def steady_cavity(job):
    steady = (*WATCH, "simulation.end-time=100", "simulation.until-steady=1e-4")
    runs = {
        "default": job.case(CAVITY, steady),
        "courant 50": job.case(CAVITY, (*steady, ".courant=50", "simulation.time-step=0.4")),
    }
    ratio = runs["default"].cost.cpu / runs["courant 50"].cost.cpu
    said = "; ".join(f"{name} {run.cost.cpu:.1f} s, Nusselt number {nusselt(run):.4f}" for name, run in runs.items())
    return f"{ratio:.1f} ({said}); internal waves limit the steps", bool(ratio >= 5)


def cavity_estimate(job):
    """The run estimates no error of a heat flow; that of the temperature stands beside it."""
    run = job.case(CAVITY, WATCH)
    told = re.findall(r"heat hot +(.*)", run.log)
    off = nusselt(run) / 4.5216 - 1
    return f"off by {100 * off:+.2f} %, told: {told[-1] if told else 'nothing'}", bool(
        told and "unknown" not in told[-1]
    )
