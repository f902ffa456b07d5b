# SPDX-License-Identifier: Apache-2.0
"""The solid on an energy: bending, near incompressibility, modes, waves, other programs."""
import numpy as np

from validation.parts.solid_linear import FINEST, race


# -- bending ----------------------------------------------------------------------------------------------------------
SHARED = (
    "participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-10, volume-strain: shared}"
)
# Upper corner [mm] at E = 250 MPa, plane strain, by quadratic finite elements refined to convergence.
CORNER = {1 / 3: 9.044, 0.45: 8.223, 0.48: 7.959, 0.49: 7.866, 0.499: 7.781, 0.4999: 7.771}


def ratios(job, shape, limit):
    errors = []
    for nu, wanted in CORNER.items():
        run = job.case(
            "cook",
            (
                f".mesh-parameters={{n: 32, shape: {shape}}}",
                ".material.youngs-modulus=250e6",
                f".material.poissons-ratio={nu}",
                SHARED,
            ),
        )
        errors.append(100 * (1e3 * run.last("solid", "probes.csv")["corner y [m]"] / wanted - 1))
    return ", ".join(f"{nu:.4g}: {e:+.2f} %" for nu, e in zip(CORNER, errors)), all(abs(e) <= limit for e in errors)


def krylov(job, preconditioner, bodies, volume="auto"):
    """Iterations at nu 0.4999 over those at 1/3, relative tolerance 1e-8."""
    words, worst = [], 0
    for name, case, sets in bodies:
        counts = [
            job.case(
                case,
                (
                    *sets,
                    f".material.poissons-ratio={nu}",
                    ".solution-method={face-gradient: symmetric, relative-tolerance: 1e-8, max-iterations: 20000, "
                    "preconditioner: %s, volume-strain: %s}" % (preconditioner, volume),
                ),
            ).last("solid", "solver.csv")["iterations"]
            for nu in (1 / 3, 0.4999)
        ]
        words.append(f"{name}: {counts[1]:.0f} over {counts[0]:.0f}")
        worst = max(worst, counts[1] / counts[0])
    return "; ".join(words), worst <= 1.5


# -- plate ------------------------------------------------------------------------------------------------------------
REFERENCE = 128  # cells from the hole to the rim; 112 s and 4 GB


def nine_points(job):
    return job.beside("configs/elliptic-plate/nine_points.py")


def shape_of(n):
    return [n, 3 * n // 2, 3 * n // 4]


def fields(job, n, shape=0):
    """Displacement and stress at the places of the grid."""

    def make():
        run = job.case(
            "elliptic-plate",
            (
                "participants.solid.mesh-parameters={nr: %d, nt: %d, nz: %d, shape: %d}" % (*shape_of(n), shape),
                "participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-8}",
            ),
        )
        tools, series = nine_points(job), run.fields("solid")
        last, place = len(series.times) - 1, (*tools.grid(series.centres(), shape_of(n)), shape_of(n))
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
    """Von Mises stress without the layers of cells at the clamped rim, whose edges are singular: one layer counts, two
    are reported."""
    von_mises, words, met = nine_points(job).von_mises, [], True
    for layers in (1, 2):
        errors = []
        for n in limits:
            got, wanted = von_mises(fields(job, n)[1]), von_mises(averaged(fields(job, REFERENCE)[1], REFERENCE // n))
            errors.append(gap(got[:-layers], wanted[:-layers]))
        words.append(
            ", ".join(f"{e:.3f} %" for e in errors) + f" without {layers} layer{'s' if layers > 1 else ''} of cells"
        )
        met = met and (layers > 1 or all(e <= limit for e, limit in zip(errors, limits.values())))
    return "; ".join(words), met


# -- wave -------------------------------------------------------------------------------------------------------------
SCHEMES = {
    "trapezoidal": "{type: trapezoidal}",
    "Bathe": "{type: bathe}",
    "generalised-alpha 0.5": "{type: generalised-alpha, spectral-radius: 0.5}",
    "three-point": "{type: three-point}",
    "Euler": "{type: euler}",
}
LOAD, HEIGHT, DENSITY, YOUNG, LENGTH, END = 1000.0, 0.01, 1000.0, 1e6, 1.0, 0.06
SPEED = (YOUNG / DENSITY) ** 0.5
BACK = SPEED * END - LENGTH  # way of the reflected front [m]
KINETIC = 0.5 * DENSITY * (LOAD / (DENSITY * SPEED)) ** 2 * HEIGHT * (LENGTH - BACK)
STRAIN = 0.5 * LOAD**2 / YOUNG * HEIGHT * (LENGTH - BACK + 4 * BACK)


def wave(job, scheme):
    run = job.case("wave-bar", (f"participants.solid.time-scheme={SCHEMES[scheme]}",))
    probes, energies = run.probes("solid"), run.table("solid", "energies.csv")
    before = 0.045  # the reflected front is not there yet
    most = max(s for t, s in zip(probes["time [s]"], probes["middle stress-xx [Pa]"]) if t < before) / LOAD - 1
    whole = KINETIC + STRAIN
    off = (energies["kinetic [J]"][-1] + energies["strain [J]"][-1]) / whole - 1
    least = np.diff(energies["lost by the scheme [J]"], prepend=0).min() / whole
    return (
        (
            f"overshoot {100 * most:.0f} %; energy {100 * off:+.2f} % of the closed form, lost "
            f"{100 * energies['lost by the scheme [J]'][-1] / whole:.2f} %, least loss of a step {least:+.1e}"
        ),
        (None if scheme == "Euler" else abs(off) <= 0.01 and least >= -1e-8),
    )


# -- peers ------------------------------------------------------------------------------------------------------------
# Each row's own mesh is about the coarsest that has the error.


def sooner(job, error, mine, other, who, wanted):
    if other is None:
        return f"{who} is not installed", False
    ratio = other["seconds"] / mine["seconds"]
    text = (
        f"{100 * mine['error']:.3f} % in {mine['seconds']:.2f} s, {who} {100 * other['error']:.2f} % in"
        f" {other['seconds']:.2f} s: {ratio:.1f} times"
    )
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
            run = job.case_run(
                job.root / "configs/elliptic-plate/case.yaml",
                job.scratch / f"plate-{n}",
                (
                    "participants.solid.mesh-parameters={nr: %d, nt: %d, nz: %d}" % FINEST,
                    "participants.solid.solution-method={face-gradient: symmetric, relative-tolerance: 1e-8}",
                ),
                {"solid": n},
                1200,
            )
            line = next(line for line in run.log.splitlines() if line.startswith("solid: linear solver"))
            best[n] = min(best.get(n, 1e9), float(line.split()[3]))
    return f"{best[1]:.2f} s and {best[2]:.2f} s: {best[1] / best[2]:.2f} times", best[1] / best[2] >= 1.8
