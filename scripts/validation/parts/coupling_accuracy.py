# SPDX-License-Identifier: Apache-2.0
"""Work, order in time, tolerances and restart of coupled runs."""
import math
import re
import sys

from couplet.runs.process import RunFailed


LENGTH, HEIGHT, MODULUS = 0.351, 0.02, 5.6e6 / (1 - 0.4**2)  # of FSI3's plate; plane strain [m, m, Pa]


# -- loads ------------------------------------------------------------------------------------------------------------
AT = 1.25  # s


def swung(job, step, cells, end, *keys):
    """A cylinder that moves by -(5/4 pi)(1 - cos 0.4 pi t), viscosity 1 Pa s: results, and the x force [N] of each
    step."""
    run = job.case(
        "oscillating-cylinder",
        (
            ".viscosity=1 Pa s",
            ".viscous=implicit",
            '.motion.translation=["-(5/(4*pi))*(1-cos(0.4*pi*t))", 0]',
            ".mesh-parameters={n: %d}" % cells,
            f"simulation.end-time={end}",
            f"simulation.time-step={step}",
            *keys,
        ),
    )
    return run, sum(values for name, values in run.table("fluid", "forces.csv").items() if name.endswith(" x [N]"))


def force(job, step, cells):
    """Returns the force at 1.25 s [N]. Forces are given at the middle of the steps."""
    _, forces = swung(job, step, cells, AT + 2 * step)
    return float(forces[-3:-1].mean())


def in_time(job):
    a, b, c = (force(job, step, 48) for step in (0.025, 0.0125, 0.00625))
    order = math.log2((a - b) / (b - c))
    return f"{a:.5f}, {b:.5f}, {c:.5f} N: order {order:.2f}", order >= 1.9


# -- ladder -----------------------------------------------------------------------------------------------------------
STEPS = (0.01, 0.005, 0.0025, 0.00125)  # s
COARSE = (
    "participants.solid.mesh-parameters={n_side: 40, n_tip: 4}",
    *(
        f"participants.{name}.mesh-parameters={{n_side: 20, n_tip: 2, growth: 1.3, wall_growth: 1.3, wall_cells: 5}}"
        for name in ("fluid", "mover")
    ),
)


def tip(job, rho, mu, step):
    """Returns the tip's displacement at 0.2 s [m] and the run's own relative estimate of the step's error, or None if
    the run ended earlier."""
    try:
        run = job.case(
            "perpendicular-flap",
            (
                "simulation.end-time=0.2",
                f"simulation.time-step={step}",
                "simulation.output.interval=0",
                "simulation.checkpoint.interval=0",
                "participants.fluid.boundaries.inlet.ramp=0.4",
                f"participants.fluid.viscosity={mu}",
                f"participants.solid.material.density={rho}",
                "coupling.convergence.max-iterations=100",
                *COARSE,
            ),
            timeout=3000,
        )
    except RunFailed:
        return None, None
    return run.probes("solid")["tip x [m]"][-1], run.report("coupler")["errors"]["step"]


def limit_of(tips):
    """Limit of the two finest steps for the order that they show (1 to 2)."""
    order = min(2, max(1, math.log2(abs(tips[1] - tips[2]) / abs(tips[2] - tips[3]))))
    return tips[3] + (tips[3] - tips[2]) / (2**order - 1)


def estimates(job):
    """Compares the estimates for steps of 10, 5 and 2.5 ms, in the cases that finish, with the limit."""
    ratios = []
    for rho, mu in ((rho, mu) for rho in (1000, 100, 10, 1) for mu in (10, 1, 0.1, 0.01)):
        found = [tip(job, rho, mu, step) for step in STEPS]
        tips = [value for value, _ in found]
        if None in tips:
            continue
        limit = limit_of(tips)
        truths = [(abs(value / limit - 1), told) for value, told in found[:3]]
        ratios += [
            told / truth for truth, told in truths if truth > 1e-4
        ]  # less is what the coupling's tolerance leaves
    good = sum(1 / 3 <= r <= 3 for r in ratios)
    return (
        (
            f"{good} of {len(ratios)}; {sum(r > 3 for r in ratios)} above three times the truth,"
            f" {sum(r < 1 / 3 for r in ratios)} below a third, {sum(r < 1 / 5 for r in ratios)} below a fifth;"
            f" {min(ratios):.2f} to {max(ratios):.1f} times it"
        ),
        good >= 0.8 * len(ratios),
    )


def rung(job, rho, mu):
    tips = [tip(job, rho, mu, step)[0] for step in STEPS]
    text = ", ".join("ended before" if t is None else f"{t:.6f}" for t in tips)
    if None in tips:
        return f"tip {text} m", False
    gaps = [abs(a - b) for a, b in zip(tips, tips[1:])]
    order = math.log2(gaps[-2] / gaps[-1]) if gaps[-1] > 0 else math.inf
    return (
        f"tip {text} m: order {order:.2f}, last difference {gaps[-1] / abs(tips[-1]):.1e} of the tip",
        order >= 1.8 or gaps[-1] <= 1e-4 * abs(tips[-1]),
    )


# -- tolerances -------------------------------------------------------------------------------------------------------
BY_HAND = {10: 34, 91: 37, 1000: 44}  # passes of ten steps with a pressure tolerance of 1e-9


def passes(job, density):
    """Returns the passes of ten steps, or None if one of them failed."""
    try:
        log = job.case(
            "tests/coupling/piston/case.yaml",
            (
                "participants.fluid.pressure-tolerance=1e-6",
                "coupling.convergence.relative=1e-4",
                f"participants.fluid.density={density}",
            ),
            timeout=120,
        ).log
    except RunFailed:
        return None
    halvings, mean = re.search(r"(\d+) halvings.*iterations: mean ([\d.]+)", log).groups()
    return None if int(halvings) else round(10 * float(mean))


def piston(job, ratio):
    found = [passes(job, round(1000 * ratio * (1 + 1e-4 * k), 4)) for k in range(12)]
    done = [n for n in found if n is not None]
    text = (
        f"{len(found) - len(done)} of {len(found)} runs with failed steps; {min(done)} to {max(done)} passes in the"
        " others"
    )
    return text, len(done) == len(found) and max(done) <= BY_HAND[ratio]


# -- restart ----------------------------------------------------------------------------------------------------------
TOLERANCE = 1e-5  # of the coupling's convergence


def lines(job, case):
    def make():
        script = job.root / "tests" / "coupling" / "restart" / "ranks.py"
        result = job.run([sys.executable, script, case, job.root / "configs", job.build / "bin"], 3600)
        if f"{case}: 3 to 1" not in result.stdout:
            raise RuntimeError(result.stdout[-1000:] + result.stderr[-1000:])
        return result.stdout

    return job.once(("restart", case), make)


def other(job, case):
    found = re.findall(r": (\d) to (\d): apart by (\S+) .*?ranks by (\S+)", lines(job, case))
    text = ", ".join(f"{a} to {b}: {off}" for a, b, off, _ in found)
    return (
        f"{text} of the largest value; uninterrupted runs on other ranks: {max(float(r) for *_, r in found):.2g}",
        len(found) == 4 and all(float(off) <= max(TOLERANCE, float(r)) for *_, off, r in found),
    )
