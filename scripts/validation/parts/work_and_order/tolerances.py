# SPDX-License-Identifier: Apache-2.0
"""A channel that pushes an elastic bar (tests/coupling/piston), default tolerances. Twelve runs whose densities differ by 1e-4: what one
of them gives is decided by rounding."""
import re

from couplet.runs.process import RunFailed

CASE = "tests/coupling/piston/case.yaml"
DEFAULTS = ("participants.fluid.pressure-tolerance=1e-6", "coupling.convergence.relative=1e-5")
BY_HAND = {10: 34, 91: 37, 1000: 44}  # passes of ten steps with a pressure tolerance of 1e-9


def passes(job, density):
    """Of ten steps; None if one of them failed."""
    out = job.scratch / f"piston-{density}"
    try:
        log = job.case_run(job.root / CASE, out, (*DEFAULTS, f"participants.fluid.density={density}"), {}, 120).log
    except RunFailed:
        return None
    halvings, mean = re.search(r"(\d+) halvings.*iterations: mean ([\d.]+)", log).groups()
    return None if int(halvings) else round(10 * float(mean))


def piston(job, ratio):
    found = [passes(job, round(1000 * ratio * (1 + 1e-4 * k), 4)) for k in range(12)]
    done = [n for n in found if n is not None]
    text = f"{len(found) - len(done)} of {len(found)} runs with failed steps; {min(done)} to {max(done)} passes in the others"
    return text, len(done) == len(found) and max(done) <= BY_HAND[ratio]
