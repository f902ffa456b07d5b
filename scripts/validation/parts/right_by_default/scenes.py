# SPDX-License-Identifier: Apache-2.0
"""Scenes that went wrong with an earlier default: by default settings within 3 % of what is right, without a warning."""
import csv

from couplet.runs.warnings import WARNING
from validation.job import Bar


def probe(run, column):
    with open(run.folder / "solid" / "probes.csv", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    return float(rows[-1][rows[0].index(column)])


def warnings(run):
    return WARNING.findall(run.log)


def beam_theory(length, force=100.0, modulus=210e9, poisson=0.3):
    """Deflection of a clamped bar of 1 m x 1 m [m], with shear (Timoshenko, Phil. Mag. 41 (1921) 744)."""
    inertia, shear = 1 / 12, modulus / (2 * (1 + poisson))
    return force * length**3 / (3 * modulus * inertia) + 1.2 * force * length / shear


def scene(case, column, right, sets=(), within=0.03):
    def measure(job):
        run = job.solve_run("solid_solver", case, sets)
        error = probe(run, column) / right - 1
        said = warnings(run)
        return f"{100 * error:+.2f} %{', ' + said[0] if said else ', no warning'}", abs(error) <= within and not said
    return measure


def beam(n, nl, length, shape):
    return ("participants.solid.mesh-parameters={n: %d, nl: %d, L: %d, shape: %d}" % (n, nl, length, shape),
            f"participants.solid.probes.tip.point=[{length}, 0.5, 0.5]")


LE10, LE1, LE11 = -5.38e6, 92.66e6, -105.67e6

BARS = [
    Bar("beam 40:1, two tetrahedra across: tip", "within 3 %, no warning", scene("slender-beam", "tip y [m]", beam_theory(40))),
    Bar("beam 10:1, two tetrahedra across, twenty along: tip", "within 3 %, no warning",
        scene("slender-beam", "tip y [m]", beam_theory(10), beam(2, 20, 10, 1))),
    Bar("beam 100:1, 20x2x2 hexahedra: tip", "within 3 %, no warning",
        scene("slender-beam", "tip y [m]", beam_theory(100), beam(2, 20, 100, 0))),
    Bar("L-bracket with a fillet, 779 tetrahedra: tip", "within 3 %, no warning",
        scene("filleted-bracket", "tip y [m]", -2.4535e-4, ("participants.solid.mesh-parameters={h: 0.01}",))),
    Bar("LE10 as shipped: stress yy at D", "within 1 %, no warning", scene("le10", "D stress-yy [Pa]", LE10, within=0.01)),
    Bar("LE1, 48x72 quadrilaterals: stress yy at D", "within 1 %, no warning",
        scene("le1", "D stress-yy [Pa]", LE1, ("participants.solid.mesh-parameters={nr: 48, nt: 72}",), within=0.01),
        but="the issue asks for the bars of other tables; 1 % on this mesh is a figure of our own"),
    Bar("LE11, refine 8: axial stress at A", "within 1 %, no warning",
        scene("le11", "A stress-zz [Pa]", LE11, ("participants.solid.mesh-parameters={refine: 8}",), within=0.01), long=True,
        but="the issue asks for the bars of other tables, of which this is the one that `corrected` met by 0.51 %"),
]
