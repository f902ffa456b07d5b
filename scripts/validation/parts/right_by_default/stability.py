# SPDX-License-Identifier: Apache-2.0
"""Buckling against closed forms, and equilibria that do not hold."""
import csv
import json
import math

from validation.job import Bar

E = 210e9
COLUMN = math.pi**2 / 48 * 0.01**2 * E / 1e6
RING = E / (1 - 0.3**2) * 0.005**3 / 12 / 1.0025 / 1e3  # at the outer radius
LEE = 18.5
PLATE = 10.07 * math.pi**2 / 12 * 0.01**2 / 1e-5
DEAD = ('participants.solid.boundaries.outside={type: traction, value: '
        '["-1e3*x/sqrt(x*x+y*y)", "-1e3*y/sqrt(x*x+y*y)"]}',)


def factor(case, right, sets=(), within=0.01):
    def measure(job):
        run = job.solve_run("solid_solver", case, sets)
        with open(run.folder / "solid" / "buckling.csv", encoding="utf-8") as file:
            found = float(list(csv.reader(file))[1][1])
        error = found / right - 1
        return f"{found:.4g} ({100 * error:+.2f} %)", abs(error) <= within
    return measure


def passes(target, wanted):
    def measure(job):
        tests, _ = job.gtest(target, wanted)
        return ", ".join("passed" if t["passed"] else "failed" for t in tests.values()), all(t["passed"] for t in tests.values())
    return measure


def snap(job):
    """The first limit load [kN] in run.json, and what else the run has to say."""
    run = job.solve_run("solid_solver", "lees-frame")
    findings = json.loads((run.folder / "solid" / "run.json").read_text())["findings"]
    found = next(f["number"] for f in findings if f["id"] == "limit-load")
    worse = [f["id"] for f in findings if f["severity"] != "note"]
    error = found / LEE - 1
    return f"{found:.4g} kN ({100 * error:+.2f} %), {', '.join(worse) or 'no warning'}", abs(error) <= 0.02 and not worse


BARS = [
    Bar("buckling, clamped column 100:1: pi^2 E I / (4 L^2)", "within 1 %", factor("buckling-column", COLUMN)),
    Bar("buckling, ring in plane strain, pressure that follows: 3 E I / ((1 - nu^2) R^3)", "within 1 %",
        factor("buckling-ring", 3 * RING)),
    Bar("buckling, ring in plane strain, radial load that keeps its direction: 4 E I / ((1 - nu^2) R^3)", "within 1 %",
        factor("buckling-ring", 4 * RING, DEAD)),
    Bar("buckling, square plate b/t = 100, clamped, compressed one way: k = 10.07", "within 1 %",
        factor("buckling-plate", PLATE, ("participants.solid.mesh-parameters={n: 64, nt: 1, t: 0.01}",)), long=True),
    Bar("column at large strain: 2.6 times Euler's load is flagged as unstable from 1/2.6 of it on; 0.85 times, in tension and with a "
        "lateral load it is not", "passed", passes("verification_solid_buckling", "Equilibrium.*")),
    Bar("snap-through, Lee's frame by arc length: first limit load", "18.5 within 2 %, no warning", snap,
        but="in plane strain with E (1 - nu^2), so that E I is that of the frame of beams; E 720 is in t/cm^2, L 120 in cm, the load in kN"),
    Bar("snap-through, shallow arch: path and both limit loads of the closed form, dead load and pressure", "path within 3 %, limit loads within 2 %",
        passes("verification_solid_arc_length", "ArcLength.follows*:ArcLength.scales_a_pressure*")),
]
