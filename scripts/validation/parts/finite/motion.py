# SPDX-License-Identifier: Apache-2.0
"""Measures of large strain in time: the oscillating column, rigid rotation, restart and ranks."""
import math

import numpy as np

import couplet

S = "participants.solid."
MAXIMUM, MINIMUM = 2.873, -3.179  # u_x(A) [m], cubic spectral elements, refined


def column(job, across, along, shape=0, sets=()):
    run = job.alone("bending-column",
                        ("%smesh-parameters={n: %d, m: %d, shape: %d}" % (S, across, along, shape), *sets))
    table = couplet.read_csv(run.folder / "solid" / "probes.csv")
    energies = couplet.read_csv(run.folder / "solid" / "energies.csv")
    whole = [k + s for k, s in zip(energies["kinetic [J]"], energies["strain [J]"])]
    return max(table["A x [m]"]), min(table["A x [m]"]), whole[-1] / whole[0] - 1


def swing(job, across, along, limit, shape=0, sets=()):
    most, least, drift = column(job, across, along, shape, sets)
    errors = [100 * (most / MAXIMUM - 1), 100 * (least / MINIMUM - 1)]
    text = f"{most:.3f}, {least:.3f} m: {errors[0]:+.2f}, {errors[1]:+.2f} %; energy {drift:+.1e}"
    return text, None if limit is None else max(map(abs, errors)) <= limit


def checkerboard(job, across, along, shape):
    """Root mean square of what the mean stress of an inner cell differs from the mean of its neighbours over faces, over that of the mean
    stress: 2 where the cells change sign like a board's fields, of the order of the cells' size squared where the stress is smooth."""
    run = job.alone("bending-column", ("%smesh-parameters={n: %d, m: %d, shape: %d}" % (S, across, along, shape),))
    series = couplet.find_series(run.folder / "solid")
    last = len(series.times) - 1
    mean = sum(np.array(series.field(last, f"stress-{c}")) for c in ("xx", "yy", "zz")) / 3
    cells = [list(c) for c in series.cells]
    sides = TETRAHEDRON if len(cells[0]) == 4 else HEXAHEDRON
    of_face = {}
    for c, points in enumerate(cells):
        for side in sides:
            of_face.setdefault(frozenset(points[p] for p in side), []).append(c)
    beside = [[] for _ in cells]
    for pair in of_face.values():
        if len(pair) == 2:
            beside[pair[0]].append(pair[1])
            beside[pair[1]].append(pair[0])
    inner = [c for c, near in enumerate(beside) if len(near) == len(sides)]
    off = np.array([mean[c] - np.mean(mean[beside[c]]) for c in inner])
    ratio = math.sqrt(np.mean(off**2) / np.mean(mean[inner] ** 2))
    return f"{ratio:.3f} of {len(inner)} inner cells", ratio <= 0.5


TETRAHEDRON = ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))
HEXAHEDRON = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def vibration(job, scheme, limit):
    """50 periods of 1.83 s; the largest distance of the energy from that of the first step, in parts of it."""
    run = job.alone("bending-column", (
        "%smesh-parameters={n: 2, m: 8, shape: 0}" % S, "simulation.end-time=91.5", "simulation.time-step=0.01", *scheme))
    energies = couplet.read_csv(run.folder / "solid" / "energies.csv")
    whole = [k + s for k, s in zip(energies["kinetic [J]"], energies["strain [J]"])]
    drift = max(abs(w / whole[0] - 1) for w in whole)
    return f"{drift:.1e} at most, {whole[-1] / whole[0] - 1:+.1e} at the end", None if limit is None else drift <= limit
