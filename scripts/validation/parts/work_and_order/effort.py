# SPDX-License-Identifier: Apache-2.0
"""What the participants' linear solvers do where the coupler sends with each pass how closely it needs the answer, beside what they did when
each solved to tolerances of its own (0c71c15f, the same cases and default settings)."""
import numpy as np

import couplet

SHORT = ("simulation.output.interval=0", "simulation.checkpoint.interval=0")
# Case, end time, probe; then of 0c71c15f: passes, linear iterations of all participants.
CASES = {"flap": ("configs/perpendicular-flap/case.yaml", "0.5 s", "tip x [m]", 152, 18046 + 460 + 98),
         "tube": ("configs/tube-3d/case.yaml", "2 ms", "A y [m]", 178, 2818 + 5087),
         "FSI1": ("configs/turek-hron/fsi1.yaml", "2 s", "A y [m]", 493, 8040 + 1652 + 198)}
# What the case was when those were counted.
THEN = {"FSI1": ("coupling.scheme=semi-implicit",)}
TIGHT = ("participants.fluid.pressure-tolerance=1e-9", "coupling.convergence.relative=1e-8")


def run(job, name, *more):
    """Passes, linear iterations, motion of the probe."""
    case, end, probe, *_ = CASES[name]
    folder = job.coupled(job.root / case, f"effort-{name}-{len(more)}", (f"simulation.end-time={end}", *SHORT, *THEN.get(name, ()), *more))
    steps = couplet.read_csv(folder / "coupler" / "participants.csv")
    linear = sum(np.nansum(steps[column]) for column in steps if column.endswith("linear iterations"))
    return int(np.sum(steps["coupling iterations"])), int(linear), couplet.read_csv(folder / "solid" / "probes.csv")[probe]


def effort(job, name):
    passes, linear, motion = run(job, name)
    _, _, tight = run(job, name, *TIGHT)
    before, was = CASES[name][3:]
    apart = float(np.abs(motion - tight).max() / np.abs(tight).max())
    return (f"{linear} for {was}: {linear / was:.2f}; {passes} passes for {before}; motion {apart:.1e} from that of tolerances a thousand times "
            "tighter"), bool(linear <= 0.8 * was and passes <= 1.02 * before and (name == "FSI1" or apart <= 1e-3))
