# SPDX-License-Identifier: Apache-2.0
"""A flap of FEniCSx (DOLFINx 0.5: plane strain, quadratic quadrilaterals, trapezoidal rule), in one process, that replaces
the solid_solver of configs/perpendicular-flap on the launch line.   Usage: flap_fenicsx.py PARTICIPANT [ALONG ACROSS]"""
import sys

import couplet
import numpy as np
import petsc4py
import ufl
from mpi4py import MPI

name, along, across = sys.argv[1], *(int(n) for n in (sys.argv[2:4] or (80, 8)))
rho, young, nu, half, height = 3000.0, 4e6, 0.3, 0.05, 1.0
job = couplet.Client(name, "flap_fenicsx")
petsc4py.init(comm=job.comm)  # before DOLFINx; otherwise PETSc uses all processes of the job and waits for them
from dolfinx import fem, mesh  # noqa: E402
from dolfinx.fem.petsc import assemble_matrix  # noqa: E402
from petsc4py import PETSc  # noqa: E402

body = mesh.create_rectangle(MPI.COMM_SELF, [[-half, 0], [half, height]], [across, along], mesh.CellType.quadrilateral)
space = fem.VectorFunctionSpace(body, ("CG", 2))
u, w = ufl.TrialFunction(space), ufl.TestFunction(space)
strain = ufl.sym(ufl.grad(u))
stress = young / (1 + nu) * (strain + nu / (1 - 2 * nu) * ufl.tr(strain) * ufl.Identity(2))
root = fem.locate_dofs_geometrical(space, lambda x: np.isclose(x[1], 0))
K, M = (assemble_matrix(fem.form(f * ufl.dx)) for f in (ufl.inner(stress, ufl.grad(w)), rho * ufl.inner(u, w)))
K.assemble(), M.assemble()

# The wetted side: facets with their nodes (ends and middle). The ends are the vertices of the interface.
wet = mesh.locate_entities_boundary(body, 1, lambda x: (abs(abs(x[0]) - half) < 1e-9) | (x[1] > height - 1e-9))
at = space.tabulate_dof_coordinates()
sides = []
for facet in wet:
    nodes = fem.locate_dofs_topological(space, 1, np.array([facet], np.int32))
    middle = nodes[np.argmin(np.linalg.norm(at[nodes] - at[nodes].mean(0), axis=1))]
    sides.append([n for n in nodes if n != middle] + [middle])
sides = np.array(sides)
vertices = np.unique(sides[:, :2])
span = at[sides[:, 1]] - at[sides[:, 0]]
normal = np.column_stack([span[:, 1], -span[:, 0], 0 * span[:, 0]])
centres = at[sides[:, 2]]
outwards = np.sign(np.einsum("ij,ij->i", normal, centres - [0, 0.5 * height, 0]))
job.vertices(at[vertices], dimension=2)
job.faces(centres, normal * outwards[:, None], np.searchsorted(vertices, sides[:, :2]).tolist())
job.takes("pressure-force", "N", "faces")
job.takes("viscous-force", "N", "faces")
job.gives("displacement", "m", "vertices")
job.gives("velocity", "m/s", "vertices")

x, v, x_next, v_next = (K.createVecRight() for _ in range(4))
solver, factors_of = PETSc.KSP().create(MPI.COMM_SELF), None
solver.setType("preonly"), solver.getPC().setType("lu")
clamped = np.ravel([[2 * n, 2 * n + 1] for n in root]).astype(np.int32)
with open(name + ".csv", "w") as file:
    for event in job:
        if event == "solve":  # M (v' - v)/dt + K (x + x')/2 = f,  x' = x + dt (v + v')/2
            if job.dt != factors_of:
                system, factors_of = M * (2 / job.dt**2) + K * 0.5, job.dt
                system.zeroRowsColumns(clamped, 1)
                solver.setOperators(system)
            load = np.zeros((len(at), 2))
            force = job.read("pressure-force") + job.read("viscous-force")
            for place, share in zip(sides.T, (1 / 6, 1 / 6, 2 / 3)):  # Simpson: a constant traction on each facet
                np.add.at(load, place, share * force)
            right = M * (x * (2 / job.dt**2) + v * (2 / job.dt)) - K * (x * 0.5) + PETSc.Vec().createWithArray(load.ravel())
            right.array[clamped] = 0
            solver.solve(right, x_next)
            v_next = (x_next - x) * (2 / job.dt) - v
            job.write("displacement", x_next.array.reshape(-1, 2)[vertices])
            job.write("velocity", v_next.array.reshape(-1, 2)[vertices])
        elif event == "accept":
            x_next.copy(x), v_next.copy(v)
            tip = np.argmin(np.linalg.norm(at - [0, height, 0], axis=1))
            print(job.time, x.array[2 * tip], sep=",", file=file, flush=True)
        elif event == "save":
            np.save(job.checkpoint() + ".npy", [x.array, v.array])
        elif event == "load":
            x.array, v.array = np.load(job.checkpoint() + ".npy")
