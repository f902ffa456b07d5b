# SPDX-License-Identifier: Apache-2.0
"""Heat in the fluid and between programs."""
import json
import re
import sys

PLATE, CAVITY = "heated-plate", "heated-cavity"
WATCH = ("simulation.output.interval=1e6", "simulation.checkpoint.interval=1e6")


def conjugate(job, **limits):
    """Numbers of tests/coupling/conjugate/conjugate.py by patterns of their claims, each at most the limit."""

    def make():
        file = job.scratch / "conjugate.json"
        job.run(
            [sys.executable, job.root / "tests/coupling/conjugate/conjugate.py", job.build / "bin", "all", file], 3600
        )
        return json.loads(file.read_text())

    said, met = [], []
    for pattern, limit in limits.items():
        found = {k: v for k, v in job.once("conjugate", make)["numbers"].items() if re.search(pattern, k)}
        said += [f"{v:.3g}" + (" in the worst step" if k.endswith("most") else "") for k, v in found.items()]
        judged = [v for k, v in found.items() if not k.endswith("most")]
        met.append(bool(judged) and max(judged) <= limit)
    return "; ".join(said), all(met)


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


def nusselt(run):
    return float(run.table("fluid", "heat.csv")["hot [W]"][-1]) / 0.25827


def steady(job):
    """A plate whose temperature takes much longer than the flow: all steps of 0.2 s, or the temperature alone after 40 s in steps of 10 s.
    A cavity: internal waves limit its steps."""
    slow = (
        *WATCH,
        "participants.plate.material.density=100",
        "simulation.end-time=4000",
        "simulation.until-steady=1e-4",
    )
    plates = [
        job.case(PLATE, slow),
        job.case(PLATE, (*slow, "simulation.time-step=10", "participants.fluid.heat.frozen-flow=40")),
    ]
    heat = [float(run.table("coupler", "amounts.csv")["plate takes heat [W]"][-1]) for run in plates]
    rest = (*WATCH, "simulation.end-time=100", "simulation.until-steady=1e-4")
    cavities = [job.case(CAVITY, rest), job.case(CAVITY, (*rest, ".courant=50", "simulation.time-step=0.4"))]
    ratios = [a.cost.cpu / b.cost.cpu for a, b in (plates, cavities)]
    said = (
        f"{ratios[0]:.1f} ({plates[0].cost.cpu:.1f} s, {heat[0]:.2f} W; {plates[1].cost.cpu:.1f} s, {heat[1]:.2f} W);"
        f" {ratios[1]:.1f} ({cavities[0].cost.cpu:.1f} s, Nusselt number {nusselt(cavities[0]):.4f};"
        f" {cavities[1].cost.cpu:.1f} s, {nusselt(cavities[1]):.4f})"
    )
    return said, bool(min(ratios) >= 5 and abs(heat[1] / heat[0] - 1) < 1e-3)
