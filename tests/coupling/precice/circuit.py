# SPDX-License-Identifier: Apache-2.0
"""A coil and a capacitor that swing against each other, I' = U and U' = -I, each by Simpson's rule over its sub-steps (exact for what it reads, if
that is cubic), so that the error is that of the interpolation in time. Usage: circuit.py Left|Right XML STEPS"""
import sys

import precice

name, xml, steps = sys.argv[1], sys.argv[2], int(sys.argv[3])
left = name == "Left"
mesh, mine, other = f"{name}-Mesh", f"Displacement-{name}", "Displacement-" + ("Right" if left else "Left")
p = precice.Participant(name, xml, 0, 1)
ids = p.set_mesh_vertices(mesh, [[0.0, 0.0]])
own, sign = (1.0, 1) if left else (0.0, -1)
if p.requires_initial_data():
    p.write_data(mesh, mine, ids, [own])
p.initialize()
window = p.get_max_time_step_size()
while p.is_coupling_ongoing():
    if p.requires_writing_checkpoint():
        kept = own
    most = p.get_max_time_step_size()
    h = most if most < 1.5 * window / steps else window / steps
    a, b, c = (p.read_data(mesh, other, ids, share * h)[0] for share in (0, 0.5, 1))
    own += sign * h * (a + 4 * b + c) / 6
    p.write_data(mesh, mine, ids, [own])
    p.advance(h)
    if p.requires_reading_checkpoint():
        own = kept
p.finalize()
print(f"{name} ends with {float(own)!r}", flush=True)
