# SPDX-License-Identifier: Apache-2.0
"""The coupled benchmarks: the plate of Turek and Hron, a cavity, lock-in, the wave in a tube."""
import math

import numpy as np

from couplet.runs.process import launch
from couplet.study.fits import limit_of
from couplet.study.quantities import top


# -- Turek and Hron
# -----------------------------------------------------------------------------------------------------
PLATE = {
    12: "{nx: 60, ny: 10}",
    17: "{nx: 85, ny: 14}",
    24: "{nx: 120, ny: 20}",
}  # mesh-parameters of the plate for n of the fluid


def turek_hron(job, case, keys, name, right, percent, of, drift=0.5):
    """One of the published quantities on meshes of which each has 2^(1/2) times as many cells along a side as the one
    before, and with its own keys, such as a step that shrinks alike. The finest is beside the published value, or
    within the spread of the published (Featflow's last levels), and three meshes are within `drift` percent of what
    they tend to."""
    found, minutes = [], []
    for (n, plate), key in zip(PLATE.items(), keys):
        meshes = [
            *(f"participants.{who}.mesh-parameters={{n: {n}}}" for who in ("fluid", "mover")),
            f"participants.solid.mesh-parameters={plate}",
        ]
        run = job.case(case, (*meshes, key), timeout=20000)
        found.append(job.beside("configs/turek-hron/summary.py").summary(run.folder)[name])
        minutes.append(f"{run.cost.cpu / 60:.1f}")
    published = [
        abs(float(row[name]))
        for row in job.beside("configs/turek-hron/summary.py").rows(of)
        if row["source"].startswith("FF") and row.get(name)
    ]
    off = 100 * (found[-1] / right - 1)
    spread = f", published {min(published):.5g} to {max(published):.5g}" if len(published) > 1 else ""
    within = len(published) > 1 and min(published) <= abs(found[-1]) <= max(published)
    values = f"{', '.join(f'{v:.5g}' for v in found)} for {right:.5g}{spread}: {off:+.2f} %"
    cost = f"({', '.join(minutes)} processor minutes)"
    is_near = abs(off) <= percent or within
    if len(found) < len(PLATE):
        return f"{values} {cost}", is_near
    limit = limit_of(list(PLATE), found)
    if not limit:
        return f"{values}; the three tend to no limit {cost}", False
    apart = 100 * (found[-1] / limit.value - 1)
    tends = f"{apart:+.2f} % from the limit {limit.value:.5g} of the three, order {limit.order:.1f}"
    return f"{values}; {tends} {cost}", is_near and abs(apart) <= drift


def band(job, which, low, high):
    """Returns, for Mok's cavity, the smallest and largest height of the middle [m] over the last period of 5 s, time
    between its last two maxima [s]."""
    run = job.case("cavity-flexible-bottom")
    t, y = (run.column("membrane", "probes.csv", name) for name in ("time [s]", "middle y [m]"))
    last, before = t > t[-1] - 5, (t > t[-1] - 10) & (t <= t[-1] - 5)
    value = (y[last].min(), y[last].max(), t[last][y[last].argmax()] - t[before][y[before].argmax()])[which]
    return f"{value:.4f} ({run.cost.cpu / 60:.1f} processor minutes)", low <= value <= high


# -- lock in ----------------------------------------------------------------------------------------------------------
AHN = 0.55  # amplitude over D at 4: Ahn and Kallinderis, J. Comput. Phys. 219 (2006)


def response(job, reduced):
    """Amplitude over D and frequency over that in vacuo, last 30 s of 120 s, and what the run cost."""

    def make():
        out = job.scratch / f"lock-in-{reduced}"
        out.mkdir(exist_ok=True)
        stiffness = 2 * (2 * math.pi / reduced) ** 2
        sets = (f"simulation.output.folder={out}", f"participants.body.body.springs.translation=[0, {stiffness!r}, 0]")
        cost = launch(
            [job.root / "configs/spring-cylinder/run", "vortices.yaml", *(w for s in sets for w in ("--set", s))],
            out / "run.log",
            folder=out,
            timeout=3600,
            env={**job.environment, "COUPLET_BIN": str(job.build / "bin")},
        )
        t, y = np.loadtxt(out / "body/body.csv", delimiter=",", skiprows=1).T[[0, 2]]
        y += 0.2  # from the relaxed spring
        end, series = t > t[-1] - 30, job.beside("configs/cylinder/coefficients.py")
        return series.mean_and_amplitude(t[end], y[end])[1], reduced * series.frequency(t[end], y[end]), cost

    return job.once(("lock-in", reduced), make)


def at_four(job):
    amplitude, ratio, cost = response(job, 4)
    return (
        (
            f"{amplitude:.3f} D: {100 * (amplitude / AHN - 1):+.1f} %, frequency {ratio:.3f} of that in vacuo"
            f" ({cost.cpu / 60:.1f} processor minutes)"
        ),
        abs(amplitude / AHN - 1) <= 0.1,
    )


def bracket(job, locked, free):
    """Locked at one velocity: it oscillates near its own frequency, by more than a quarter of D; at the other it
    follows the vortices, at a frequency that is not its own."""
    at = {u: response(job, u)[:2] for u in (locked, free)}
    text = "; ".join(f"{u:g}: {a:.3f} D, frequency {f:.2f} of that in vacuo" for u, (a, f) in sorted(at.items()))
    return text, at[locked][0] > 0.25 and abs(at[locked][1] - 1) < 0.2 and abs(at[free][1] - 1) > 0.2


# -- tube -------------------------------------------------------------------------------------------------------------
MOENS_KORTEWEG = math.sqrt(0.3e6 * 1e-3 / (2 * 1000 * 5e-3))


def wave(job, keys, coarser):
    """Distance over the time between the maxima at the outer stations, 15 and 35 mm from the inlet [m/s]: the pulse is
    over there before its reflection returns."""
    speeds = []
    for own in ((), coarser):
        rows = job.case("tube-3d", (*keys, *own)).probes("solid")
        speeds.append(0.02 / (top(rows["time [s]"], rows["b y [m]"])[0] - top(rows["time [s]"], rows["a y [m]"])[0]))
    case, coarse = speeds
    return (
        (
            f"{case:.3f} m/s on the case's mesh, {coarse:.3f} m/s at twice its cells and step:"
            f" {100 * (coarse / case - 1):+.1f} %; Moens and Korteweg {MOENS_KORTEWEG:.2f}, with 1 - nu^2"
            f" {MOENS_KORTEWEG / math.sqrt(0.91):.2f} m/s"
        ),
        abs(coarse / case - 1) <= 0.02,
    )
