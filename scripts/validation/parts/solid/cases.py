# SPDX-License-Identifier: Apache-2.0
"""Measures of cases A, B and D of the thesis and of LE10: solid_solver on configs/, meshes and methods chosen by --set."""
import math

import numpy as np

import couplet


def method(gradient, tolerance="1e-9"):
    return "participants.solid.solution-method={type: newton-krylov, face-gradient: %s, relative-tolerance: %s}" % (
        gradient, tolerance)


def probe(job, case, sets, column):
    """Last value of a column of probes.csv."""
    folder, _ = job.solve(case, sets)
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


def le11_limit(job, gradient, limit):
    value, uncertainty, order = extrapolated(le11(job, gradient)[1:])
    gap = abs(value / LE11 - 1)
    return (f"{value / 1e6:.2f} MPa, {100 * gap:.2f} % off; observed order {f'{order:.2f}' if order else 'none'}, "
            f"grid convergence index {100 * uncertainty / abs(LE11):.2f} %"), gap <= limit


# -- B: thick elliptic plate --------------------------------------------------------------------------------------------
PLATE = ((4, 6, 3), (8, 12, 6), (16, 24, 12), (32, 48, 24))


def plate(job, gradient, mesh):
    sets = ("participants.solid.mesh-parameters={nr: %d, nt: %d, nz: %d}" % mesh, method(gradient))
    folder, _ = job.solve("elliptic-plate", sets)
    return job.beside("configs/elliptic-plate/nine_points.py").errors(folder / "solid")


def plate_errors(job, gradient, which, limits):
    """Errors [%] of all four meshes; the limits are on the last two."""
    errors = [100 * plate(job, gradient, mesh)[which] for mesh in PLATE]
    return ", ".join(f"{e:.2f} %" for e in errors), all(e <= limit for e, limit in zip(errors[2:], limits))


def plate_slope(job, gradient, wanted):
    coarse, fine = (plate(job, gradient, mesh)[0] for mesh in PLATE[2:])
    slope = math.log2(coarse / fine)
    return f"{slope:.2f}", slope >= wanted


# -- D: thick plate -----------------------------------------------------------------------------------------------------


def thick_mesh(n, nz):
    return ("participants.solid.mesh-parameters={n: %d, nz: %d}" % (n, nz),)


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


def thick_peak(job, damping, gradient, mesh, step, wanted, limit):
    """`wanted`: deflection [mm], its time [s] (none: not compared), stress [MPa]."""
    sets = ("participants.solid.damping={%s}" % damping, *thick_mesh(*mesh), "simulation.end-time=0.0116",
            f"simulation.time-step={step}", method(gradient, "1e-8"))
    folder, _ = job.solve("thick-plate", sets, timeout=6 * 3600)
    (t, w), (_, s) = peaks(folder / "solid")
    gaps = [abs(w / wanted[0] - 1), abs(s / wanted[2] - 1)] + ([abs(t / wanted[1] - 1)] if wanted[1] else [])
    return f"{w:.3f} mm at {t:.5f} s, {s:.2f} MPa", max(gaps) <= limit


# -- LE10 ---------------------------------------------------------------------------------------------------------------
def le10_strips(job, gradient):
    """The support is a line in the benchmark and a strip here: the stress over the strip's half width, and where the three
    values lead (a parabola through them) as the strip shrinks."""
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
