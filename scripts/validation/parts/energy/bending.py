# SPDX-License-Identifier: Apache-2.0
"""Measures of the symmetric face gradient in bending and near incompressibility: Cook's membrane, the elliptic plate."""
import couplet
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


def meshes(job, limits, extra=SHARED):
    errors = [100 * (corner(job, n, 0, 70e6, 1 / 3, extra) / 32.3007 - 1) for n in (8, 16, 32)]
    text = ", ".join(f"{e:+.2f} %" for e in errors)
    return text, None if limits is None else all(abs(e) <= limit for e, limit in zip(errors, limits))


def ratios(job, shape, limit):
    errors = [100 * (corner(job, 32, shape, 250e6, nu, SHARED) / wanted - 1) for nu, wanted in CORNER.items()]
    return ", ".join(f"{nu:.4g}: {e:+.2f} %" for nu, e in zip(CORNER, errors)), all(abs(e) <= limit for e in errors)


def plate(job, limits, volume="auto"):  # limits: None to report
    got = [hexahedra(job, n, volume) for n in ((16, 24, 12), (32, 48, 24))]
    return ("; ".join(f"u {u:.3f} %, stress {s:.3f} %" for u, s in got),
            None if limits is None else all(u <= limit for (u, _), limit in zip(got, limits)))


def krylov(job, preconditioner, bodies, volume="auto"):
    """Iterations at nu 0.4999 over those at 1/3, relative tolerance 1e-8."""
    words, worst = [], 0
    for name, case, sets in bodies:
        counts = []
        for nu in (1 / 3, 0.4999):
            run = job.alone(case, (*sets, f"participants.solid.material.poissons-ratio={nu}",
                                "participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-8, "
                                "max-iterations: 20000, preconditioner: %s, volume-strain: %s}" % (preconditioner, volume)))
            counts.append(couplet.read_csv(run.folder / "solid" / "solver.csv")["iterations"][-1])
        words.append(f"{name}: {counts[1]:.0f} over {counts[0]:.0f}")
        worst = max(worst, counts[1] / counts[0])
    return "; ".join(words), worst <= 1.5
