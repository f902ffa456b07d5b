# SPDX-License-Identifier: Apache-2.0
"""Plate B over all its cells: displacement and von Mises stress against 128x192x96 hexahedra of the same gradient, whose values
are averaged over each cell of the coarser grid (the two prisms or six tetrahedra of one place: their mean)."""
import numpy as np

import couplet

REFERENCE = 128  # cells from the hole to the rim; 112 s and 4 GB


def nine_points(job):
    return job.beside("configs/elliptic-plate/nine_points.py")


def shape_of(n):
    return [n, 3 * n // 2, 3 * n // 4]


def fields(job, n, shape=0):
    """Displacement and stress at the places of the grid."""
    def make():
        run = job.alone("elliptic-plate", (
            "participants.solid.mesh-parameters={nr: %d, nt: %d, nz: %d, shape: %d}" % (*shape_of(n), shape),
            "participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-8}"))
        tools, series = nine_points(job), couplet.find_series(run.folder / "solid")
        last, points = len(series.times) - 1, series.file["mesh/coordinates"][...]
        centres = np.array([points[list(cell)].mean(axis=0) for cell in series.cells])
        place = (*tools.grid(centres, shape_of(n)), shape_of(n))
        stress = np.stack([series.field(last, name) for name in tools.STRESS], axis=-1)
        return tools.means(series.field(last, "cell-displacement"), *place), tools.means(stress, *place)
    return job.once(("plate B, all cells", n, shape), make)


def averaged(values, k):
    a, b, c, m = values.shape
    return values.reshape(a // k, k, b // k, k, c // k, k, m).mean(axis=(1, 3, 5))


def gap(got, wanted):
    return 100 * np.linalg.norm(got - wanted) / np.linalg.norm(wanted)


def displacement(job, limits, shape=0):
    """Relative L2 norm over the cells [%]."""
    errors = {n: gap(fields(job, n, shape)[0], averaged(fields(job, REFERENCE)[0], REFERENCE // n)) for n in limits}
    return ", ".join(f"{e:.3f} %" for e in errors.values()), all(errors[n] <= limit for n, limit in limits.items())


def stress(job, limits):
    """Von Mises stress without the layers of cells at the clamped rim, whose edges are singular: one layer counts, two are reported."""
    von_mises, words, met = nine_points(job).von_mises, [], True
    for layers in (1, 2):
        errors = []
        for n in limits:
            got, wanted = von_mises(fields(job, n)[1]), von_mises(averaged(fields(job, REFERENCE)[1], REFERENCE // n))
            errors.append(gap(got[:-layers], wanted[:-layers]))
        words.append(", ".join(f"{e:.3f} %" for e in errors) + f" without {layers} layer{'s' if layers > 1 else ''} of cells")
        met = met and (layers > 1 or all(e <= limit for e, limit in zip(errors, limits.values())))
    return "; ".join(words), met
