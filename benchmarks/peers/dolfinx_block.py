#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The bonded block of configs/rubber-block by dolfinx 0.5 (Debian: python3-dolfinx): quadratic displacement, linear pressure, Newton's method with LU, steps of the
platen halved where it fails, at most 2.5 % of the height.
Usage: dolfinx_block.py N [N ...]   cells along half a side; prints one line each: N, the share of its height by which the block is compressed
at the last equilibrium, and how far its free surface then is beyond the platen [m]."""
import sys

import dolfinx.fem.petsc
import dolfinx.nls.petsc
import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from petsc4py import PETSc

HALF, YOUNG, POISSON = 0.5, 3e6, 0.4999
LONGEST, SHORTEST = 0.05, 1e-4  # of the way to half the height


def energy(u, p):
    """Perturbed Lagrangian of mu/2 (i1 - 3) + K/2 (J - 1)^2 in plane strain."""
    mu, bulk = YOUNG / 2 / (1 + POISSON), YOUNG / 3 / (1 - 2 * POISSON)
    f = ufl.Identity(2) + ufl.grad(u)
    j = ufl.det(f)
    return mu / 2 * (j**(-2 / 3) * (ufl.inner(f, f) + 1) - 3) + p * (j - 1) - p**2 / 2 / bulk


def problem(n):
    """Returns (unknowns, motion of the platen, Newton's method)"""
    body = mesh.create_rectangle(MPI.COMM_SELF, [[0, 0], [HALF, HALF]], [n, n], mesh.CellType.quadrilateral)
    pair = ufl.MixedElement([ufl.VectorElement("Lagrange", body.ufl_cell(), 2), ufl.FiniteElement("Lagrange", body.ufl_cell(), 1)])
    space = fem.FunctionSpace(body, pair)
    w = fem.Function(space)
    forces = ufl.derivative(energy(*ufl.split(w)) * ufl.dx(metadata={"quadrature_degree": 4}), w, ufl.TestFunction(space))
    zero, platen = fem.Constant(body, PETSc.ScalarType(0)), fem.Constant(body, PETSc.ScalarType(0))

    def held(axis, where, value):
        part = space.sub(0).sub(axis)
        return fem.dirichletbc(value, fem.locate_dofs_topological(part, 1, mesh.locate_entities_boundary(body, 1, where)), part)
    supports = [held(0, lambda x: np.isclose(x[1], HALF), zero), held(1, lambda x: np.isclose(x[1], HALF), platen),
                held(0, lambda x: np.isclose(x[0], 0), zero), held(1, lambda x: np.isclose(x[1], 0), zero)]
    newton = dolfinx.nls.petsc.NewtonSolver(MPI.COMM_SELF, dolfinx.fem.petsc.NonlinearProblem(forces, w, supports))
    newton.rtol, newton.atol, newton.max_it = 1e-9, 1e-6, 25
    options, prefix = PETSc.Options(), newton.krylov_solver.getOptionsPrefix()
    for key, value in (("ksp_type", "preonly"), ("pc_type", "lu"), ("pc_factor_mat_solver_type", "mumps")):
        options[prefix + key] = value
    newton.krylov_solver.setFromOptions()
    return w, platen, newton


def beyond(w, share):
    """Highest place of the free surface above the platen [m]."""
    u = fem.Function(w.function_space.sub(0).collapse()[0])
    u.interpolate(w.sub(0))
    places = u.function_space.tabulate_dof_coordinates()
    free = np.isclose(places[:, 0], HALF)
    return (places[free, 1] + u.x.array.reshape(-1, 2)[free, 1]).max() - HALF * (1 - share)


def main():
    for n in map(int, sys.argv[1:]):
        w, platen, newton = problem(n)
        done, step, last = 0.0, LONGEST, w.x.array.copy()
        while done < 1 - 1e-12 and step > SHORTEST:
            way = min(step, 1 - done)
            platen.value = -HALF / 2 * (done + way)
            try:
                iterations, _ = newton.solve(w)
                if not np.all(np.isfinite(w.x.array)):
                    raise RuntimeError("no numbers")
            except RuntimeError:
                w.x.array[:] = last
                step /= 2
                continue
            done += way
            last[:] = w.x.array
            step = min(LONGEST, 1.5 * step) if iterations < 8 else step
        print(n, f"{done / 2:.4f} {beyond(w, done / 2):.3g}", flush=True)


main()
