# SPDX-License-Identifier: Apache-2.0
"""Light structures in viscous fluids: flaps, the tube, walls of closed fluids."""
import re

import numpy as np

import atlas
from couplet.runs.process import RunFailed
from validation.shapes import WAYS


def cheaper(job, times, keys, than, one):
    """Processor seconds of all programs with the keys `than` over those with `one`; they hold the programs' start."""
    few, many = (job.case("tube-3d", (*keys, *own)) for own in (one, than))
    ratio = many.cost.cpu / few.cost.cpu
    return (
        (
            f"{ratio:.2f} times ({many.cost.cpu:.1f} and {few.cost.cpu:.1f} cpu s; {many.iterations().mean():.1f} and"
            f" {few.iterations().mean():.1f} coupling iterations per step)"
        ),
        bool(ratio >= times),
    )


# -- flap -------------------------------------------------------------------------------------------------------------
END = 0.2  # s; long rows go on to 0.6 s
SMOOTH, FINE = 0.1, 0.0025  # zigzag; s, steps whose tip at the times of longer ones is the flap's own motion


def flap(job, rho, mu, scheme="auto", dt=0.01, end=END):
    """One rung: its results, and where it ended if the mesh did not allow more."""
    keys = (
        f"simulation.end-time={end}",
        f"simulation.time-step={dt}",
        "simulation.max-step-halvings=0",
        f"simulation.output.interval={end}",
        "simulation.checkpoint.interval=0",
        "participants.fluid.boundaries.inlet.ramp=0.4",
        "participants.fluid.pressure-tolerance=1e-8",
        f"participants.fluid.viscosity={mu}",
        f"participants.solid.material.density={rho}",
        f"coupling.scheme={scheme}",
        "coupling.convergence.max-iterations=100",
    )
    try:
        return job.case("perpendicular-flap", keys), ""
    except RunFailed as failure:
        found = re.search(r"from t = ([\d.e-]+) s makes cell \d+ at \([^)]*\) intersect itself", str(failure))
        if not found:
            raise
        return failure.results, f"to {found[1]} s, where the mesh crosses itself: "


def rung(job, rho, mu, dt=0.01, end=END):
    results, ended = flap(job, rho, mu, dt=dt, end=end)
    tip = results.probes("solid")["tip x [m]"]
    value, own = WAYS["zigzag"](tip), 0.0
    # Beyond the short rows' end the bar asks for 0.6 s or what the mesh allows.
    far = len(tip) == round(end / dt) or (ended and end > END and len(tip) * dt >= END)
    cost = "" if ended else f"{results.cost.cpu:.1f} cpu s, "
    if value >= SMOOTH:
        every = round(dt / FINE)
        own = WAYS["zigzag"](
            flap(job, rho, mu, dt=FINE, end=end)[0].probes("solid")["tip x [m]"][every - 1 : every * len(tip) : every]
        )
    return (
        f"{ended}{len(tip)} steps, tip {tip[-1]:.5f} m, {results.iterations().mean():.1f} passes, {cost}zigzag {value:.3f}"
        + (f", its own {own:.3f}" if own else ""),
        bool(far and (value < SMOOTH or value <= 1.2 * own)),
    )


def beside_cheaper(job, rho, mu):
    """Tip within 1 % of implicit at a quarter of the step, cpu beside the cheaper scheme whose tip is there, too."""
    fine = flap(job, rho, mu, "implicit", 0.0025)[0].probes("solid")["tip x [m]"][-1]
    found = {}
    for scheme in ("auto", "semi-implicit", "implicit"):
        try:
            results, ended = flap(job, rho, mu, scheme)
        except RunFailed:
            continue
        if not ended:
            found[scheme] = results.probes("solid")["tip x [m]"][-1] / fine - 1, results.cost.cpu
    cheapest = min(cpu for gap, cpu in found.values() if abs(gap) <= 0.01)
    text = "; ".join(
        (
            f"{scheme} {100 * found[scheme][0]:+.2f} %, {found[scheme][1]:.1f} cpu s"
            if scheme in found
            else f"{scheme} fails"
        )
        for scheme in ("auto", "semi-implicit", "implicit")
    )
    return f"{text} (of {fine:.5f} m)", abs(found["auto"][0]) <= 0.01 and found["auto"][1] <= 1.1 * cheapest


# -- walls ------------------------------------------------------------------------------------------------------------
def volume_of_a_step(job, name, fluid, bound, keys=()):
    volume = job.case(name, keys, timeout=3000).table("coupler", "volume.csv")
    change, inflow = (np.diff(volume[f"{fluid} {what} [m^3]"], prepend=0) for what in ("volume change", "inflow"))
    worst = float(np.max(np.abs(change - inflow)) / np.max(np.abs(inflow)))
    total = float(
        np.max(np.abs(volume[f"{fluid} volume error [m^3]"])) / np.max(np.abs(volume[f"{fluid} inflow [m^3]"]))
    )
    return f"{worst:.1e}, of the whole inflow {total:.1e}, {len(change)} steps", max(worst, total) <= bound


def robin(job, panel, most, inverses):
    """Largest mean number of passes over mass ratios and two decades of steps."""
    runner = atlas.Runner(job.build, job.scratch / f"robin-{panel.replace(' ', '-')}")
    values = {
        (i, dt): atlas.maps()["strong-robin"].run(panel, i, dt, runner)[0]
        for i in inverses
        for dt in (1e-4, 1e-3, 1e-2)
    }
    worst = max(values, key=lambda key: values[key] if np.isfinite(values[key]) else np.inf)
    return (
        f"{values[worst]:.2f} at most, for {worst[0]:g} and steps of {worst[1]:g} s",
        all(np.isfinite(v) for v in values.values()) and values[worst] <= most,
    )
