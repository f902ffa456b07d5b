# SPDX-License-Identifier: Apache-2.0
"""Measures of meshes that move far and of bodies with prescribed motion."""
import json
import math

import numpy as np

from couplet.runs.process import RunFailed

BEND = ("sin(pi*t*x)/(pi*t) - y*sin(pi*t*x) - x", "(cos(pi*t*x)-1)/(-pi*t) + y*cos(pi*t*x) - y")
MOTIONS = {
    "shifted by 0.5": {"translation": ["0", "0.5*t"]},
    "rotated by 45 degrees": {"angle": "pi/4*t"},
    "rotated by 60 degrees": {"angle": "pi/3*t"},
    "rotated by 90 degrees": {"angle": "pi/2*t"},
    "bent to a half circle": {"displacement": BEND},
}


def move(job, motion, method, chi, more=(), steps=50, end=1, timeout=900):
    """Results of the mover on its own, rows of quality.csv, and whether it came to the end. `motion`: motion of the
    plate."""
    try:
        results, valid = (
            job.case(
                "moving-mesh",
                (
                    f"simulation.end-time={end}",
                    f"simulation.time-step={end / steps}",
                    f"simulation.output.interval={end}",
                    "simulation.max-step-halvings=0",
                    "simulation.checkpoint.interval=0",
                    f".boundaries.plate.motion={json.dumps(motion)}",
                    f".method={method}",
                    f".stiffening={chi}",
                    *more,
                ),
                timeout=timeout,
            ),
            True,
        )
    except RunFailed as failure:
        results, valid = failure.results, False
    return results, results.table("mover", "quality.csv"), valid


def told(rows, valid):
    if not valid:
        return f"refused at {100 * rows['time [s]'][-1]:.0f} % of the way"
    return "all cells valid; " + ", ".join(
        f"{word} {rows[head][-1]:.3g}"
        for word, head in (
            ("edge ratio", "largest edge ratio [1]"),
            ("scaled Jacobian", "least scaled Jacobian [1]"),
            ("V/V0", "least volume ratio [1]"),
            ("f_A", "largest f_A [1]"),
            ("f_AR", "largest f_AR [1]"),
        )
    )


def plate(job, motion, method, chi, holds=True):
    """One mesh of the table of the thesis: valid to the end or not."""
    _, rows, valid = move(job, MOTIONS[motion], method, chi)
    return told(rows, valid), valid == holds


def left_over(results):
    """Largest displacement of a point at the end over the shortest edge, 0.01 m."""
    series = results.fields("mover")
    return float(np.max(np.abs(series.coordinates(len(series.times) - 1) - series.reference()))) / 0.01


def cycles(job, method, degrees, n=100, chi=0.5, limit=1e-6):
    """Least scaled Jacobian at the outer ends of the first and the last oscillation."""
    results, rows, valid = move(
        job, {"angle": f"{math.radians(degrees)}*sin(2*pi*t)"}, method, chi, steps=20 * n, end=n, timeout=1800
    )
    t, j = rows["time [s]"], rows["least scaled Jacobian [1]"]
    if not valid:
        return f"refused after {t[-1]:.2f} cycles", False
    first, last = j[t < 1.001].min(), j[t > n - 1.001].min()
    return (
        (
            f"least scaled Jacobian {first:.4f} in the first cycle, {last:.4f} in the last; left at the end"
            f" {left_over(results):.1e} of the shortest edge"
        ),
        abs(last - first) <= limit,
    )


# -- bodies in the fluid ----------------------------------------------------------------------------------------------
FRAME = '.motion={translation: ["-5/(2*pi)*sin(2*pi*0.2*t)", 0]}'


def swinging(job, frame):
    """c_d and c_m of the oscillating cylinder by Fourier averages, and by least squares; `frame`: the whole mesh
    moves."""
    module, folder = (
        job.beside("configs/oscillating-cylinder/morison.py"),
        job.case("oscillating-cylinder", ("simulation.time-step=0.02", *([FRAME] if frame else []))).folder / "fluid",
    )
    return module.averages(folder), module.fit(folder)


def morison(job, frame):
    (drag, mass), fitted = swinging(job, frame)
    return (
        f"c_d {drag:.4f}, c_m {mass:.4f} by Fourier averages; {fitted[0]:.4f}, {fitted[1]:.4f} by least squares",
        abs(drag / 2.09 - 1) <= 0.02 and abs(mass / 1.45 - 1) <= 0.02,
    )


def closes(job):
    """A channel whose lid comes down to 1 % of the height and goes up again."""
    run = job.case("closing-gap")
    rows, gap = run.table("fluid", "balance.csv"), run.table("fluid", "gaps.csv")
    least, t, cells = float(np.nanmin(gap["slot opening [m]"])), rows["time [s]"], gap["slot blocked cells [-]"]
    leak = float(np.max(np.abs(rows["mass defect [m^3/s]"][(t > 3.1) & (t < 3.5)])))  # while it is shut
    return (
        (
            f"least opening {least:.4f} m of 0.5 m, {int(cells.max())} cells blocked, all free at the end:"
            f" {cells[-1] == 0}; while it is shut the boundaries let in and out the same to {leak:.1e} m^3/s"
        ),
        least < 0.0101 * 0.5 and cells[-1] == 0 and bool(t[-1] > 6 - 1e-6) and leak < 1e-6,
    )


def speed(job, n):
    """benchmarks/mover: processor time of a step of mesh motion, without set-up, over that of a step of the fluid (one
    pressure equation and the predictor)."""
    result = job.done([job.root / "benchmarks/mover", "--build", job.build, "--n", n], timeout=7200)
    seconds = {
        row.split("|")[0].strip(): float(row.split("|")[1]) for row in result.stdout.splitlines()[1:] if "|" in row
    }
    fluid = seconds.pop("a step of the fluid")
    return (
        f"a step of the fluid {fluid:.3f} s; "
        + "; ".join(f"{k} {v / fluid:.2f} times that" for k, v in seconds.items()),
        seconds["laplacian"] < 1.5 * fluid and seconds["pseudo-solid"] < 5 * fluid,
    )
