# SPDX-License-Identifier: Apache-2.0
"""A rigid cylinder on a spring, m y'' + c y' + k y = F_y (trapezoidal rule), as a participant of a job.
Usage: spring_cylinder.py PARTICIPANT [MASS DAMPING STIFFNESS START]   (a metre of depth; START: y at rest at t = 0; by default 2 0 4 0.01)"""
import sys

import couplet
import numpy as np

name, m, c, k, y0 = sys.argv[1], *(float(a) for a in sys.argv[2:6] or (2, 0, 4, 0.01))
n, r = 64, 0.5
angle = 2 * np.pi * np.arange(n) / n
middle = angle + np.pi / n


def ring(radius, a):
    return radius * np.column_stack([np.cos(a), np.sin(a), 0 * a])


job = couplet.Client(name, "spring_cylinder_py")
job.vertices(ring(r, angle), dimension=2)
job.faces(ring(r * np.cos(np.pi / n), middle), ring(2 * r * np.sin(np.pi / n), middle),
          [[i, (i + 1) % n] for i in range(n)])
job.takes("pressure-force", "N", "faces")
job.takes("viscous-force", "N", "faces")
job.gives("displacement", "m", "vertices")
job.gives("velocity", "m/s", "vertices")

y = v = y_next = v_next = 0.0
with open(name + ".csv", "w") as file:
    for event in job:
        if event == "solve":
            dt = job.dt
            force = job.read("pressure-force")[:, 1].sum() + job.read("viscous-force")[:, 1].sum()
            v_next = ((m / dt - c / 2) * v - k * (y + y0 + dt / 4 * v) + force) / (m / dt + c / 2 + k * dt / 4)
            y_next = y + dt / 2 * (v + v_next)
            job.write("displacement", np.tile([0, y_next], (n, 1)))
            job.write("velocity", np.tile([0, v_next], (n, 1)))
        elif event == "accept":
            y, v = y_next, v_next
            print(job.time, y + y0, v, sep=",", file=file, flush=True)
        elif event == "save":
            np.save(job.checkpoint() + ".npy", [y, v])
        elif event == "load":
            y, v = np.load(job.checkpoint() + ".npy")
