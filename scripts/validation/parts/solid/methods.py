# SPDX-License-Identifier: Apache-2.0
"""Bars of the solution methods: they agree, whatever the number of ranks; the matrix-free rows are the assembled ones;
the slender beam."""
from validation.job import Bar
from validation.parts.measures import all_pass, at_most, programs_pass

METHODS, KERNEL = "verification_solid_methods", "unit_elasticity_kernel"


def slender(gradient):
    """40 960 cells, 160 x 16 x 16, ten times longer than wide, nu = 0.3, to 1e-8."""
    def measure(job):
        race = job.beside("benchmarks/peers/race.py")
        method = race.METHODS["newton-krylov" if gradient == "thesis" else "newton-krylov, corrected"]
        _, _, iterations = race.ours(job, "vibrating-cantilever", [
            "participants.solid.mesh-parameters={n_length: 160, n_side: 16}", "participants.solid.analysis=static",
            "participants.solid.boundaries.tip={type: traction, value: [0, 125, 0]}", "simulation.time-step=1",
            "simulation.end-time=1", "participants.solid.solution-method={%s, relative-tolerance: 1e-8}" % method])
        return f"{iterations[-1]:.0f}", iterations[-1] <= 40
    return measure


BARS = [
    Bar("all solution methods, both gradients, at 1e-10: largest difference of u", "<= 1e-6", at_most(METHODS, "same_answer", "worst", 1e-6)),
    Bar("1, 2, 3 ranks at 1e-12: difference of u from one rank", "<= 1e-8", programs_pass("^verification_solid_methods(_2|_3)?$", 3)),
    Bar("matrix-free rows of the least-squares operator beside the assembled ones, all conditions, materials", "round-off", all_pass(KERNEL, "rows")),
    Bar("slender beam 10:1, 40 960 cells, nu 0.3: iterations of newton-krylov, least-squares gradient", "<= 40", slender("thesis")),
    Bar("slender beam: iterations, corrected gradient", "<= 40", slender("corrected")),
]
