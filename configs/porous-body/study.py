# SPDX-License-Identifier: Apache-2.0
"""Runs of the porous body for the validation: what one costs and gives."""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1] / "client/python"), str(HERE)]
import generate  # noqa: E402

METHODS = {  # keys of solution-method; the thesis's operator and tolerance
    "segregated": "type: segregated, face-gradient: thesis, relative-tolerance: 1e-7",
    "block-coupled": "type: block-coupled, linear-solver: bicgstab-ilu, face-gradient: thesis, relative-tolerance: 1e-7",
    "newton-krylov": "type: newton-krylov, face-gradient: symmetric, relative-tolerance: 1e-7",
}


def mesh_of(job, n):
    """Returns (file, tetrahedra, boundary faces) of the lattice with n cells along the cube."""
    def make():
        file = job.scratch / f"porous-{n}.msh"
        points, tets, triangles, patch = generate.make(n)
        generate.write_msh(file, points, tets, triangles, patch)
        return file, len(tets), len(triangles)
    return job.once(("porous-body", n), make)


def run(job, n, ranks=1, method="newton-krylov", extra=()):
    """Force [N], iterations, seconds and memory of one compression. `extra`: further --set."""
    file, tets, _ = mesh_of(job, n)
    sets = (f"participants.solid.mesh={file}", "participants.solid.solution-method={%s}" % METHODS[method],
            "participants.solid.output={stress: false}", *extra)
    results = job.case("porous-body", sets, ranks, timeout=7200)
    reactions, solver, report = results.table("solid", "reactions.csv"), results.table("solid", "solver.csv"), results.report("solid")
    return {"cells": tets, "force": reactions["bottom z [N]"][-1], "iterations": int(solver["iterations"][-1]),
            "inner": int(solver["inner iterations"][-1]), "seconds": report["wall"],
            "solve": report["phases"]["solid: linear solver"],
            "memory": report["memory-most"], "memory on all": report["memory-all"]}
