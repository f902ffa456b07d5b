# SPDX-License-Identifier: Apache-2.0
"""Bars of large strain in time: the oscillating column, rigid rotation, restart and ranks."""
import math

import numpy as np

import couplet
from validation.job import Bar
from validation.parts.measures import programs_pass

S = "participants.solid."
MOTION = "verification_solid_finite_motion"
MAXIMUM, MINIMUM = 2.873, -3.179  # u_x(A) [m], cubic spectral elements, refined


def column(job, across, along, shape=0, sets=()):
    run = job.solve_run("solid_solver", "bending-column",
                        ("%smesh-parameters={n: %d, m: %d, shape: %d}" % (S, across, along, shape), *sets))
    table = couplet.read_csv(run.folder / "solid" / "probes.csv")
    energies = couplet.read_csv(run.folder / "solid" / "energies.csv")
    whole = [k + s for k, s in zip(energies["kinetic [J]"], energies["strain [J]"])]
    return max(table["A x [m]"]), min(table["A x [m]"]), whole[-1] / whole[0] - 1


def swing(across, along, limit, shape=0, sets=()):
    def measure(job):
        most, least, drift = column(job, across, along, shape, sets)
        errors = [100 * (most / MAXIMUM - 1), 100 * (least / MINIMUM - 1)]
        text = f"{most:.3f}, {least:.3f} m: {errors[0]:+.2f}, {errors[1]:+.2f} %; energy {drift:+.1e}"
        return text, None if limit is None else max(map(abs, errors)) <= limit
    return measure


def checkerboard(across, along, shape):
    """Root mean square of what the mean stress of an inner cell differs from the mean of its neighbours over faces, over that of the mean
    stress: 2 where the cells change sign like a board's fields, of the order of the cells' size squared where the stress is smooth."""
    def measure(job):
        run = job.solve_run("solid_solver", "bending-column", ("%smesh-parameters={n: %d, m: %d, shape: %d}" % (S, across, along, shape),))
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
    return measure


TETRAHEDRON = ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))
HEXAHEDRON = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def vibration(scheme, limit):
    """50 periods of 1.83 s; the largest distance of the energy from that of the first step, in parts of it."""
    def measure(job):
        run = job.solve_run("solid_solver", "bending-column", (
            "%smesh-parameters={n: 2, m: 8, shape: 0}" % S, "simulation.end-time=91.5", "simulation.time-step=0.01", *scheme))
        energies = couplet.read_csv(run.folder / "solid" / "energies.csv")
        whole = [k + s for k, s in zip(energies["kinetic [J]"], energies["strain [J]"])]
        drift = max(abs(w / whole[0] - 1) for w in whole)
        return f"{drift:.1e} at most, {whole[-1] / whole[0] - 1:+.1e} at the end", None if limit is None else drift <= limit
    return measure


def tested(name, program="verification_solid_finite_strain"):
    def measure(job):
        result, _ = job.gtest(program, f"FiniteStrain.{name}")
        passed = all(test["passed"] for test in result.values())
        return "holds under test" if passed else "test fails", passed
    return measure


BARS = [
    Bar("F, first maximum and minimum of u_x(A), 4x16x4", "within 0.7 % of 2.873, -3.179 m", swing(4, 16, 0.7),
        but="a mesh half as fine"),
    Bar("F, first maximum and minimum of u_x(A), 8x32x8", "within 0.7 % of 2.873, -3.179 m", swing(8, 32, 0.7), long=True),
    Bar("F, tetrahedra, 4x16x4 prisms cut in three", "within 2 %", swing(4, 16, 2, 1), long=True,
        but="half as many cells along each side as the hexahedra have"),
    Bar("F, tetrahedra, at the end: what the mean stress of inner cells differs from the mean of their neighbours, rms over rms of the mean stress",
        "no checkerboard, whose value is 2: at most 0.5", checkerboard(4, 16, 1), long=True,
        but="half as many cells along each side as the hexahedra have; the measure is ours"),
    Bar("the same on hexahedra 4x16x4", "at most 0.5", checkerboard(4, 16, 0), but="a mesh half as fine; the measure is ours"),
    Bar("F, Euler with the same step, 4x16x4: what its damping costs", "reported",
        swing(4, 16, None, 0, ("%stime-scheme={type: euler}" % S,))),
    Bar("50 periods of large free vibration, conserving stress, 2x8x2, step 10 ms: energy", "within 1e-8",
        vibration((f"{S}energy-momentum=true",), 1e-8), long=True),
    Bar("the same with the trapezoidal rule", "reported", vibration((), None), long=True),
    Bar("the same with Bathe's scheme", "reported", vibration(("%stime-scheme={type: bathe}" % S,), None), long=True),
    Bar("a free body that spins and oscillates, conserving stress: momenta", "within 1e-10",
        tested("conserving_stress_keeps_energy_and_momenta", MOTION)),
    Bar("tangent is the derivative of the forces, all cell kinds, pressure included", "differences agree to 1e-6",
        tested("tangent_is_the_derivative_of_the_forces_on_all_cells")),
    Bar("rigid rotation through 720 degrees, all cell kinds: stress", "< 1e-9 E", tested("rigid_rotation_makes_no_stress", MOTION)),
    Bar("restart in the middle of the load", "bit for bit", tested("restart_in_the_middle_of_the_load_is_bit_for_bit")),
    Bar("the participant's contract, small and large strain, 1, 2 and 3 ranks", "all pass",
        programs_pass("^contract_solid(_2|_3)?$", 3)),
]
