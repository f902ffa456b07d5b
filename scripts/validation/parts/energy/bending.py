# SPDX-License-Identifier: Apache-2.0
"""Bars of the symmetric face gradient in bending and near incompressibility: Cook's membrane, the elliptic plate."""
import couplet
from validation.job import Bar
from validation.parts.energy.defaults import hexahedra
from validation.parts.solid.cases import probe

SYMMETRIC = "participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-10}"
# Upper corner [mm] at E = 250 MPa, plane strain, by quadratic finite elements refined to convergence.
CORNER = {1 / 3: 9.044, 0.45: 8.223, 0.48: 7.959, 0.49: 7.866, 0.499: 7.781, 0.4999: 7.771}


def corner(job, n, shape, modulus, nu, extra=()):
    return 1e3 * probe(job, "cook", ("participants.solid.mesh-parameters={n: %d, shape: %d}" % (n, shape),
                                     f"participants.solid.material.youngs-modulus={modulus}",
                                     f"participants.solid.material.poissons-ratio={nu}", SYMMETRIC, *extra), "corner y [m]")


SHARED = ("participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-10, volume-strain: shared}",)
NOT_DEFAULT = "volume-strain: shared, which is not the default: below nu 0.4 that is the faces', above it the cells'"


def meshes(limits, extra=SHARED):
    def measure(job):
        errors = [100 * (corner(job, n, 0, 70e6, 1 / 3, extra) / 32.3007 - 1) for n in (8, 16, 32)]
        text = ", ".join(f"{e:+.2f} %" for e in errors)
        return text, None if limits is None else all(abs(e) <= limit for e, limit in zip(errors, limits))
    return measure


def ratios(shape, limit):
    def measure(job):
        errors = [100 * (corner(job, 32, shape, 250e6, nu, SHARED) / wanted - 1) for nu, wanted in CORNER.items()]
        return ", ".join(f"{nu:.4g}: {e:+.2f} %" for nu, e in zip(CORNER, errors)), all(abs(e) <= limit for e in errors)
    return measure


def plate(limits, volume="auto"):  # limits: None to report
    def measure(job):
        got = [hexahedra(job, n, volume) for n in ((16, 24, 12), (32, 48, 24))]
        return ("; ".join(f"u {u:.3f} %, stress {s:.3f} %" for u, s in got),
                None if limits is None else all(u <= limit for (u, _), limit in zip(got, limits)))
    return measure


def krylov(preconditioner, bodies, volume="auto"):
    """Iterations at nu 0.4999 over those at 1/3, relative tolerance 1e-8."""
    def measure(job):
        words, worst = [], 0
        for name, case, sets in bodies:
            counts = []
            for nu in (1 / 3, 0.4999):
                run = job.solve_run("solid_solver", case, (*sets, f"participants.solid.material.poissons-ratio={nu}",
                                    "participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-8, "
                                    "max-iterations: 20000, preconditioner: %s, volume-strain: %s}" % (preconditioner, volume)))
                counts.append(couplet.read_csv(run.folder / "solid" / "solver.csv")["iterations"][-1])
            words.append(f"{name}: {counts[1]:.0f} over {counts[0]:.0f}")
            worst = max(worst, counts[1] / counts[0])
        return "; ".join(words), worst <= 1.5
    return measure


COOK = [("quadrilaterals", "cook", ("participants.solid.mesh-parameters={n: 32, shape: 0}",)),
        ("triangles", "cook", ("participants.solid.mesh-parameters={n: 32, shape: 1}",))]
PLATE = [(name, "elliptic-plate", ("participants.solid.mesh-parameters={nr: %d, nt: %d, nz: %d, shape: %d}" % (*mesh, shape),))
         for name, mesh, shape in (("hexahedra", (16, 24, 12), 0), ("prisms", (16, 24, 12), 1), ("tetrahedra", (8, 12, 6), 2))]

BARS = [
    Bar("Cook, nu 1/3, quadrilaterals 8, 16, 32 a side", "within 0.3, 0.15, 0.05 % of 32.3007 mm", meshes((0.3, 0.15, 0.05)), but=NOT_DEFAULT),
    Bar("the same with the default, the volume strain of the faces", "reported", meshes(None, ())),
    Bar("Cook from nu 1/3 to 0.4999, 32x32 quadrilaterals", "within 0.4 %", ratios(0, 0.4), but=NOT_DEFAULT),
    Bar("Cook from nu 1/3 to 0.4999, 32x32 pairs of triangles", "within 0.4 %", ratios(1, 0.4), but=NOT_DEFAULT),
    Bar("plate B, hexahedra 16x24x12 and 32x48x24: displacement at the nine points", "within 0.45 and 0.15 %", plate((0.45, 0.15))),
    Bar("the same with volume-strain: shared", "reported", plate(None, "shared")),
    Bar("mixed displacement-pressure form: Krylov iterations at 0.4999 over those at 1/3, Cook 32x32 quadrilaterals", "<= 1.5",
        krylov("mixed", COOK[:1], "cells")),
    Bar("the same, 32x32 pairs of triangles", "<= 1.5", krylov("mixed", COOK[1:], "cells")),
    Bar("the same in three dimensions: plate B, 16x24x12 hexahedra", "<= 1.5", krylov("mixed", PLATE[:1], "cells")),
    Bar("the same: 16x24x12 hexahedra cut in two prisms", "<= 1.5", krylov("mixed", PLATE[1:2], "cells")),
    Bar("the same: 8x12x6 hexahedra cut in six tetrahedra", "<= 1.5", krylov("mixed", PLATE[2:], "cells")),
    Bar("the program's own choice for small bodies, Cholesky factors of the whole operator", "<= 1.5", krylov("auto", COOK)),
]
