# SPDX-License-Identifier: Apache-2.0
"""Measures of FSI1 and FSI3 of Turek and Hron."""

HERE = "configs/turek-hron"
FINE = [*(f"participants.{name}.mesh-parameters={{n: 25}}" for name in ("fluid", "mover")),
        "participants.solid.mesh-parameters={nx: 125, ny: 20}"]
FILES = {"fsi1": "fsi1.yaml", "fsi3": "case.yaml"}
FULL = {"fsi1": [*FINE, "simulation.end-time=12 s"],
        "fsi3": [*FINE, "simulation.time-step=0.5 ms"]}

variants = []  # in the order of their first run


def run(job, case, *more):
    if more not in variants:
        variants.append(more)
    result = job.coupled_run(job.root / HERE / FILES[case], f"{case}-{variants.index(more)}", more, timeout=20000)
    return job.beside(f"{HERE}/summary.py").summary(result.folder), result.cost


def beside(job, case, name, limit, *more):
    """A value within `limit` of the benchmark's."""
    found, cost = run(job, case, *more)
    wanted = job.beside(f"{HERE}/summary.py").reference(case.upper())[name]
    off = found[name] / wanted - 1
    return f"{found[name]:.5g} for {wanted:.5g}: {100 * off:+.2f} % ({cost.cpu / 60:.1f} processor minutes)", abs(off) <= limit


def both_steps(job):
    """The coarse FSI3 at two steps: how far apart the step leaves them."""
    (two, _), (one, _) = run(job, "fsi3"), run(job, "fsi3", "simulation.time-step=1 ms")
    texts = [f"{name} {two[name]:.5g}, {one[name]:.5g}" for name in ("uy_amp", "uy_f", "drag_mean", "lift_amp")]
    return "; ".join(texts), None


def hours(job, limit):
    """Processor hours of the full FSI3; the anchor took 44."""
    spent = run(job, "fsi3", *FULL["fsi3"])[1].cpu / 3600
    return f"{spent:.2f} processor hours; the anchor 44", spent <= limit
