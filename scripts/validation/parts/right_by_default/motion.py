# SPDX-License-Identifier: Apache-2.0
"""Motion by default settings: a beam of two tetrahedra across, an undamped strip of triangles, and what a step costs compared with the least-squares
gradient, which was the default of motion."""
import csv
import re

from validation.parts.right_by_default.scenes import warnings

PERIOD, AMPLITUDE = 20.03, 0.09325  # of the continuum; of the p-FEM run in configs/vibrating-cantilever/reference, fitted alike


def vibration(job):
    run = job.alone("vibrating-cantilever",
                        ("participants.solid.mesh-parameters={n_length: 20, n_side: 2, shape: 1}", "simulation.end-time=60"))
    got = job.beside("configs/vibrating-cantilever/vibration.py").numbers(run.folder / "solid")
    off = got["period"] / PERIOD - 1, got["amplitude"] / AMPLITUDE - 1
    said = warnings(run)
    return (f"period {got['period']:.2f} s ({100 * off[0]:+.2f} %), amplitude {got['amplitude']:.4f} m ({100 * off[1]:+.2f} %)"
            f"{', ' + said[0] if said else ', no warning'}"), max(map(abs, off)) <= 0.03 and not said


def strip(job):
    run = job.alone("undamped-strip", ())
    with open(run.folder / "solid" / "energies.csv", encoding="utf-8") as file:
        rows = [[float(v) for v in row[1:3]] for row in list(csv.reader(file))[1:]]
    first, worst = sum(rows[0]), max(abs(sum(row) / sum(rows[0]) - 1) for row in rows)
    said = warnings(run)
    return f"within {worst:.1e} of {first:.0f} J{', ' + said[0] if said else ', no warning'}", worst <= 1e-6 and not said


def seconds(job, gradient, sets, steps):
    """Processor seconds of the linear solver over so many steps."""
    run = job.alone("vibrating-cantilever",
                        (*sets, f"simulation.end-time={0.1 * steps}", f"participants.solid.solution-method.face-gradient={gradient}"))
    return float(re.search(r"^.*solid: linear solver\s+([\d.]+)", run.log, re.M)[1])


def cost(job, sets, steps):
    ratios = []
    for _ in range(3):
        ratios.append(seconds(job, "auto", sets, steps) / seconds(job, "thesis", sets, steps))
    return ", ".join(f"{r:.2f}" for r in sorted(ratios)) + " times", sorted(ratios)[1] <= 1.1


def sizes(n_length, n_side):
    return ("participants.solid.mesh-parameters={n_length: %d, n_side: %d}" % (n_length, n_side),)
