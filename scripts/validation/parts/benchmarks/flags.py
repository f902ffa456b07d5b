# SPDX-License-Identifier: Apache-2.0
"""Bars of FSI1 and FSI3 of Turek and Hron."""
from validation.job import Bar

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


def beside(case, name, limit, *more):
    """A value within `limit` of the benchmark's."""
    def measure(job):
        found, cost = run(job, case, *more)
        wanted = job.beside(f"{HERE}/summary.py").reference(case.upper())[name]
        off = found[name] / wanted - 1
        return f"{found[name]:.5g} for {wanted:.5g}: {100 * off:+.2f} % ({cost.cpu / 60:.1f} processor minutes)", abs(off) <= limit
    return measure


def both_steps(job):
    """The coarse FSI3 at two steps: how far apart the step leaves them."""
    (two, _), (one, _) = run(job, "fsi3"), run(job, "fsi3", "simulation.time-step=1 ms")
    texts = [f"{name} {two[name]:.5g}, {one[name]:.5g}" for name in ("uy_amp", "uy_f", "drag_mean", "lift_amp")]
    return "; ".join(texts), None


def hours(limit):
    """Processor hours of the full FSI3; the anchor took 44."""
    def measure(job):
        spent = run(job, "fsi3", *FULL["fsi3"])[1].cpu / 3600
        return f"{spent:.2f} processor hours; the anchor 44", spent <= limit
    return measure


FULL_MESH = "about 21 k fluid and 2.5 k solid cells"
FLAGS = [
    *(Bar(f"FSI1, {FULL_MESH}: {name}", f"within {100 * limit:g} %",
          beside("fsi1", name, limit, *FULL["fsi1"]))
      for name, limit in (("uy_mean", 0.02), ("ux_mean", 0.02), ("drag_mean", 0.003), ("lift_mean", 0.03))),
    *(Bar(f"FSI1, 4.8 k fluid cells: {name}", f"within {100 * limit:g} %", beside("fsi1", name, limit), but="coarse mesh")
      for name, limit in (("uy_mean", 0.02), ("ux_mean", 0.05), ("drag_mean", 0.01), ("lift_mean", 0.03))),
    Bar("FSI3, coarse, ten minutes, pseudo-solid: uy_amp", "within 10 %", beside("fsi3", "uy_amp", 0.10)),
    *(Bar(f"FSI3, coarse, ten minutes, pseudo-solid: {name}", f"within {100 * limit:g} %", beside("fsi3", name, limit),
          but="limits of our own")
      for name, limit in (("uy_f", 0.03), ("drag_mean", 0.01))),
    Bar("FSI3, coarse, pseudo-solid, at steps of 2 and 1 ms", "reported", both_steps, long=True),
    *(Bar(f"FSI3, {FULL_MESH}, dt 0.5 ms, pseudo-solid: {name}", f"within {100 * limit:g} %", beside("fsi3", name, limit, *FULL["fsi3"]), long=True)
      for name, limit in (("uy_amp", 0.023), ("uy_f", 0.012), ("drag_mean", 0.01), ("lift_amp", 0.08))),
    Bar(f"FSI3, {FULL_MESH}, dt 0.5 ms, pseudo-solid: cost", "at most 6 processor hours", hours(6), long=True),
]
