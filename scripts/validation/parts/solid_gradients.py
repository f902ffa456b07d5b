# SPDX-License-Identifier: Apache-2.0
"""The three face gradients on all committed cases of a linear solid: errors against processor time, from which the defaults follow.
One row a case and mesh; what each gradient errs by in displacement (u) and stress (s), and the processor seconds of its whole process
(the least of three turns, one gradient after the other in each turn)."""
import math

import numpy as np

import couplet


GRADIENTS = ("thesis", "corrected", "symmetric")
TURNS = 3
CLEARLY = 2 / 3  # of the other's error: less is a clear win


def probe(run, column):
    return couplet.read_csv(run.folder / "solid" / "probes.csv")[column][-1]


def off(value, wanted):
    return 100 * abs(value / wanted - 1)


def nine_points(job, run, which):
    return 100 * job.beside("configs/elliptic-plate/nine_points.py").errors(run.folder / "solid")[which]


POINTS = "participants.solid.probes={P: {point: [2, 0, 0.6], fields: [displacement, stress]}}"


def like_fine(job, run, column):
    """Against 64x96x48 hexahedra with the symmetric gradient."""
    fine = job.alone("elliptic-plate", (POINTS, "participants.solid.mesh-parameters={nr: 64, nt: 96, nz: 48}",
                         "participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-8}"))
    return off(probe(run, column), probe(fine, column))


def kirsch(job, run):
    """Root mean square of the cells' stress over the load far away."""
    series = couplet.find_series(run.folder / "solid")
    last, centres = len(series.times) - 1, series.centres()
    q, angle = 0.25 / (centres[:, 0] ** 2 + centres[:, 1] ** 2), np.arctan2(centres[:, 1], centres[:, 0])
    c2, c4, s2, s4 = np.cos(2 * angle), np.cos(4 * angle), np.sin(2 * angle), np.sin(4 * angle)
    wanted = 1e6 * np.array([1 - q * (1.5 * c2 + c4) + 1.5 * q * q * c4, -q * (0.5 * c2 - c4) - 1.5 * q * q * c4,
                             -q * (0.5 * s2 + s4) + 1.5 * q * q * s4])
    found = np.array([series.field(last, f"stress-{c}") for c in ("xx", "yy", "xy")])
    return 100 * math.sqrt(np.mean((found - wanted) ** 2)) / 1e6


INNER, OUTER, PRESSURE = 7.0, 18.625, 100e6
LAME = PRESSURE * INNER**2 / (OUTER**2 - INNER**2)


def lame_stress(job, run):
    """Root mean square of the cells' radial and hoop stress over the pressure."""
    series = couplet.find_series(run.folder / "solid")
    last, centres = len(series.times) - 1, series.centres()
    r, angle = np.hypot(centres[:, 0], centres[:, 1]), np.arctan2(centres[:, 1], centres[:, 0])
    xx, yy, xy = (series.field(last, f"stress-{c}") for c in ("xx", "yy", "xy"))
    c, s = np.cos(angle), np.sin(angle)
    radial, hoop = c * c * xx + s * s * yy + 2 * c * s * xy, s * s * xx + c * c * yy - 2 * c * s * xy
    b = LAME * OUTER**2 / r**2
    return 100 * math.sqrt(np.mean((radial - LAME + b) ** 2 + (hoop - LAME - b) ** 2)) / PRESSURE


def lame_motion(job, run):
    """Radial, inside, in plane strain."""
    return off(probe(run, "inside x [m]"), 1.3 / 10e9 * INNER * (0.4 * LAME + LAME * OUTER**2 / INNER**2))


def hoop(job, run):
    return 100 * job.beside("configs/heated-cylinder/errors.py").errors(run.folder / "solid")["hoop"]


def period(job, run):
    return off(job.beside("configs/vibrating-cantilever/vibration.py").numbers(run.folder / "solid")["period"], 20.03)


def errors_of(job, run, wanted):
    """{kind: error [%]}; `wanted`: [column of a probe, right value], or the name of a function of this file with what it takes."""
    return {kind: off(probe(run, first), rest[0]) if "[" in first and rest else globals()[first](job, run, *rest)
            for kind, (first, *rest) in wanted.items()}


def settings(mesh, more=()):
    return ("participants.solid.mesh-parameters={%s}" % mesh, *more)


def compared(job, case, mesh, wanted, more=()):
    """{gradient: ({kind: error [%]}, processor seconds)}; a gradient that cannot: its message."""
    name = (case, mesh, more)

    def make():
        found = {}
        for turn in range(TURNS + 1):  # the first one meshes
            for gradient in GRADIENTS:
                method = f"participants.solid.solution-method={{face-gradient: {gradient}, relative-tolerance: 1e-8}}"
                run = job.case_run(job.root / "configs" / case / "case.yaml", job.scratch / f"turn-{abs(hash((name, gradient, turn)))}",
                                   (*settings(mesh, more), method), {"solid": 1}, 600)
                if turn == 0:
                    found[gradient] = (errors_of(job, run, wanted), math.inf)
                else:
                    found[gradient] = (found[gradient][0], min(found[gradient][1], run.cost.cpu))
        return found
    return job.once(("gradients", name), make)


def compare(job, *scene):
    """A scene, as `compared` takes it."""
    return "; ".join(f"{g}: {', '.join(f'{k} {e:.3g} %' for k, e in errors.items())}, {cpu:.2f} s"
                     for g, (errors, cpu) in compared(job, *scene).items()), None


def scenes():
    """{quantity: scene} of the rows of this table."""
    from validation import rows
    return rows.arguments("solid-gradients", "compare")


def verdict(job, gradient):
    """Scenes and kinds of error in which it errs clearly less than both others."""
    won, total = [], 0
    for name, scene in scenes().items():
        found = compared(job, *scene)
        for kind in scene[2]:
            total += 1
            if found[gradient][0][kind] < CLEARLY * min(found[g][0][kind] for g in GRADIENTS if g != gradient):
                won.append(f"{name} ({kind})")
    return f"{len(won)} of {total}" + (": " + "; ".join(won) if won else ""), None
