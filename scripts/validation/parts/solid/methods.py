# SPDX-License-Identifier: Apache-2.0
"""Measures of the solution methods: they agree, whatever the number of ranks; the matrix-free rows are the assembled ones;
the slender beam."""


def slender(job, gradient):
    """40 960 cells, 160 x 16 x 16, ten times longer than wide, nu = 0.3, to 1e-8."""
    race = job.beside("benchmarks/peers/race.py")
    method = race.METHODS["newton-krylov" if gradient == "thesis" else "newton-krylov, corrected"]
    _, _, iterations = race.ours(job, "vibrating-cantilever", [
        "participants.solid.mesh-parameters={n_length: 160, n_side: 16}", "participants.solid.analysis=static",
        "participants.solid.boundaries.tip={type: traction, value: [0, 125, 0]}", "simulation.time-step=1",
        "simulation.end-time=1", "participants.solid.solution-method={%s, relative-tolerance: 1e-8}" % method])
    return f"{iterations[-1]:.0f}", iterations[-1] <= 40
