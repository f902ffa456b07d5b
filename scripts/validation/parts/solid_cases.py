# SPDX-License-Identifier: Apache-2.0
"""Bars of the thesis's cases A, B and D and of LE10: solid_solver on configs/, meshes chosen by --set."""
import math

from validation.job import Bar

# -- B: thick elliptic plate --------------------------------------------------------------------------------------------
PLATE = ((4, 6, 3), (8, 12, 6), (16, 24, 12), (32, 48, 24))


def plate(job, gradient, mesh):
    sets = ["participants.solid.mesh-parameters={nr: %d, nt: %d, nz: %d}" % mesh] + gradient
    folder, _ = job.solve("solid_solver", "elliptic-plate", sets)
    return job.beside("configs/elliptic-plate/nine_points.py").errors(folder / "solid")


THESIS = []


def plate_errors(gradient, which, limits):
    """Errors [%] of all four meshes; the bars are on the last two."""
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


BARS = [
    Bar("B: displacement, thesis's gradient, 4x6x3 to 32x48x24", "reported (about 4.9 % and 1.5 % on the two finest)",
        plate_errors(THESIS, 0, (math.inf, math.inf)), long=True),
    Bar("B: von Mises stress, thesis's gradient", "reported", plate_errors(THESIS, 1, (math.inf, math.inf)), long=True),
]
