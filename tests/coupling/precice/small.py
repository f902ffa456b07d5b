# SPDX-License-Identifier: Apache-2.0
"""Small programs whose answers are known by hand. Prints, for each window, its end, its number of iterations, and what is read after it at that
time. Usage: small.py CASE NAME XML NUMBER"""
import json
import sys

import numpy as np
import precice

case, me, xml, number = *sys.argv[1:4], float(sys.argv[4])
p, mesh = precice.Participant(me, xml, 0, 1), f"{me}-Mesh"
other = {"Left": "Right", "Right": "Left"}.get(me)
points, elements, K = np.zeros((1, 2)), (), np.array([2.0, 1.0, 0.5]) * number
if case in ("time", "halves", "leave"):  # the one writes t, the other 10 t
    reads, answer = [f"Displacement-{other}"], lambda t, _: {f"Displacement-{me}": [t if me == "Left" else 10 * t]}
elif case == "springs":  # -K x on the one side, x = (F + 1000 N)/number on the other: linear, and the same for all numbers but for units
    points, reads = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), [f"Displacement-{other}"]
    answer = lambda t, read: {f"Displacement-{me}": -K * read[reads[0]] if me == "Left" else (read[reads[0]] + 1000) / number}  # noqa: E731
elif case.endswith("amounts"):  # 1 N at each of the points of the one side, and its place; a line in two dimensions, a square of triangles in three
    n, dim = {"Left": 5, "Right": 3}[me], int(number)
    side = np.linspace(0, 1, n)
    points = np.array([[x, 0] for x in side] if dim == 2 else [[x, y, 0] for y in side for x in side])
    corners = range(n - 1)
    elements = [[i, i + 1] for i in corners] if dim == 2 else [t for j in corners for a in (j * n + i for i in corners) for t in ([a, a + 1, a + n + 1], [a, a + n + 1, a + n])]
    elements = () if case in ("loose amounts", f"{me} loose amounts") else elements
    reads = ["Force", "Place"] if me == "Right" else []
    answer = lambda t, read: {"Force": np.tile(np.eye(dim)[1], (len(points), 1)), "Place": points[:, 0]} if me == "Left" else {}  # noqa: E731
else:  # Left = Near/2 + t; Near = -0.4 Left + 0.3 Right; Far = 0.6 Left - 0.2 Right; Right = 0.7 Far + 1
    reads = {"Left": ["Near"], "Right": ["Far"], "Middle": ["Left", "Right"]}[me]
    answer = {"Left": lambda t, read: {"Left": read["Near"] / 2 + t}, "Right": lambda t, read: {"Right": 0.7 * read["Far"] + 1},
              "Middle": lambda t, read: {"Near": 0.3 * read["Right"] - 0.4 * read["Left"], "Far": 0.6 * read["Left"] - 0.2 * read["Right"]}}[me]
ids = p.set_mesh_vertices(mesh, points)
if len(elements):
    (p.set_mesh_edges if len(elements[0]) == 2 else p.set_mesh_triangles)(mesh, ids[np.array(elements)])
p.initialize()
if case == "leave" and me in ("Left", number and "Right"):  # while the coupling is ongoing
    p.finalize()
    sys.exit()
t = kept = 0.0
windows, passes = [], 0
while p.is_coupling_ongoing():
    if p.requires_writing_checkpoint():
        kept = t
    dt = p.get_max_time_step_size()
    t, passes = t + dt, passes + 1
    for part in [dt / 2, dt / 2] if case == "halves" else [dt]:
        for datum, values in answer(t, {d: p.read_data(mesh, d, ids, part) for d in reads}).items():
            p.write_data(mesh, datum, ids, values)
        p.advance(part)
    if p.requires_reading_checkpoint():
        t = kept
        continue
    windows.append([t, passes, {d: p.read_data(mesh, d, ids, 0.0).tolist() for d in reads}])
    passes = 0
sys.stdout.write(f"{me} {json.dumps(windows)}\n")
sys.stdout.flush()
p.finalize()
