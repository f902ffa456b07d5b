#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A heater in front of the flap, as a participant of its own: the side in the wind gets as warm as 60 K above the other side, less
the further it bends away (10 K per 1 cm). Usage: heater.py PARTICIPANT"""
import pathlib
import sys

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "client/python"))
import couplet  # noqa: E402

N, HALF, HEIGHT = 40, 0.05, 1.0
job = couplet.Client(sys.argv[1], "heater")
ends, middles = np.linspace(0, HEIGHT, N + 1), (np.arange(N) + 0.5) * HEIGHT / N


def both_sides(y):
    return np.vstack([np.column_stack([np.full(len(y), x), y, 0 * y]) for x in (-HALF, HALF)])


faces = [[i, i + 1] for i in range(N)] + [[N + 1 + i, N + 2 + i] for i in range(N)]
job.vertices(both_sides(ends), dimension=2)
job.faces(both_sides(middles), np.repeat([[HEIGHT / N, 0, 0], [-HEIGHT / N, 0, 0]], N, axis=0), faces)
job.takes("displacement", "m", "vertices")
job.gives("temperature", "K", "faces", 1)
for event in job:
    if event == "solve":
        away = job.read("displacement")[:N + 1, 0]
        warmth = (60 - 1000 * (away[1:] + away[:-1]) / 2) * (1 - np.exp(-(job.time + job.dt) / 0.2))
        job.write("temperature", 293.15 + np.concatenate([warmth, np.zeros(N)]))
