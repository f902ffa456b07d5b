# SPDX-License-Identifier: Apache-2.0
"""Bars of cases A, B and D of the thesis and of LE10: solid_solver on configs/, meshes and methods chosen by --set."""
import math

import numpy as np

import couplet
from validation.job import Bar

GRADIENTS = ("thesis", "corrected")


def method(gradient, tolerance="1e-9"):
    return "participants.solid.solution-method={type: newton-krylov, face-gradient: %s, relative-tolerance: %s}" % (
        gradient, tolerance)


def probe(job, case, sets, column):
    """Last value of a column of probes.csv."""
    folder, _ = job.solve("solid_solver", case, sets)
    return couplet.read_csv(folder / "solid" / "probes.csv")[column][-1]


def observed_order(values):
    """Order p of three values on meshes halved twice; none if they do not approach a limit."""
    coarse, middle, fine = values
    ratio = (middle - coarse) / (fine - middle)
    return math.log2(ratio) if ratio > 1 else None


def extrapolated(values):
    """Richardson's extrapolation from the last two of three values by the scheme's order 2, thesis (3.3); the uncertainty
    that the grid convergence index gives the last one, 1.25 times the correction; the observed order."""
    correction = (values[-1] - values[-2]) / 3
    return values[-1] + correction, 1.25 * abs(correction), observed_order(values)


# -- A: LE11 ------------------------------------------------------------------------------------------------------------
LE11 = -105.67e6  # [Pa], converged p-FEM


def le11(job, gradient):
    """Axial stress at A on the four meshes of the thesis."""
    return [probe(job, "le11", ("participants.solid.mesh-parameters={refine: %d}" % n, method(gradient)), "A stress-zz [Pa]")
            for n in (1, 2, 4, 8)]


def le11_finest(gradient, limit):
    def measure(job):
        values = le11(job, gradient)
        gap = abs(values[-1] / LE11 - 1)
        return ", ".join(f"{v / 1e6:.2f}" for v in values) + f" MPa; finest {100 * gap:.2f} % off", gap <= limit
    return measure


def le11_limit(gradient, limit):
    def measure(job):
        value, uncertainty, order = extrapolated(le11(job, gradient)[1:])
        gap = abs(value / LE11 - 1)
        return (f"{value / 1e6:.2f} MPa, {100 * gap:.2f} % off; observed order {f'{order:.2f}' if order else 'none'}, "
                f"grid convergence index {100 * uncertainty / abs(LE11):.2f} %"), gap <= limit
    return measure


# -- B: thick elliptic plate --------------------------------------------------------------------------------------------
PLATE = ((4, 6, 3), (8, 12, 6), (16, 24, 12), (32, 48, 24))


def plate(job, gradient, mesh):
    sets = ("participants.solid.mesh-parameters={nr: %d, nt: %d, nz: %d}" % mesh, method(gradient))
    folder, _ = job.solve("solid_solver", "elliptic-plate", sets)
    return job.beside("configs/elliptic-plate/nine_points.py").errors(folder / "solid")


def plate_errors(gradient, which, limits):
    """Errors [%] of all four meshes; the limits are on the last two."""
    def measure(job):
        errors = [100 * plate(job, gradient, mesh)[which] for mesh in PLATE]
        return ", ".join(f"{e:.2f} %" for e in errors), all(e <= limit for e, limit in zip(errors[2:], limits))
    return measure


def plate_slope(gradient, wanted):
    def measure(job):
        coarse, fine = (plate(job, gradient, mesh)[0] for mesh in PLATE[2:])
        slope = math.log2(coarse / fine)
        return f"{slope:.2f}", slope >= wanted
    return measure


# -- D: thick plate -----------------------------------------------------------------------------------------------------
WHOLE_FACE = tuple("participants.solid.boundaries.edge-%s={type: hard-support}" % a for a in "xy")
STATIC = ("participants.solid.analysis=static", "participants.solid.damping=~", "simulation.time-step=0.03")


def thick_mesh(n, nz):
    return ("participants.solid.mesh-parameters={n: %d, nz: %d}" % (n, nz),)


def thick_static(support, gradient, wanted, limit):
    def measure(job):
        values = [-1e3 * probe(job, "thick-plate", (*STATIC, *support, *thick_mesh(*m), method(gradient)), "centre z [m]")
                  for m in ((15, 3), (30, 5), (60, 11))]
        gap = abs(values[-1] / wanted - 1)
        return ", ".join(f"{v:.4f}" for v in values) + f" mm; finest {100 * gap:.2f} % off", gap <= limit
    return measure


def peaks(folder):
    """(time [s], deflection downwards [mm]) and (time [s], stress at the bottom [MPa]) of the first maximum of each."""
    probes = couplet.read_csv(folder / "probes.csv")
    found = []
    for values in (-1e3 * probes["centre z [m]"], probes["bottom stress-xx [Pa]"] / 1e6):
        i = int(values.argmax())
        t = probes["time [s]"]
        near = slice(max(i - 2, 0), i + 3)
        a, b, c = np.polyfit(t[near] - t[i], values[near], 2)
        found.append((t[i] - b / (2 * a), c - b * b / (4 * a)))
    return found


def thick_peak(damping, gradient, mesh, step, wanted, limit):
    """`wanted`: deflection [mm], its time [s] (none: not compared), stress [MPa]."""
    def measure(job):
        sets = ("participants.solid.damping={%s}" % damping, *thick_mesh(*mesh), "simulation.end-time=0.0116",
                f"simulation.time-step={step}", method(gradient, "1e-8"))
        folder, _ = job.solve("solid_solver", "thick-plate", sets, timeout=6 * 3600)
        (t, w), (_, s) = peaks(folder / "solid")
        gaps = [abs(w / wanted[0] - 1), abs(s / wanted[2] - 1)] + ([abs(t / wanted[1] - 1)] if wanted[1] else [])
        return f"{w:.3f} mm at {t:.5f} s, {s:.2f} MPa", max(gaps) <= limit
    return measure


# -- LE10 ---------------------------------------------------------------------------------------------------------------
def le10(gradient, wanted, limit):
    def measure(job):
        values = [probe(job, "le10", ("participants.solid.mesh-parameters={nr: %d, nt: %d, nz: %d}" % m, method(gradient)),
                        "D stress-yy [Pa]") / 1e6 for m in ((16, 24, 24), (32, 48, 24), (64, 96, 48))]
        return ", ".join(f"{v:.3f}" for v in values) + " MPa", abs(values[-1] / wanted - 1) <= limit
    return measure


def le10_strips(gradient):
    """The support is a line in the benchmark and a strip here: the stress over the strip's half width, and where the three
    values lead (a parabola through them) as the strip shrinks."""
    def measure(job):
        widths = (0.1, 0.05, 0.025)
        values = [probe(job, "le10", ("participants.solid.mesh-parameters={nr: 32, nt: 48, nz: 24}",
                                      "participants.solid.boundaries.outer={type: fixed-displacement, components: {x: 0, y: 0}, "
                                      f"parts: [{{where: abs(z - 0.3) < {w}, type: fixed-displacement, value: [0, 0, 0]}}]}}",
                                      method(gradient)), "D stress-yy [Pa]") / 1e6 for w in widths]
        first, second = (values[2] - values[1]) / (widths[2] - widths[1]), (values[1] - values[0]) / (widths[1] - widths[0])
        bend = (first - second) / (widths[2] - widths[0])
        limit = values[2] - widths[2] * first + bend * widths[2] * widths[1]  # Newton's form at 0
        return ", ".join(f"{w} m: {v:.3f} MPa ({100 * abs(v / -5.38 - 1):.2f} %)" for w, v in zip(widths, values)) + \
            f"; limit {limit:.3f} MPa ({100 * abs(limit / -5.38 - 1):.2f} %)", True
    return measure


RAYLEIGH, MASS = "mass: 5.772, stiffness: 6.929e-5", "mass: 11.54"
REPORTED = (math.inf, math.inf)
BARS = [
    *(Bar(f"A (LE11): axial stress at A on 16x24x80, {g} gradient", "-105.67 MPa within 1 %", le11_finest(g, 0.01))
      for g in GRADIENTS),
    *(Bar(f"A (LE11): Richardson-extrapolated, {g} gradient", "within 0.3 %", le11_limit(g, 0.003)) for g in GRADIENTS),
    Bar("B: displacement at the nine points, corrected gradient, 4x6x3 to 32x48x24", "16x24x12 <= 1.05 %, 32x48x24 <= 0.35 %",
        plate_errors("corrected", 0, (1.05, 0.35))),
    Bar("B: von Mises stress, corrected gradient", "16x24x12 <= 1.05 %, 32x48x24 <= 0.4 %",
        plate_errors("corrected", 1, (1.05, 0.4))),
    Bar("B: slope of the displacement's error over the two finest, corrected gradient", ">= 1.68",
        plate_slope("corrected", 1.68)),
    Bar("B: displacement, least-squares gradient", "reported (about 4.9 % and 1.5 %)", plate_errors("thesis", 0, REPORTED)),
    Bar("B: von Mises stress, least-squares gradient", "reported", plate_errors("thesis", 1, REPORTED)),
    *(Bar(f"D: static deflection, well-posed support, 15x15x3 to 60x60x11, {g} gradient", wanted,
          thick_static(WHOLE_FACE, g, 2.3198, limit))
      for g, wanted, limit in (("corrected", "2.3198 mm within 0.5 %", 0.005), ("thesis", "reported", math.inf))),
    Bar("D: static deflection, hard mid-line support, corrected gradient", "reported (2.332 to 2.342 mm, creeping)",
        thick_static((), "corrected", 2.337, math.inf)),
    *(bar for g in GRADIENTS for bar in (
        Bar(f"D: peak, Rayleigh damping, 60x60x11, step 2e-5 s, {g} gradient", "4.60 mm at 0.0106 s, 61.0 MPa, each within 1.5 %",
            thick_peak(RAYLEIGH, g, (60, 11), 2e-5, (4.60, 0.0106, 61.0), 0.015), long=True),
        Bar(f"D: peak, mass-proportional damping, 60x60x11, step 2e-5 s, {g} gradient", "4.62 mm, 64.2 MPa, each within 1.5 %",
            thick_peak(MASS, g, (60, 11), 2e-5, (4.62, None, 64.2), 0.015), long=True))),
    Bar("D: peak, Rayleigh damping, the finest published mesh 120x120x23", "reported (p-FEM 4.601 mm at 0.01064 s, 61.04 MPa)",
        thick_peak(RAYLEIGH, "thesis", (120, 23), 2e-5, (4.60, 0.0106, 61.0), math.inf), long=True),
    Bar("LE10: stress yy at D, 16x24x24 to 64x96x48, corrected gradient", "-5.38 MPa within 1 % on the finest",
        le10("corrected", -5.38, 0.01),
        but="the mid-line support is a strip 0.05 m wide, and the result hangs on it: 0.025 m is 1.05 % off, 0.05 m 0.4 %, 0.1 m "
            "0.06 %"),
]
