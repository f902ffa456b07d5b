# SPDX-License-Identifier: Apache-2.0
"""The default's errors beside those of the corrected gradient, which was the default when the bars were asked; and plate B on all cells."""
from validation import solid_gradients
from validation.job import Bar

SCENES = ("LE10", "LE11, hexahedra, refine 4", "LE1, quadrilaterals 64x96", "cylinder under pressure, triangles", "spherical cavity",
          "heated cylinder")


def default(name):
    """Stress (or displacement) by the default and by the corrected gradient at equal meshes; the symmetric one's factor is said."""
    scene = next(s for s in solid_gradients.SCENES if s[0].startswith(name))

    def measure(job):
        _, case, sets, errors = scene
        found = {}
        for gradient in ("auto", "corrected", "symmetric"):
            run = job.solve_run("solid_solver", case, (*sets, "participants.solid.solution-method={face-gradient: %s, relative-tolerance: 1e-8}" % gradient))
            found[gradient] = {kind: error(job, run) for kind, error in errors.items()}
        met = all(found["auto"][k] <= found["corrected"][k] * (1 + 1e-6) for k in errors)
        return "; ".join(f"{'u' if k == 'u' else 'stress'}: default {found['auto'][k]:.3g} %, corrected {found['corrected'][k]:.3g} %, symmetric "
                         f"{found['symmetric'][k]:.3g} % ({found['symmetric'][k] / found['corrected'][k]:.2f} times)" for k in errors), met
    return measure


def plate(shape, limit):
    """Displacement at (2, 0, 0.6) against 64x96x48 hexahedra."""
    def measure(job):
        run = job.solve_run("solid_solver", "elliptic-plate", (
            solid_gradients.POINTS, solid_gradients.mesh(nr=16, nt=24, nz=12, shape=shape),
            "participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-8}"))
        error = solid_gradients.like_fine("P z [m]")(job, run)
        return f"{error:.3f} %", error <= limit
    return measure


NINE_POINTS = tuple(solid_gradients.nine_points(which) for which in (0, 1))


def hexahedra(job, n, volume="auto"):
    """Errors of displacement and von Mises stress [%] at the nine points on n = (nr, nt, nz) hexahedra."""
    run = job.solve_run("solid_solver", "elliptic-plate", (
        "participants.solid.mesh-parameters={nr: %d, nt: %d, nz: %d}" % n,
        "participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-8, volume-strain: %s}" % volume))
    return [error(job, run) for error in NINE_POINTS]


def finest(job):
    u, stress = hexahedra(job, (64, 96, 48))
    return f"u {u:.3f} %, stress {stress:.3f} %", u <= 0.05


def plate_stress(job):
    got = [hexahedra(job, n)[1] for n in ((16, 24, 12), (32, 48, 24), (64, 96, 48))]
    return ", ".join(f"{s:.3f} %" for s in got), all(s <= limit for s, limit in zip(got, (0.5, 0.3, 0.2)))


POINT = "at one point, (2, 0, 0.6), against 64x96x48 hexahedra of the same gradient"
BARS = [
    *(Bar(f"{name}: error of the default beside the corrected gradient's", "at most as large", default(name), long=name == "LE10",
          but="the default of these scenes is still the corrected gradient")
      for name in SCENES),
    Bar("plate B, hexahedra 64x96x48: displacement at the nine points", "within 0.05 %", finest, long=True),
    Bar("plate B, hexahedra 16x24x12, 32x48x24, 64x96x48: von Mises stress", "within 0.5, 0.3, 0.2 %", plate_stress, long=True,
        but="at the nine points, not over all cells but the rim"),
    Bar("plate B, 27 648 tetrahedra: displacement", "within 0.25 %", plate(2, 0.25), long=True, but=POINT),
    Bar("plate B, prisms of 16x24x12: displacement", "within 0.45 %", plate(1, 0.45), long=True, but=POINT),
]
