# SPDX-License-Identifier: Apache-2.0
"""The default's errors, since 2026-11-23 the symmetric gradient's, beside those of the corrected one, which was the default when the bars were asked."""
from validation.parts.solid import gradients


def default(job, name):
    """Stress (or displacement) by the default and by the corrected gradient at equal meshes; the symmetric one's factor is reported."""
    case, mesh, wanted, *more = next(scene for quantity, scene in gradients.scenes().items() if quantity.startswith(name))
    found = {}
    for gradient in ("auto", "corrected", "symmetric"):
        method = "participants.solid.solution-method={face-gradient: %s, relative-tolerance: 1e-8}" % gradient
        run = job.alone(case, (*gradients.settings(mesh, *more), method))
        found[gradient] = gradients.errors_of(job, run, wanted)
    met = all(found["auto"][k] <= found["corrected"][k] * (1 + 1e-6) for k in wanted)
    return "; ".join(f"{'u' if k == 'u' else 'stress'}: default {found['auto'][k]:.3g} %, corrected {found['corrected'][k]:.3g} %, symmetric "
                     f"{found['symmetric'][k]:.3g} % ({found['symmetric'][k] / found['corrected'][k]:.2f} times)" for k in wanted), met


def hexahedra(job, n, volume="auto"):
    """Errors of displacement and von Mises stress [%] at the nine points on n = (nr, nt, nz) hexahedra."""
    run = job.alone("elliptic-plate", (
        "participants.solid.mesh-parameters={nr: %d, nt: %d, nz: %d}" % n,
        "participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-8, volume-strain: %s}" % volume))
    return [gradients.nine_points(job, run, which) for which in (0, 1)]


def finest(job):
    u, stress = hexahedra(job, (64, 96, 48))
    return f"u {u:.3f} %, stress {stress:.3f} %", u <= 0.05
