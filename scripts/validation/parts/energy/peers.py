# SPDX-License-Identifier: Apache-2.0
"""Measures of the symmetric gradient's speed and memory on the elliptic plate, beside OpenFOAM and CalculiX: whole processes on one core."""
import math

from validation.parts.solid.speed import FINEST, race

# Each row's own mesh is about the coarsest that has the error.


def sooner(job, error, mine, other, who, wanted):
    if other is None:
        return f"{who} is not installed", False
    ratio = other["seconds"] / mine["seconds"]
    text = (f"{100 * mine['error']:.3f} % in {mine['seconds']:.2f} s, {who} {100 * other['error']:.2f} % in {other['seconds']:.2f} s: "
            f"{ratio:.1f} times")
    return text, mine["error"] <= error and ratio >= wanted


def beside(job, error, mesh, method, peer_mesh, element, solver, wanted, times=3):
    mine = race(job).our_plate(job, mesh, method, times=times)
    other = race(job).calculix(job, peer_mesh, element, solver)
    return sooner(job, error, mine, other, f"CalculiX {element} {'x'.join(map(str, peer_mesh))}", wanted)


def ranks(job):
    """Wall seconds of the solve on one rank and on two, turn by turn, the better of two."""
    best = {}
    for _ in range(2):
        for n in (1, 2):
            run = job.case_run(job.root / "configs/elliptic-plate/case.yaml", job.scratch / f"plate-{n}",
                               ("participants.solid.mesh-parameters={nr: %d, nt: %d, nz: %d}" % FINEST,
                                "participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-8}"), {"solid": n}, 1200)
            line = next(line for line in run.log.splitlines() if line.startswith("solid: linear solver"))
            best[n] = min(best.get(n, 1e9), float(line.split()[3]))
    return f"{best[1]:.2f} s and {best[2]:.2f} s: {best[1] / best[2]:.2f} times", best[1] / best[2] >= 1.8


def product(job):
    """Nanoseconds per cell of one product K u: the least of three runs."""
    best = None
    for i in range(3):
        run = job.case_run(job.root / "configs/elliptic-plate/case.yaml", job.scratch / f"product-{i}",
                           ("participants.solid.mesh-parameters={nr: %d, nt: %d, nz: %d}" % FINEST,
                            "participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-6}"), {"solid": 1}, 1200)
        words = next(line for line in run.log.splitlines() if line.startswith("solid: products")).split()
        each = 1e9 * float(words[2]) / float(words[-1]) / math.prod(FINEST)
        best = each if best is None else min(best, each)
    return f"{best:.0f} ns on {math.prod(FINEST)} hexahedra", best < 100


def porous(job):
    """Seconds of the linear solver, symmetric beside corrected, one run of each."""
    seconds, words = {}, []
    study = job.beside("configs/porous-body/study.py")
    for gradient in ("corrected", "symmetric"):
        got = study.run(job, 69, method=f"newton-krylov, {gradient}")
        seconds[gradient] = got["solve"]
        words.append(f"{gradient} {got['solve']:.1f} s, {got['iterations']} iterations")
    return f"{'; '.join(words)}; {got['cells']} tetrahedra", seconds["symmetric"] <= seconds["corrected"]
