# SPDX-License-Identifier: Apache-2.0
"""The solid on an energy: bending, near incompressibility, modes, waves, other programs."""
import csv
import math

import numpy as np

import couplet
from validation.parts import solid_gradients
from validation.parts.solid_linear import FINEST, probe, race


# -- bending ----------------------------------------------------------------------------------------------------------
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


def plate_displacement(job, limits, volume="auto"):  # limits: None to report
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


# -- defaults ---------------------------------------------------------------------------------------------------------
def hexahedra(job, n, volume="auto"):
    """Errors of displacement and von Mises stress [%] at the nine points on n = (nr, nt, nz) hexahedra."""
    run = job.alone("elliptic-plate", (
        "participants.solid.mesh-parameters={nr: %d, nt: %d, nz: %d}" % n,
        "participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-8, volume-strain: %s}" % volume))
    return [solid_gradients.nine_points(job, run, which) for which in (0, 1)]


def finest(job):
    u, stress = hexahedra(job, (64, 96, 48))
    return f"u {u:.3f} %, stress {stress:.3f} %", u <= 0.05


# -- plate ------------------------------------------------------------------------------------------------------------
REFERENCE = 128  # cells from the hole to the rim; 112 s and 4 GB


def nine_points(job):
    return job.beside("configs/elliptic-plate/nine_points.py")


def shape_of(n):
    return [n, 3 * n // 2, 3 * n // 4]


def fields(job, n, shape=0):
    """Displacement and stress at the places of the grid."""
    def make():
        run = job.alone("elliptic-plate", (
            "participants.solid.mesh-parameters={nr: %d, nt: %d, nz: %d, shape: %d}" % (*shape_of(n), shape),
            "participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-8}"))
        tools, series = nine_points(job), couplet.find_series(run.folder / "solid")
        last, points = len(series.times) - 1, series.file["mesh/coordinates"][...]
        centres = np.array([points[list(cell)].mean(axis=0) for cell in series.cells])
        place = (*tools.grid(centres, shape_of(n)), shape_of(n))
        stress = np.stack([series.field(last, name) for name in tools.STRESS], axis=-1)
        return tools.means(series.field(last, "cell-displacement"), *place), tools.means(stress, *place)
    return job.once(("plate B, all cells", n, shape), make)


def averaged(values, k):
    a, b, c, m = values.shape
    return values.reshape(a // k, k, b // k, k, c // k, k, m).mean(axis=(1, 3, 5))


def gap(got, wanted):
    return 100 * np.linalg.norm(got - wanted) / np.linalg.norm(wanted)


def displacement(job, limits, shape=0):
    """Relative L2 norm over the cells [%]."""
    errors = {n: gap(fields(job, n, shape)[0], averaged(fields(job, REFERENCE)[0], REFERENCE // n)) for n in limits}
    return ", ".join(f"{e:.3f} %" for e in errors.values()), all(errors[n] <= limit for n, limit in limits.items())


def stress(job, limits):
    """Von Mises stress without the layers of cells at the clamped rim, whose edges are singular: one layer counts, two are reported."""
    von_mises, words, met = nine_points(job).von_mises, [], True
    for layers in (1, 2):
        errors = []
        for n in limits:
            got, wanted = von_mises(fields(job, n)[1]), von_mises(averaged(fields(job, REFERENCE)[1], REFERENCE // n))
            errors.append(gap(got[:-layers], wanted[:-layers]))
        words.append(", ".join(f"{e:.3f} %" for e in errors) + f" without {layers} layer{'s' if layers > 1 else ''} of cells")
        met = met and (layers > 1 or all(e <= limit for e, limit in zip(errors, limits.values())))
    return "; ".join(words), met


# -- modes ------------------------------------------------------------------------------------------------------------
THIN_PLATE = (13.468, 19.596, 24.271)  # omega a^2 sqrt(rho h / D), Leissa 1969
SCALE = math.sqrt(210e9 * 0.01**3 / (12 * (1 - 0.3**2)) / (7800 * 0.01))


def frequencies(job, case, name, *overrides):
    folder = job.alone(case, overrides).folder
    with open(folder / name / "modes.csv", encoding="utf-8") as file:
        return [float(row["frequency [Hz]"]) for row in csv.DictReader(file)]


def beam(job, length, side):
    found = frequencies(job, "vibrating-cantilever", "solid", f"participants.solid.mesh-parameters={{n_length: {length}, n_side: {side}}}",
                        "participants.solid.solution-method.face-gradient=symmetric", "participants.solid.output.modes=2",
                        "simulation.end-time=1e-3", "simulation.time-step=1e-3")
    return 1 / found[0]


def slope(values):
    coarse, middle, fine = values
    return math.log2(abs((coarse - middle) / (middle - fine)))


def first_period(job):
    periods = [beam(job, *mesh) for mesh in ((20, 2), (40, 4), (80, 8))]
    off, order = periods[-1] / 20.03 - 1, slope(periods)
    return f"{', '.join(f'{p:.3f}' for p in periods)} s ({100 * off:+.2f} %), slope {order:.2f}", abs(off) <= 0.005 and order >= 1.8


def modes_of_plate(job, n, m):
    found = frequencies(job, "free-plate", "plate", f"participants.plate.mesh-parameters={{n: {n}, m: {m}}}",
                        "participants.plate.solution-method.preconditioner=factors")
    return [2 * math.pi * f / SCALE for f in found[6:9]]


def free_plate(job):
    meshes = [modes_of_plate(job, *mesh) for mesh in ((8, 1), (16, 2), (32, 4))]
    off = [100 * (f / w - 1) for f, w in zip(meshes[-1], THIN_PLATE)]
    order = [slope([mesh[i] for mesh in meshes]) for i in range(3)]
    return (f"{', '.join(f'{f:.3f}' for f in meshes[-1])} ({', '.join(f'{o:+.2f}' for o in off)} %), slopes {', '.join(f'{o:.2f}' for o in order)}",
            max(map(abs, off)) <= 0.5 and min(order) >= 1.8)


# -- wave -------------------------------------------------------------------------------------------------------------
SCHEMES = {"trapezoidal": "{type: trapezoidal}", "Bathe": "{type: bathe}", "generalised-alpha 0.5": "{type: generalised-alpha, spectral-radius: 0.5}",
           "three-point": "{type: three-point}", "Euler": "{type: euler}"}
LOAD, HEIGHT, DENSITY, YOUNG, LENGTH, END = 1000.0, 0.01, 1000.0, 1e6, 1.0, 0.06
SPEED = (YOUNG / DENSITY) ** 0.5
BACK = SPEED * END - LENGTH  # way of the reflected front [m]
KINETIC = 0.5 * DENSITY * (LOAD / (DENSITY * SPEED)) ** 2 * HEIGHT * (LENGTH - BACK)
STRAIN = 0.5 * LOAD**2 / YOUNG * HEIGHT * (LENGTH - BACK + 4 * BACK)


def wave(job, scheme):
    run = job.alone("wave-bar", (f"participants.solid.time-scheme={SCHEMES[scheme]}",))
    probes = couplet.read_csv(run.folder / "solid" / "probes.csv")
    energies = couplet.read_csv(run.folder / "solid" / "energies.csv")
    before = 0.045  # the reflected front is not there yet
    most = max(s for t, s in zip(probes["time [s]"], probes["middle stress-xx [Pa]"]) if t < before) / LOAD - 1
    whole = KINETIC + STRAIN
    off = (energies["kinetic [J]"][-1] + energies["strain [J]"][-1]) / whole - 1
    least = min(lost - before for before, lost in zip([0.0, *energies["lost by the scheme [J]"]], energies["lost by the scheme [J]"])) / whole
    return (f"overshoot {100 * most:.0f} %; energy {100 * off:+.2f} % of the closed form, lost "
            f"{100 * energies['lost by the scheme [J]'][-1] / whole:.2f} %, least loss of a step {least:+.1e}"), (
                None if scheme == "Euler" else abs(off) <= 0.01 and least >= -1e-8)


# -- peers ------------------------------------------------------------------------------------------------------------
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
