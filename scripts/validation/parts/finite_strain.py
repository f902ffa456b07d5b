# SPDX-License-Identifier: Apache-2.0
"""The solid at large strain: bending, motion, speed."""
import math

import numpy as np

import couplet


# -- bending ----------------------------------------------------------------------------------------------------------
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
    run = job.case("bent-beam", (
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
    run = job.case("bent-beam", (
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


def newton_steps(job):
    worst = max(max(beam(job, n, 10 * n, "saint-venant-kirchhoff", 1.6)[1]) for n in (4, 8))
    hooked = max(max(beam(job, n, 10 * n, "neo-hookean", 10, steps=8)[1]) for n in (4, 8))
    return f"at most {worst:.0f} (Saint Venant-Kirchhoff, one step to K 1.6), {hooked:.0f} (neo-Hookean, eight to K 10)", max(
        worst, hooked) <= 10


def cook_incompressible(job):
    """nu 0.4999, mu 0.4225 MPa: against the value extrapolated from 16, 32 and 64 cells per side, one load step each."""
    values, newton = [], []
    for n in (16, 32, 64):
        run = job.case("cook", (
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
        run = job.case("rubber-ring", ("%smesh-parameters={n: %d}" % (S, n),))
        errors.append(last(run.folder)["inner wall x [m]"] / 0.5 - 1)
    orders = [math.log2(a / b) for a, b in zip(errors, errors[1:])]
    return (", ".join(f"{100 * e:+.3f} %" for e in errors) + "; orders " + ", ".join(f"{o:.2f}" for o in orders),
            abs(errors[1]) <= 0.003 and min(orders) >= 1.8)


# -- motion -----------------------------------------------------------------------------------------------------------
MAXIMUM, MINIMUM = 2.873, -3.179  # u_x(A) [m], cubic spectral elements, refined


def column(job, across, along, shape=0, sets=()):
    run = job.case("bending-column",
                        ("%smesh-parameters={n: %d, m: %d, shape: %d}" % (S, across, along, shape), *sets))
    table = couplet.read_csv(run.folder / "solid" / "probes.csv")
    energies = couplet.read_csv(run.folder / "solid" / "energies.csv")
    whole = [k + s for k, s in zip(energies["kinetic [J]"], energies["strain [J]"])]
    return max(table["A x [m]"]), min(table["A x [m]"]), whole[-1] / whole[0] - 1


def swing(job, across, along, limit, shape=0, sets=()):
    most, least, drift = column(job, across, along, shape, sets)
    errors = [100 * (most / MAXIMUM - 1), 100 * (least / MINIMUM - 1)]
    text = f"{most:.3f}, {least:.3f} m: {errors[0]:+.2f}, {errors[1]:+.2f} %; energy {drift:+.1e}"
    return text, None if limit is None else max(map(abs, errors)) <= limit


def checkerboard(job, across, along, shape):
    """Root mean square of what the mean stress of an inner cell differs from the mean of its neighbours over faces, over that of the mean
    stress: 2 where the cells change sign like a board's fields, of the order of the cells' size squared where the stress is smooth."""
    run = job.case("bending-column", ("%smesh-parameters={n: %d, m: %d, shape: %d}" % (S, across, along, shape),))
    series = couplet.find_series(run.folder / "solid")
    last = len(series.times) - 1
    mean = sum(np.array(series.field(last, f"stress-{c}")) for c in ("xx", "yy", "zz")) / 3
    cells = [list(c) for c in series.cells]
    sides = TETRAHEDRON if len(cells[0]) == 4 else HEXAHEDRON
    of_face = {}
    for c, points in enumerate(cells):
        for side in sides:
            of_face.setdefault(frozenset(points[p] for p in side), []).append(c)
    beside = [[] for _ in cells]
    for pair in of_face.values():
        if len(pair) == 2:
            beside[pair[0]].append(pair[1])
            beside[pair[1]].append(pair[0])
    inner = [c for c, near in enumerate(beside) if len(near) == len(sides)]
    off = np.array([mean[c] - np.mean(mean[beside[c]]) for c in inner])
    ratio = math.sqrt(np.mean(off**2) / np.mean(mean[inner] ** 2))
    return f"{ratio:.3f} of {len(inner)} inner cells", ratio <= 0.5


TETRAHEDRON = ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))
HEXAHEDRON = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def vibration(job, scheme, limit):
    """50 periods of 1.83 s; the largest distance of the energy from that of the first step, in parts of it."""
    run = job.case("bending-column", (
        "%smesh-parameters={n: 2, m: 8, shape: 0}" % S, "simulation.end-time=91.5", "simulation.time-step=0.01", *scheme))
    energies = couplet.read_csv(run.folder / "solid" / "energies.csv")
    whole = [k + s for k, s in zip(energies["kinetic [J]"], energies["strain [J]"])]
    drift = max(abs(w / whole[0] - 1) for w in whole)
    return f"{drift:.1e} at most, {whole[-1] / whole[0] - 1:+.1e} at the end", None if limit is None else drift <= limit


# -- speed ------------------------------------------------------------------------------------------------------------
CONVERGED = 0.43134  # u1 / L at K = 1.6, Saint Venant-Kirchhoff


def race(job, across, along, times, most):
    found = job.beside("benchmarks/peers/race.py").bent_beam(job, across, along, 1.6, times)
    mine, u = found.pop("ours")
    words = [f"ours {mine:.2f} s ({100 * (u / CONVERGED - 1):+.2f} %)"]
    words += [f"{who} {s:.2f} s ({100 * (v / CONVERGED - 1):+.2f} %): {s / mine:.1f}x" for who, (s, v) in found.items()]
    if not found:
        return "; ".join(words) + "; CalculiX is not installed", None if most is None else False
    return "; ".join(words), None if most is None else min(s for s, _ in found.values()) / mine >= most


def best(job):
    """The cheapest of each one's meshes that errs by at most 0.1 %, each run three times in turns."""
    peers, limit = job.beside("benchmarks/peers/race.py"), 0.001
    meshes = {"ours": [(2, 20), (4, 40)], "C3D8I": [(2, 20), (4, 40), (4, 80), (8, 40), (8, 80)],
              "C3D20": [(2, 5), (2, 10), (2, 20), (4, 20), (4, 40)]}
    chosen, words = {}, []
    for who, of_whom in meshes.items():
        for mesh in of_whom:
            runs = [peers.our_beam(job, *mesh, 1.6)[:2] if who == "ours" else peers.calculix_bent(job, *mesh, 1.6, who) for _ in range(3)]
            if runs[0] is None:
                return "CalculiX is not installed", False
            seconds, error = sorted(r[0] for r in runs)[1], runs[0][1] / CONVERGED - 1
            if abs(error) <= limit and (who not in chosen or seconds < chosen[who][0]):
                chosen[who] = seconds, f"{who} {mesh[0]}x{mesh[0]}x{mesh[1]} {seconds:.2f} s ({100 * error:+.3f} %)"
    words = "; ".join(chosen[who][1] if who in chosen else f"{who}: no mesh of those tried" for who in meshes)
    return words, "ours" in chosen and all(chosen["ours"][0] <= s for s, _ in chosen.values())


def growth(job):
    """Processor seconds per cell and Newton iteration, large over small."""
    peers, each = job.beside("benchmarks/peers/race.py"), {}
    for across in (8, 16):
        runs = [peers.our_beam(job, across, 10 * across, 1.6) for _ in range(3 if across == 8 else 1)]
        seconds, _, newton = min(runs)
        each[across] = seconds / (10 * across**3) / sum(newton)
    return f"{1e6 * each[8]:.2f} and {1e6 * each[16]:.2f} us: {each[16] / each[8]:.2f} times", each[16] / each[8] < 2


THESIS = {(2, 1.6): 0.3922, (4, 1.6): 0.4206}  # table 3.6, meshes 1 and 2


def segregated(job):
    """The updated-Lagrangian method against table 3.6 of the thesis, in one load step (total Lagrangian) and in four, and Newton's time on the same mesh."""
    words, agrees, factor = [], True, 0
    for (n, K), wanted in THESIS.items():
        aitken = (f"{S}solution-method={{type: segregated, acceleration: aitken, max-iterations: 40000, relative-tolerance: 1e-6}}",)
        pull = K * 15.293e6 * (0.2**4 / 12) / (0.04 * 4) / math.sqrt(2)
        found = {}
        for name, sets in (("one", (*aitken, "simulation.time-step=1")), ("four", (*aitken, "simulation.time-step=0.25")),
                           ("newton", (f"{S}solution-method.relative-tolerance=1e-6", "simulation.time-step=1"))):
            run = job.case("bent-beam", (
                "%smesh-parameters={n: %d, m: %d, L: 2}" % (S, n, 10 * n), f"{S}material.law=saint-venant-kirchhoff",
                f"{S}boundaries.tip.value=[{pull!r}*t, {pull!r}*t, 0]", *sets))
            tip = couplet.read_csv(run.folder / "solid" / "probes.csv")
            solver = [float(line.split()[3]) for line in run.log.splitlines() if line.startswith("solid: linear solver")]
            found[name] = math.hypot(tip["tip x [m]"][-1], tip["tip y [m]"][-1]) / 2, solver[-1]
        agrees = agrees and all(abs(found[k][0] / wanted - 1) <= 1e-3 for k in ("one", "four"))
        factor = found["one"][1] / found["newton"][1]
        words.append(f"{n}x{n}x{10 * n}: {found['one'][0]:.5f} in one load step, {found['four'][0]:.5f} in four (thesis {wanted}), Newton "
                     f"{found['newton'][0]:.5f}; solve {found['one'][1]:.2f} s for Newton's {found['newton'][1]:.2f} s: {factor:.0f}x")
    return "; ".join(words), agrees and factor >= 20


def pairs(job):
    """The estimate of `output: {large-strain-estimate: true}` and what `kinematics: finite-strain` changes, 7 bodies."""
    tests, _ = job.gtest("verification_solid_large_strain_estimate")
    found = {t.rsplit("/", 1)[-1]: (float(v["told"]), float(v["found"])) for t, v in tests.items() if "told" in v}
    text = "; ".join(f"{name.replace('_', ' ')}: {100 * told:.1f} of {100 * true:.1f} %" for name, (told, true) in found.items())
    return text, len(found) >= 6 and all(1 / 1.5 <= told / true <= 1.5 for told, true in found.values())


def flap(job):
    """Tip at 0.4 s; the linear flap, then two schemes of coupling at large strain."""
    def tip(name, *sets):
        folder = job.coupled(job.root / "configs/perpendicular-flap/case.yaml", f"flap-20-{name}", [
            "participants.fluid.boundaries.inlet.velocity=[20 m/s, 0 m/s]", "participants.mover.form=incremental",
            "participants.mover.stiffening-volumes=current", "simulation.end-time=0.4 s", *sets])
        table = couplet.read_csv(folder / "solid" / "probes.csv")
        return table["tip x [m]"][-1], table["tip y [m]"][-1]
    large = "participants.solid.kinematics=finite-strain"
    linear, semi, implicit = tip("linear"), tip("semi-implicit", large), tip("implicit", large, "coupling.scheme=implicit")
    apart = max(abs(a - b) for a, b in zip(semi, implicit)) / abs(implicit[0])
    return (f"tip {linear[0]:.4f}, {linear[1]:+.4f} m linear; {semi[0]:.4f}, {semi[1]:+.4f} m finite strain, semi-implicit; "
            f"{implicit[0]:.4f}, {implicit[1]:+.4f} m implicit; linear {100 * (linear[0] / implicit[0] - 1):+.1f} % along the flow, "
            f"schemes {100 * apart:.2f} % apart"), apart <= 0.01
