# SPDX-License-Identifier: Apache-2.0
"""oscillators.cpp in Python, on one process. Usage: oscillators.py Left|Right XML STEPS"""
import sys

import numpy as np
import precice

name, xml, steps = sys.argv[1], sys.argv[2], int(sys.argv[3])
left, mesh, mine, other = name == "Left", f"{name}-Mesh", f"Displacement-{name}", "Displacement-" + ("Right" if name == "Left" else "Left")
participant = precice.Participant(name, xml, 0, 1)
x = np.arange(6.0) if left else 5 - np.arange(6.0)
u, v, k = (1 - 0.1 * x if left else 0.3 * x - 0.5), np.zeros(6), (40 + 4 * x if left else 30 + 2 * x)
for wrong in ((lambda: participant.set_mesh_vertices(mesh, np.zeros((2, 3)))), (lambda: participant.write_data(mesh, mine, [0], [1.0]))):
    try:
        wrong()
        sys.exit("a wrong call was accepted")
    except RuntimeError as error:
        print("refused:", error, flush=True)
ids = participant.set_mesh_vertices(mesh, np.column_stack((x, 0 * x)))
if participant.requires_initial_data():
    participant.write_data(mesh, mine, ids, u)
participant.initialize()
t, window, spring = 0.0, participant.get_max_time_step_size(), 15
with open(f"{name}-0.txt", "w") as file:
    while participant.is_coupling_ongoing():
        if participant.requires_writing_checkpoint():
            kept = u, v, t
        most = participant.get_max_time_step_size()
        h = most if most < 1.5 * window / steps else window / steps
        w0, w1 = participant.read_data(mesh, other, ids, 0), participant.read_data(mesh, other, ids, h)
        force = spring * (w0 + w1) / 2 - (k + spring) * (u + h / 4 * v)
        v_new = (v + h * force) / (1 + h * h / 4 * (k + spring))
        u, v = u + h / 2 * (v + v_new), v_new
        participant.write_data(mesh, mine, ids, u)
        participant.advance(h)
        t += h
        if participant.requires_reading_checkpoint():
            u, v, t = kept
        elif participant.is_time_window_complete():
            print(repr(t), *map(repr, u.tolist()), file=file)
participant.finalize()
