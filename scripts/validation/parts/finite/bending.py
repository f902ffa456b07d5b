# SPDX-License-Identifier: Apache-2.0
"""Static bars of large strain: case E of the thesis, Turek and Hron's bar, Cook's membrane."""
import math

import couplet

S = "participants.solid."
# u1 / L of converged three-dimensional finite elements (L = 10 sides).
SVK = {0.2: 0.06639, 0.4: 0.13108, 0.8: 0.24992, 1.6: 0.43134}
NEO = {5: 0.720308, 10: 0.823304}


def last(run_folder, name="probes.csv"):
    table = couplet.read_csv(run_folder / "solid" / name)
    return {key: values[-1] for key, values in table.items()}


def beam(job, across, along, law, load, length=2.0, steps=1):
    """Deflection over the length and the iterations of each load step."""
    pull = load * 15.293e6 * (0.2**4 / 12) / (0.04 * length**2) / math.sqrt(2)
    run = job.alone("bent-beam", (
        "%smesh-parameters={n: %d, m: %d, L: %g}" % (S, across, along, length), f"{S}material.law={law}",
        f"{S}boundaries.tip.value=[{pull!r}*t, {pull!r}*t, 0]", f"{S}probes={{tip: {{point: [0, 0, {length}]}}}}",
        f"simulation.time-step={1 / steps!r}"))
    tip = last(run.folder)
    newton = couplet.read_csv(run.folder / "solid" / "solver.csv")["iterations"]
    return math.hypot(tip["tip x [m]"], tip["tip y [m]"]) / length, newton


def kirchhoff(job, across):
    errors = {K: 100 * (beam(job, across, 10 * across, "saint-venant-kirchhoff", K)[0] / u - 1) for K, u in SVK.items()}
    return ", ".join(f"K {K}: {e:+.3f} %" for K, e in errors.items()), all(abs(e) <= 0.3 for e in errors.values())


def hook(job, across, sides, wanted):
    u, newton = beam(job, across, sides * across, "neo-hookean", 10, 0.2 * sides)
    error = 100 * (u / wanted - 1)
    return f"{u:.5f}, {error:+.3f} %, {len(newton)} load steps that were accepted", abs(error) <= 0.3


EDGE = {"quarter": (0.1, 0.1, 0.5), "middle": (0.1, 0.1, 1.0)}  # places on an edge of the section


def edge_stress(job, across):
    """The stress tensors [Pa] there, as two rows xx, yy, zz, xy, yz, xz."""
    pull = 5 * 15.293e6 * (0.2**4 / 12) / (0.04 * 4) / math.sqrt(2)
    probes = ", ".join("%s: {point: [%g, %g, %g], fields: [stress]}" % (name, *x) for name, x in EDGE.items())
    run = job.alone("bent-beam", (
        "%smesh-parameters={n: %d, m: %d, L: 2}" % (S, across, 10 * across), f"{S}material.law=neo-hookean",
        f"{S}boundaries.tip.value=[{pull!r}*t, {pull!r}*t, 0]", "%sprobes={%s}" % (S, probes), "simulation.time-step=1"))
    tip = last(run.folder)
    return [[tip[f"{name} stress-{c} [Pa]"] for c in ("xx", "yy", "zz", "xy", "yz", "xz")] for name in EDGE]


def distance(a, b):
    """Frobenius norm of the difference of two symmetric tensors."""
    return math.sqrt(sum((1 if i < 3 else 2) * (x - y) ** 2 for i, (x, y) in enumerate(zip(a, b))))


def slopes(job):
    """Of three meshes halved twice, by what they differ from each other."""
    u = [beam(job, n, 10 * n, "neo-hookean", 5)[0] for n in (2, 4, 8)]
    stress = [edge_stress(job, n) for n in (2, 4, 8)]
    of_u = math.log2((u[1] - u[0]) / (u[2] - u[1])) if (u[1] - u[0]) * (u[2] - u[1]) > 0 else 0
    of_stress = [math.log2(distance(b, a) / distance(c, b)) for a, b, c in zip(*stress)]
    off = ", ".join(f"{100 * (v / NEO[5] - 1):+.3f} %" for v in u)
    return (f"u {of_u:.2f}; stress {', '.join(f'{o:.2f}' for o in of_stress)}; u off by {off} of 0.720308",
            of_u >= 1.7 and min(of_stress) >= 0.9)


def thin(job, across, along):
    u, _ = beam(job, across, along, "saint-venant-kirchhoff", 1.6)
    return f"{u:.5f}, {100 * (u / SVK[1.6] - 1):+.2f} % of the converged value", True


def newton_steps(job):
    worst = max(max(beam(job, n, 10 * n, "saint-venant-kirchhoff", 1.6)[1]) for n in (4, 8))
    hooked = max(max(beam(job, n, 10 * n, "neo-hookean", 10, steps=8)[1]) for n in (4, 8))
    return f"at most {worst:.0f} (Saint Venant-Kirchhoff, one step to K 1.6), {hooked:.0f} (neo-Hookean, eight to K 10)", max(
        worst, hooked) <= 10


def cook_incompressible(job):
    """nu 0.4999, mu 0.4225 MPa: against the value extrapolated from 16, 32 and 64 cells per side, one load step each."""
    values, newton = [], []
    for n in (16, 32, 64):
        run = job.alone("cook", (
            "%smesh-parameters={n: %d, shape: 0}" % (S, n), f"{S}kinematics=finite-strain",
            f"{S}material.law=nearly-incompressible-neo-hookean", f"{S}material.youngs-modulus=1.267e6",
            f"{S}material.poissons-ratio=0.4999", "simulation.max-step-halvings=0", f"{S}boundaries.loaded.value=[0, 62.5e3*t]",
            "%sprobes={mid: {point: [0.048, 0.052]}}" % S))
        values.append(1e3 * last(run.folder)["mid y [m]"])
        newton.append(last(run.folder, "solver.csv")["iterations"])
    limit = values[2] + (values[2] - values[1]) / 3
    error = 100 * (values[1] / limit - 1)
    return (f"{values[0]:.3f}, {values[1]:.3f}, {values[2]:.3f} mm; extrapolated {limit:.3f}, 32x32 {error:+.2f} % of it; one load step, "
            f"at most {max(newton):.0f} iterations", abs(error) <= 0.4)


def ring(job):
    """Displacement of the inner wall against 0.5 m, the incompressible closed form."""
    errors = []
    for n in (8, 16, 32):
        run = job.alone("rubber-ring", ("%smesh-parameters={n: %d}" % (S, n),))
        errors.append(last(run.folder)["inner wall x [m]"] / 0.5 - 1)
    orders = [math.log2(a / b) for a, b in zip(errors, errors[1:])]
    return (", ".join(f"{100 * e:+.3f} %" for e in errors) + "; orders " + ", ".join(f"{o:.2f}" for o in orders),
            abs(errors[1]) <= 0.003 and min(orders) >= 1.8)
