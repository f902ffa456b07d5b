# SPDX-License-Identifier: Apache-2.0
"""Measures of the solid's free vibrations: frequencies against closed forms, their order, the same motion by modes."""
import csv
import math

THIN_PLATE = (13.468, 19.596, 24.271)  # omega a^2 sqrt(rho h / D), Leissa 1969
SCALE = math.sqrt(210e9 * 0.01**3 / (12 * (1 - 0.3**2)) / (7800 * 0.01))


def frequencies(job, case, name, *overrides):
    folder, _ = job.solve(case, overrides)
    with open(folder / name / "modes.csv", encoding="utf-8") as file:
        return [float(row["frequency [Hz]"]) for row in csv.DictReader(file)]


def beam(job, length, side):
    found = frequencies(job, "vibrating-cantilever", "solid", f"participants.solid.mesh-parameters={{n_length: {length}, n_side: {side}}}",
                        "participants.solid.solution-method.face-gradient=symmetric", "participants.solid.output.modes=2",
                        "simulation.end-time=1e-3", "simulation.time-step=1e-3")
    return 1 / found[0]


def slope(values):
    coarse, middle, fine = values
    return math.log2(abs((coarse - middle) / (middle - fine)))


def first_period(job):
    periods = [beam(job, *mesh) for mesh in ((20, 2), (40, 4), (80, 8))]
    off, order = periods[-1] / 20.03 - 1, slope(periods)
    return f"{', '.join(f'{p:.3f}' for p in periods)} s ({100 * off:+.2f} %), slope {order:.2f}", abs(off) <= 0.005 and order >= 1.8


def plate(job, n, m):
    found = frequencies(job, "free-plate", "plate", f"participants.plate.mesh-parameters={{n: {n}, m: {m}}}",
                        "participants.plate.solution-method.preconditioner=factors")
    return [2 * math.pi * f / SCALE for f in found[6:9]]


def free_plate(job):
    meshes = [plate(job, *mesh) for mesh in ((8, 1), (16, 2), (32, 4))]
    off = [100 * (f / w - 1) for f, w in zip(meshes[-1], THIN_PLATE)]
    order = [slope([mesh[i] for mesh in meshes]) for i in range(3)]
    return (f"{', '.join(f'{f:.3f}' for f in meshes[-1])} ({', '.join(f'{o:+.2f}' for o in off)} %), slopes {', '.join(f'{o:.2f}' for o in order)}",
            max(map(abs, off)) <= 0.5 and min(order) >= 1.8)
