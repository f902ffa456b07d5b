# SPDX-License-Identifier: Apache-2.0
"""Two meshes of one participant in the same place: pressures at nodes and heat at centres go to one mesh of the other, nodes get
temperatures back. Usage: meshes.py Fluid|Solid XML"""
import sys

import numpy as np
import precice

name, xml = sys.argv[1:]
p = precice.Participant(name, xml, 0, 1)
windows = 0
if name == "Fluid":
    nodes, centres = np.arange(5.0), np.arange(4) + 0.5
    ids = {mesh: p.set_mesh_vertices(mesh, np.column_stack((x, 0 * x))) for mesh, x in (("Nodes", nodes), ("Centres", centres))}
    p.initialize()
    while p.is_coupling_ongoing():
        dt = p.get_max_time_step_size()
        temperature = p.read_data("Nodes", "Temperature", ids["Nodes"], 0)
        wanted = windows + nodes if windows else 0 * nodes
        assert np.array_equal(temperature, wanted), f"temperatures {temperature} in place of {wanted}"
        p.write_data("Nodes", "Pressure", ids["Nodes"], 10 * windows + nodes)
        p.write_data("Centres", "Heat", ids["Centres"], [[j + 1, -windows] for j in range(4)])
        p.advance(dt)
        windows += 1
else:
    points = np.arange(5) + 0.4  # nearest to a centre each, but for the last
    ids = p.set_mesh_vertices("Solid", np.column_stack((points, 0 * points)))
    p.initialize()
    while p.is_coupling_ongoing():
        dt = p.get_max_time_step_size()
        pressure, heat = p.read_data("Solid", "Pressure", ids, dt), p.read_data("Solid", "Heat", ids, dt)
        assert np.array_equal(pressure, 10 * windows + np.arange(5.0)), f"pressures {pressure}"
        assert np.allclose(heat.sum(axis=0), [10, -4 * windows], rtol=1e-14), f"heats {heat}"
        windows += 1
        p.write_data("Solid", "Temperature", ids, windows + np.arange(5.0))
        p.advance(dt)
assert windows == 5
p.finalize()
print(name, "has seen what it should", flush=True)
