# SPDX-License-Identifier: Apache-2.0
"""The default's errors, since 2026-11-23 the symmetric gradient's, beside those of the corrected one, which was the default when the bars were asked."""
from validation import solid_gradients
from validation.job import Bar

SCENES = ("LE10", "LE11, hexahedra, refine 4", "LE1, quadrilaterals 64x96", "cylinder under pressure, triangles", "spherical cavity",
          "heated cylinder")


def default(name):
    """Stress (or displacement) by the default and by the corrected gradient at equal meshes; the symmetric one's factor is reported."""
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


BARS = [
    *(Bar(f"{name}: error of the default beside the corrected gradient's", "at most as large", default(name), long=name == "LE10")
      for name in SCENES),
    Bar("plate B, hexahedra 64x96x48: displacement at the nine points", "within 0.05 %", finest, long=True),
]
