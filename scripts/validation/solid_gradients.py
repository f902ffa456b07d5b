# SPDX-License-Identifier: Apache-2.0
"""The three face gradients on all committed cases of a linear solid: errors against processor time, from which the defaults follow.
One row a case and mesh; what each gradient errs by in displacement (u) and stress (s), and the processor seconds of its whole process
(the least of three turns, one gradient after the other in each turn)."""
import math

import numpy as np

import couplet
from validation.job import Bar

GRADIENTS = ("thesis", "corrected", "symmetric")
TURNS = 3
CLEARLY = 2 / 3  # of the other's error: less is a clear win


def probe(run, column):
    return couplet.read_csv(run.folder / "solid" / "probes.csv")[column][-1]


def off(value, wanted):
    return 100 * abs(value / wanted - 1)


def at(column, wanted):
    return lambda job, run: off(probe(run, column), wanted)


def nine_points(which):
    return lambda job, run: 100 * job.beside("configs/elliptic-plate/nine_points.py").errors(run.folder / "solid")[which]


POINTS = "participants.solid.probes={P: {point: [2, 0, 0.6], fields: [displacement, stress]}}"


def like_fine(column):
    """Against 64x96x48 hexahedra with the symmetric gradient."""
    def error(job, run):
        fine = job.solve_run("solid_solver", "elliptic-plate", (POINTS, "participants.solid.mesh-parameters={nr: 64, nt: 96, nz: 48}",
                             "participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-8}"))
        return off(probe(run, column), probe(fine, column))
    return error


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


LAME_U = 1.3 / 10e9 * INNER * (0.4 * LAME + LAME * OUTER**2 / INNER**2)  # radial, inside [m], plane strain


def hoop(job, run):
    return 100 * job.beside("configs/heated-cylinder/errors.py").errors(run.folder / "solid")["hoop"]


def period(job, run):
    return off(job.beside("configs/vibrating-cantilever/vibration.py").numbers(run.folder / "solid")["period"], 20.03)


def mesh(**values):
    return "participants.solid.mesh-parameters={%s}" % ", ".join(f"{k}: {v}" for k, v in values.items())


STATIC_PLATE = ("participants.solid.analysis=static", "participants.solid.damping=~", "simulation.time-step=0.03",
                *("participants.solid.boundaries.edge-%s={type: hard-support}" % a for a in "xy"))
COOK_U, KIRSCH, HOOP = {"u": at("corner y [m]", 32.3007e-3)}, {"s": kirsch}, {"s": hoop}
LAME_ERRORS = {"u": at("inside x [m]", LAME_U), "s": lame_stress}
NINE = {"u": nine_points(0), "s": nine_points(1)}
FINE = {"u": like_fine("P z [m]"), "s": like_fine("P stress-yy [Pa]")}
SWING = ("simulation.end-time=60", "simulation.output.interval=1000 s", "participants.solid.time-scheme={type: bathe}")
# Name, case, settings, errors.
SCENES = [
    ("plate B, hexahedra 16x24x12, nine points", "elliptic-plate", (mesh(nr=16, nt=24, nz=12),), NINE),
    ("plate B, hexahedra 32x48x24, nine points", "elliptic-plate", (mesh(nr=32, nt=48, nz=24),), NINE),
    ("plate B, prisms of 16x24x12, at (2, 0, 0.6)", "elliptic-plate", (mesh(nr=16, nt=24, nz=12, shape=1), POINTS), FINE),
    ("plate B, tetrahedra of 16x24x12, at (2, 0, 0.6)", "elliptic-plate", (mesh(nr=16, nt=24, nz=12, shape=2), POINTS), FINE),
    ("LE1, quadrilaterals 16x24, stress at D", "le1", (mesh(nr=16, nt=24),), {"s": at("D stress-yy [Pa]", 92.66e6)}),
    ("LE1, quadrilaterals 64x96, stress at D", "le1", (mesh(nr=64, nt=96),), {"s": at("D stress-yy [Pa]", 92.66e6)}),
    ("LE10, hexahedra 32x48x24, stress at D", "le10", (mesh(nr=32, nt=48, nz=24),), {"s": at("D stress-yy [Pa]", -5.38e6)}),
    ("LE11, hexahedra, refine 2, stress at A", "le11", (mesh(refine=2),), {"s": at("A stress-zz [Pa]", -105.67e6)}),
    ("LE11, hexahedra, refine 4, stress at A", "le11", (mesh(refine=4),), {"s": at("A stress-zz [Pa]", -105.67e6)}),
    ("Cook, nu 1/3, quadrilaterals 32x32, corner", "cook", (mesh(n=32, shape=0),), COOK_U),
    ("Cook, nu 1/3, triangles 32x32, corner", "cook", (mesh(n=32, shape=1),), COOK_U),
    ("Kirsch's hole, quadrilaterals, stress of cells", "kirsch-hole", (mesh(n=24, nr=32, growth=10, shape=0),), KIRSCH),
    ("Kirsch's hole, triangles, stress of cells", "kirsch-hole", (mesh(n=24, nr=32, growth=10, shape=1),), KIRSCH),
    ("cylinder under pressure, quadrilaterals 16x24", "lame-cylinder", (mesh(nr=16, nt=24, shape=0),), LAME_ERRORS),
    ("cylinder under pressure, triangles 16x24", "lame-cylinder", (mesh(nr=16, nt=24, shape=1),), LAME_ERRORS),
    ("spherical cavity, hexahedra n 16, stress at the equator", "spherical-cavity", (mesh(n=16, nr=48),), {"s": at("equator stress-zz [Pa]", 2.04545e6)}),
    ("heated cylinder, hexahedra, 20 through the wall, hoop stress", "heated-cylinder", (mesh(nr=20),), HOOP),
    ("cantilever C, cubes 20x2x2, tip", "cantilever", (mesh(n_length=20, n_side=2),), {"u": at("tip y [m]", 0.10008)}),
    ("cantilever C, cubes 40x4x4, tip", "cantilever", (mesh(n_length=40, n_side=4),), {"u": at("tip y [m]", 0.10008)}),
    ("cantilever C, cells 5:1, 8x4x4, tip", "cantilever", (mesh(n_length=8, n_side=4),), {"u": at("tip y [m]", 0.10008)}),
    ("thick plate D, static, 30x30x5, centre", "thick-plate", (*STATIC_PLATE, mesh(n=30, nz=5)), {"u": at("centre z [m]", -2.3198e-3)}),
    ("cantilever C vibrates, 20x2x2, Bathe, step 0.1 s: period", "vibrating-cantilever", (mesh(n_length=20, n_side=2), *SWING), {"u": period}),
    ("cantilever C vibrates, 40x4x4, Bathe, step 0.2 s: period", "vibrating-cantilever",
     (mesh(n_length=40, n_side=4), *SWING, "simulation.time-step=0.2"), {"u": period}),
]


def compare(job, scene):
    """{gradient: ({kind: error [%]}, processor seconds)}; a gradient that cannot: its message."""
    name, case, sets, errors = scene

    def make():
        found = {}
        for turn in range(TURNS + 1):  # the first one meshes
            for gradient in GRADIENTS:
                method = f"participants.solid.solution-method={{face-gradient: {gradient}, relative-tolerance: 1e-8}}"
                run = job.case_run(job.root / "configs" / case / "case.yaml", job.scratch / f"turn-{abs(hash((name, gradient, turn)))}",
                                   (*sets, method), {"solid": 1}, 600)
                if turn == 0:
                    found[gradient] = ({kind: error(job, run) for kind, error in errors.items()}, math.inf)
                else:
                    found[gradient] = (found[gradient][0], min(found[gradient][1], run.cost.cpu))
        return found
    return job.once(("gradients", name), make)


def row(scene):
    def measure(job):
        found = compare(job, scene)
        return "; ".join(f"{g}: {', '.join(f'{k} {e:.3g} %' for k, e in errors.items())}, {cpu:.2f} s"
                         for g, (errors, cpu) in found.items()), None
    return measure


def wins(job, gradient):
    """Scenes and kinds of error in which it errs clearly less than both others."""
    result = []
    for scene in SCENES:
        found = compare(job, scene)
        for kind in scene[3]:
            others = [found[g][0][kind] for g in GRADIENTS if g != gradient]
            if found[gradient][0][kind] < CLEARLY * min(others):
                result.append(f"{scene[0]} ({kind})")
    return result


def verdict(gradient):
    def measure(job):
        found, total = wins(job, gradient), sum(len(s[3]) for s in SCENES)
        return f"{len(found)} of {total}" + (": " + "; ".join(found) if found else ""), None
    return measure


LONG = ("hexahedra 32x48x24", "tetrahedra of")
BARS = [*(Bar(s[0], "reported", row(s), long=any(w in s[0] for w in LONG)) for s in SCENES),
        *(Bar(f"errors in which {g} has less than two thirds of both others'", "reported", verdict(g), long=True) for g in GRADIENTS)]
