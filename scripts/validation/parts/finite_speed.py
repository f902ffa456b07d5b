# SPDX-License-Identifier: Apache-2.0
"""Large strain beside CalculiX: case E on the same mesh, whole processes on one core, processor seconds turn by turn."""
from validation.job import Bar

CONVERGED = 0.43134  # u1 / L at K = 1.6, Saint Venant-Kirchhoff


def race(across, along, times, most):
    def measure(job):
        found = job.beside("benchmarks/peers/race.py").bent_beam(job, across, along, 1.6, times)
        mine, u = found.pop("ours")
        words = [f"ours {mine:.2f} s ({100 * (u / CONVERGED - 1):+.2f} %)"]
        words += [f"{who} {s:.2f} s ({100 * (v / CONVERGED - 1):+.2f} %): {s / mine:.1f}x" for who, (s, v) in found.items()]
        if not found:
            return "; ".join(words) + "; CalculiX is not installed", None if most is None else False
        return "; ".join(words), None if most is None else min(s for s, _ in found.values()) / mine >= most
    return measure


BARS = [
    Bar("E, Saint Venant-Kirchhoff, K 1.6 on 4x4x40: processor seconds of whole processes beside CalculiX C3D8, C3D8I", "reported",
        race(4, 40, 3, None)),
    Bar("the same on 8x8x80, median of three, turn by turn", ">= 10x faster", race(8, 80, 3, 10)),
    Bar("segregated updated-Lagrangian solver with Aitken (thesis 2.39-2.40), agreement on case E and speed", "agree; >= 20x faster",
        lambda job: ("not run: not built", False)),
    Bar("the linear run's verdict on geometric non-linearity against the true difference, 6 pairs", "within a factor of 1.5",
        lambda job: ("not run: not built; the verdict tells the largest displacement gradient and no difference", False)),
    Bar("flap at U = 20 m/s coupled, finite strain beside linear; semi-implicit and implicit", "printed; within 1 %",
        lambda job: ("not run", False)),
    Bar("maps of stretch and shear of case E, as figures 3.12, 3.13 of the thesis", "drawn", lambda job: ("not run: not built", False)),
]
