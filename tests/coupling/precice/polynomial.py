# SPDX-License-Identifier: Apache-2.0
"""Left writes polynomials in time at its sub-steps, of unequal length, and Right reads them anywhere in the window: a polynomial up to the degree of the
interpolation arrives to rounding, the next one does not; with degree 0 Right reads the next value that was written. What counts is the last iteration of each window. Usage: polynomial.py Left|Right XML DEGREE"""
import sys

import numpy as np
import precice

name, xml, degree = sys.argv[1], sys.argv[2], int(sys.argv[3])
mesh = f"{name}-Mesh"
p = precice.Participant(name, xml, 0, 1)
powers = np.arange(degree + 2)  # of each vertex
ids = p.set_mesh_vertices(mesh, np.column_stack((powers, 0 * powers)))
value = lambda t: (1 + t) ** powers  # noqa: E731
shares = (0.2, 0.35, 0.6, 0.9, 1)  # of the window: sub-steps
seen = lambda s: s if degree else min(q for q in (0, *shares) if q >= s)  # noqa: E731
if p.requires_initial_data():
    p.write_data(mesh, f"Displacement-{name}", ids, value(0) if name == "Left" else 0 * powers)
p.initialize()
start, t, worst, beyond = 0.0, 0.0, 0.0, 0.0
window = p.get_max_time_step_size()
p.requires_writing_checkpoint()
while p.is_coupling_ongoing():
    if name == "Left":
        for share in shares:
            h = min(start + share * window - t, p.get_max_time_step_size())
            p.write_data(mesh, "Displacement-Left", ids, value(t + h))
            p.advance(h)
            t += h
    else:
        errors = np.array([abs(p.read_data(mesh, "Displacement-Left", ids, s * window) - value(t + seen(s) * window)) for s in np.linspace(0, 1, 14)]) / value(1.0)
        p.write_data(mesh, "Displacement-Right", ids, value(t + window))
        p.advance(window)
        t += window
    if p.requires_reading_checkpoint():
        t = start
    elif p.is_time_window_complete():
        start = t
        if name == "Right":
            worst, beyond = max(worst, errors[:, :-1].max()), max(beyond, errors[:, -1].max())
    p.requires_writing_checkpoint()
p.finalize()
if name == "Right":
    print(f"worst {worst:.3e} beyond {beyond:.3e}", flush=True)
