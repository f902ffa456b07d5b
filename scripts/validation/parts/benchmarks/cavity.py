# SPDX-License-Identifier: Apache-2.0
"""Measures of Mok's driven cavity with a flexible bottom."""
import couplet

CASE = "configs/cavity-flexible-bottom/case.yaml"


def extremes(job, name, *more):
    """Least and largest height of the middle [m] over the last period of 5 s, time between its last two maxima [s]."""
    folder = job.coupled(job.root / CASE, f"mok-{name}", more)
    rows = couplet.read_csv(folder / "membrane" / "probes.csv")
    t, y = rows["time [s]"], rows["middle y [m]"]
    last, before = t > t[-1] - 5, (t > t[-1] - 10) & (t <= t[-1] - 5)
    return y[last].min(), y[last].max(), t[last][y[last].argmax()] - t[before][y[before].argmax()]


def band(job, which, low, high):
    value = extremes(job, "case")[which]
    cost = job.coupled_run(job.root / CASE, "mok-case").cost  # of the run just made
    return f"{value:.4f} ({cost.cpu / 60:.1f} processor minutes)", low <= value <= high


FINE = ["participants.fluid.mesh-parameters.n=64", "participants.mover.mesh-parameters.n=64", "participants.membrane.mesh-parameters.n=64"]


def own_spread(job):
    """How far mesh and step leave it open."""
    rows = [extremes(job, "case"), extremes(job, "fine", *FINE), extremes(job, "half-step", "simulation.time-step=0.05 s")]
    least, largest = ([row[k] for row in rows] for k in (0, 1))
    texts = [f"{kind} {' '.join(f'{v:.4f}' for v in values)} m" for kind, values in (("least", least), ("largest", largest))]
    spread = max(max(v) / min(v) - 1 for v in (least, largest))
    return "; ".join(texts) + f" (32 x 32, 64 x 64, half the step): {100 * spread:.1f} % apart", spread <= 0.02
