#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Flow in an elastic tube in one dimension (Degroote et al. 2008), as two participants and as one monolithic program.
Usage: tube.py fluid|wall   (in a job)  |  tube.py monolithic [STEPS [DT [CELLS]]]

Mass and momentum of a tube of area a, a_t + (a v)_x = 0, (a v)_t + (a v^2)_x + a p_x = 0 (a unit of density), backward Euler,
central differences with a pressure term that keeps neighbours together; the wall answers at once,
a = a_0 ((2 c^2 - p_0) / (2 c^2 - p))^2. The velocity of the inlet oscillates, the outlet is non-reflecting."""
import pathlib
import sys

import numpy as np

LENGTH, CELLS, V0, P0 = 10.0, 100, 10.0, 0.0
R0 = 1 / np.sqrt(np.pi)
A0, C2 = 1.0, 1e4 / (2 * R0)  # c^2 = E / (2 r_0), E 1e4 times h = 1


def inlet(t):
    return V0 + 3 * np.sin(10 * np.pi * t)


def area(p):
    return A0 * ((2 * C2 - P0) / (2 * C2 - p)) ** 2


class Flow:
    def __init__(self, cells=CELLS):
        self.n, self.dx = cells, LENGTH / cells
        self.v, self.p, self.a = np.full(cells, V0), np.full(cells, P0), np.full(cells, area(P0))
        self.p_out, self.v_out = P0, V0

    def outlet(self, v_out):
        """Pressure at the outlet at t^{n+1} from the wave that leaves."""
        return 2 * (C2 - (np.sqrt(C2 - self.p_out / 2) - (v_out - self.v_out) / 4) ** 2)

    def residual(self, x, t, dt, walls):
        """x: (v, p); walls: areas at t^{n+1}, or None where the wall is part of the system."""
        v, p = x[:self.n], x[self.n:]
        a = area(p) if walls is None else walls
        v_out = 1.5 * v[-1] - 0.5 * v[-2]
        p_out = self.outlet(v_out)
        p_in = 1.5 * p[0] - 0.5 * p[1]
        a_face = np.concatenate([[a[0]], (a[1:] + a[:-1]) / 2, [a[-1]]])
        v_face = np.concatenate([[inlet(t)], (v[1:] + v[:-1]) / 2, [v_out]])
        p_face = np.concatenate([[p_in], (p[1:] + p[:-1]) / 2, [p_out]])
        stabilise = 0.01 * A0 / (V0 + self.dx / dt)
        jump = np.concatenate([[0], p[1:] - p[:-1], [2 * (p_out - p[-1])]])
        flux = a_face * v_face - stabilise * jump
        mass = (a - self.a) * self.dx / dt + flux[1:] - flux[:-1]
        convected = flux * v_face
        momentum = ((a * v - self.a * self.v) * self.dx / dt + convected[1:] - convected[:-1] + a * (p_face[1:] - p_face[:-1]))
        return np.concatenate([mass, momentum])

    def solve(self, t, dt, walls=None):
        """Returns (v, p) at t = t^{n+1} by Newton's method; derivatives by complex steps, five cells apart at once."""
        x = np.concatenate([self.v, self.p])
        for _ in range(30):
            r = self.residual(x, t, dt, walls)
            if np.abs(r).max() < 1e-11 * C2 * self.dx / dt:
                return x[:self.n], x[self.n:]
            jacobian = np.zeros((2 * self.n, 2 * self.n))
            for half in (0, self.n):
                for colour in range(5):
                    moved = half + np.arange(colour, self.n, 5)
                    z = x.astype(complex)
                    z[moved] += 1e-30j
                    derivative = self.residual(z, t, dt, walls).imag / 1e-30
                    for j in moved:
                        i = np.arange(max(0, j - half - 2), min(self.n, j - half + 3))
                        jacobian[i, j], jacobian[self.n + i, j] = derivative[i], derivative[self.n + i]
            x = x - np.linalg.solve(jacobian, r)
        raise RuntimeError("Newton's method of the tube does not converge")

    def accept(self, v, p, a):
        v_out = 1.5 * v[-1] - 0.5 * v[-2]
        self.p_out, self.v_out = self.outlet(v_out), v_out
        self.v, self.p, self.a = v, p, a


def surface(job, out):
    """Points and faces of the wall, one each a cell; `out`: which way is out of the participant."""
    x = (np.arange(CELLS) + 0.5) * LENGTH / CELLS
    places = np.column_stack([x, np.full(CELLS, R0), np.zeros(CELLS)])
    job.vertices(places, dimension=2)
    job.faces(places, np.tile([0, out * LENGTH / CELLS, 0], (CELLS, 1)))


def fluid():
    import couplet
    job = couplet.Client("fluid", "tube_fluid")
    surface(job, 1)
    job.takes("displacement", "m", "vertices")
    job.takes("velocity", "m/s", "vertices")
    job.gives("pressure-force", "N", "faces")
    job.gives("viscous-force", "N", "faces")
    flow = Flow()
    with open("tube.csv", "w") as file:
        for event in job:
            if event == "solve":
                a = np.pi * (R0 + job.read("displacement")[:, 1]) ** 2
                v, p = flow.solve(job.time + job.dt, job.dt, a)
                job.write("pressure-force", np.column_stack([0 * p, p * LENGTH / CELLS]))
                job.write("viscous-force", np.zeros((CELLS, 2)))
            elif event == "accept":
                flow.accept(v, p, a)
                print(job.time, p[CELLS // 2], a[CELLS // 2], v[CELLS // 2], sep=",", file=file, flush=True)
            elif event == "save":
                np.savez(job.checkpoint() + ".npz", rows=[flow.v, flow.p, flow.a], out=[flow.p_out, flow.v_out])
            elif event == "load":
                state = np.load(job.checkpoint() + ".npz")
                (flow.v, flow.p, flow.a), (flow.p_out, flow.v_out) = state["rows"], state["out"]


def wall():
    import couplet
    job = couplet.Client("wall", "tube_wall")
    surface(job, -1)
    job.takes("pressure-force", "N", "faces")
    job.takes("viscous-force", "N", "faces")
    job.gives("displacement", "m", "vertices")
    job.gives("velocity", "m/s", "vertices")
    now = np.zeros(CELLS)
    for event in job:
        if event == "solve":
            p = job.read("pressure-force")[:, 1] * CELLS / LENGTH
            new = np.sqrt(area(p) / np.pi) - R0
            job.write("displacement", np.column_stack([0 * new, new]))
            job.write("velocity", np.column_stack([0 * new, (new - now) / job.dt]))
        elif event == "accept":
            now = new
        elif event == "save":
            np.save(job.checkpoint() + ".npy", now)
        elif event == "load":
            now = np.load(job.checkpoint() + ".npy")


def monolithic(steps=100, dt=0.01, cells=CELLS):
    """Rows (t, p, a, v) of the cell in the middle, flow and wall as one system."""
    flow, rows = Flow(cells), []
    for n in range(1, steps + 1):
        v, p = flow.solve(n * dt, dt)
        flow.accept(v, p, area(p))
        rows.append((n * dt, p[cells // 2], flow.a[cells // 2], v[cells // 2]))
    return np.array(rows)


if __name__ == "__main__":
    if sys.argv[1] == "monolithic":
        given = [kind(word) for kind, word in zip((int, float, int), sys.argv[2:])]
        np.savetxt(sys.stdout, monolithic(*given), delimiter=",", fmt="%.10g")
    else:
        sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "client/python"))
        {"fluid": fluid, "wall": wall}[sys.argv[1]]()
