# SPDX-License-Identifier: Apache-2.0
"""The solid at large strain: bending, motion, speed."""
import math

import numpy as np

# -- bending ----------------------------------------------------------------------------------------------------------
# u1 / L of converged three-dimensional finite elements (L = 10 sides).
SVK = {0.2: 0.06639, 0.4: 0.13108, 0.8: 0.24992, 1.6: 0.43134}
NEO = 0.720308  # K = 5
CURVE = {"saint-venant-kirchhoff": {1: 0.302484, 2: 0.496223, 5: 0.721578, 10: 0.824823}, "neo-hookean": {1: 0.302244, 2: 0.495443, 5: NEO, 10: 0.823304}}
EDGE = {"quarter": (0.1, 0.1, 0.5), "middle": (0.1, 0.1, 1.0)}  # places on an edge of the section


def beam(job, across, along, law, load, length=2.0, steps=1, more=()):
    """Results of case E, and its deflection over the length."""
    pull = load * 15.293e6 * (0.2**4 / 12) / (0.04 * length**2) / math.sqrt(2)
    edge = ", ".join("%s: {point: [%g, %g, %g], fields: [stress]}" % (name, *x) for name, x in EDGE.items())
    run = job.case("bent-beam", (".mesh-parameters={n: %d, m: %d, L: %g}" % (across, along, length), f".material.law={law}",
                                 f".boundaries.tip.value=[{pull!r}*t, {pull!r}*t, 0]", f".probes={{tip: {{point: [0, 0, {length}]}}, {edge}}}",
                                 f"simulation.time-step={1 / steps!r}", *more))
    tip = run.last("solid", "probes.csv")
    return run, math.hypot(tip["tip x [m]"], tip["tip y [m]"]) / length


def kirchhoff(job, across):
    errors = {K: 100 * (beam(job, across, 10 * across, "saint-venant-kirchhoff", K)[1] / u - 1) for K, u in SVK.items()}
    return ", ".join(f"K {K}: {e:+.3f} %" for K, e in errors.items()), all(abs(e) <= 0.3 for e in errors.values())


def hook(job, across, sides, wanted):
    run, u = beam(job, across, sides * across, "neo-hookean", 10, 0.2 * sides)
    error, steps = 100 * (u / wanted - 1), len(run.table("solid", "solver.csv")["iterations"])
    return f"{u:.5f}, {error:+.3f} %, {steps} load steps that were accepted", abs(error) <= 0.3


def curve(job, across):
    """Figure 3.11, left: ten load steps to K 10 with each law."""
    words, worst = [], 0
    for law, wanted in CURVE.items():
        probes = beam(job, across, 10 * across, law, 10, steps=10)[0].probes("solid")
        u = np.hypot(probes["tip x [m]"], probes["tip y [m]"]) / 2
        errors = {K: 100 * (float(np.interp(K / 10, probes["time [s]"], u)) / one - 1) for K, one in wanted.items()}
        worst = max(worst, *map(abs, errors.values()))
        words.append(f"{law} " + ", ".join(f"K {K}: {wanted[K] * (1 + e / 100):.4f} ({e:+.3f} %)" for K, e in errors.items()))
    return "; ".join(words), worst <= 0.3


def slender(job, across):
    """Table 3.7, and of figures 3.12 and 3.13 the growth of the axis and the largest shear."""
    words, close, maps = [], True, job.beside("configs/bent-beam/maps.py")
    for sides, wanted in {10: 0.82253, 20: 0.81280, 40: 0.81050}.items():
        run, u = beam(job, across, sides * across, "neo-hookean", 10, 0.2 * sides, more=(".output={strain: true}",))
        words.append(f"L {sides}: {u:.5f} ({100 * (u / wanted - 1):+.2f} %, elastica {100 * (u / 0.81061 - 1):+.2f} %), {maps.text(maps.Section(run.folder, across))}")
        close = close and abs(u / wanted - 1) <= 0.002
    return "; ".join(words), close


def slopes(job):
    """Returns the orders of convergence from the differences between three meshes, each halved."""
    runs = [beam(job, n, 10 * n, "neo-hookean", 5) for n in (2, 4, 8)]
    u = [value for _, value in runs]
    of_u = math.log2((u[1] - u[0]) / (u[2] - u[1])) if (u[1] - u[0]) * (u[2] - u[1]) > 0 else 0
    of_stress = []
    for name in EDGE:  # Frobenius norms of differences of symmetric tensors
        a, b, c = (np.array([math.sqrt(1 if k[0] == k[1] else 2) * run.last("solid", "probes.csv")[f"{name} stress-{k} [Pa]"] for k in ("xx", "yy", "zz", "xy", "yz", "xz")])
                   for run, _ in runs)
        of_stress.append(math.log2(np.linalg.norm(b - a) / np.linalg.norm(c - b)))
    off = ", ".join(f"{100 * (v / NEO - 1):+.3f} %" for v in u)
    return (f"u {of_u:.2f}; stress {', '.join(f'{o:.2f}' for o in of_stress)}; u off by {off} of {NEO}", of_u >= 1.7 and min(of_stress) >= 0.9)


def newton_steps(job):
    worst, hooked = (max(beam(job, n, 10 * n, law, K, steps=steps)[0].table("solid", "solver.csv")["iterations"].max() for n in (4, 8))
                     for law, K, steps in (("saint-venant-kirchhoff", 1.6, 1), ("neo-hookean", 10, 8)))
    return f"at most {worst:.0f} (Saint Venant-Kirchhoff, one step to K 1.6), {hooked:.0f} (neo-Hookean, eight to K 10)", max(worst, hooked) <= 10


# -- motion -----------------------------------------------------------------------------------------------------------
MAXIMUM, MINIMUM = 2.873, -3.179  # u_x(A) [m], cubic spectral elements, refined


def column(job, across, along, shape, sets=()):
    """Results of case F, and its energy [J]."""
    run = job.case("bending-column", (".mesh-parameters={n: %d, m: %d, shape: %d}" % (across, along, shape), *sets))
    energies = run.table("solid", "energies.csv")
    return run, energies["kinetic [J]"] + energies["strain [J]"]


def swing(job, across, along, limit, shape=0):
    run, whole = column(job, across, along, shape)
    x = run.probes("solid")["A x [m]"]
    errors = [100 * (x.max() / MAXIMUM - 1), 100 * (x.min() / MINIMUM - 1)]
    text = f"{x.max():.3f}, {x.min():.3f} m: {errors[0]:+.2f}, {errors[1]:+.2f} %; energy {whole[-1] / whole[0] - 1:+.1e}"
    return text, max(map(abs, errors)) <= limit


def checkerboard(job, across, along, shape):
    """Root mean square of what the mean stress of an inner cell differs from the mean of its neighbours over faces, over that of the mean
    stress: 2 where the cells change sign like a board's fields, of the order of the cells' size squared where the stress is smooth."""
    from couplet.peers.elements import FACES
    series = column(job, across, along, shape)[0].fields("solid")
    last, cells = len(series.times) - 1, [list(c) for c in series.cells]
    mean = sum(np.array(series.field(last, f"stress-{c}")) for c in ("xx", "yy", "zz")) / 3
    sides, of_face, beside = FACES["tetrahedron" if len(cells[0]) == 4 else "hexahedron"], {}, [[] for _ in cells]
    for c, points in enumerate(cells):
        for side in sides:
            of_face.setdefault(frozenset(points[p] for p in side), []).append(c)
    for a, b in (pair for pair in of_face.values() if len(pair) == 2):
        beside[a].append(b)
        beside[b].append(a)
    inner = [c for c, near in enumerate(beside) if len(near) == len(sides)]
    off = np.array([mean[c] - np.mean(mean[beside[c]]) for c in inner])
    ratio = math.sqrt(np.mean(off**2) / np.mean(mean[inner] ** 2))
    return f"{ratio:.3f} of {len(inner)} inner cells", ratio <= 0.5


def vibration(job, scheme, limit):
    """50 periods of 1.83 s; the largest distance of the energy from that of the first step, in parts of it."""
    _, whole = column(job, 2, 8, 0, ("simulation.end-time=91.5", "simulation.time-step=0.01", *scheme))
    drift = np.abs(whole / whole[0] - 1).max()
    return f"{drift:.1e} at most, {whole[-1] / whole[0] - 1:+.1e} at the end", None if limit is None else drift <= limit


# -- speed ------------------------------------------------------------------------------------------------------------
def peers(job):
    return job.beside("benchmarks/peers/race.py")


def race(job, across, along, times, most):
    found = peers(job).bent_beam(job, across, along, 1.6, times)
    mine, u = found.pop("ours")
    words = [f"ours {mine:.2f} s ({100 * (u / SVK[1.6] - 1):+.2f} %)"]
    words += [f"{who} {s:.2f} s ({100 * (v / SVK[1.6] - 1):+.2f} %): {s / mine:.1f}x" for who, (s, v) in found.items()]
    return "; ".join(words) + ("" if found else "; CalculiX is not installed"), bool(found) and min(s for s, _ in found.values()) / mine >= most


def best(job):
    """The cheapest of each one's meshes that errs by at most 0.1 %, each run three times in turns."""
    meshes = {"ours": [(2, 20), (4, 40)], "C3D8I": [(2, 20), (4, 40), (4, 80), (8, 40), (8, 80)], "C3D20": [(2, 5), (2, 10), (2, 20), (4, 20), (4, 40)]}
    chosen = {}
    for who, mesh in ((who, mesh) for who, some in meshes.items() for mesh in some):
        runs = [peers(job).our_beam(job, *mesh, 1.6)[:2] if who == "ours" else peers(job).calculix_bent(job, *mesh, 1.6, who) for _ in range(3)]
        if runs[0] is None:
            return "CalculiX is not installed", False
        seconds, error = sorted(r[0] for r in runs)[1], runs[0][1] / SVK[1.6] - 1
        if abs(error) <= 0.001 and (who not in chosen or seconds < chosen[who][0]):
            chosen[who] = seconds, f"{who} {mesh[0]}x{mesh[0]}x{mesh[1]} {seconds:.2f} s ({100 * error:+.3f} %)"
    words = "; ".join(chosen[who][1] if who in chosen else f"{who}: no mesh of those tried" for who in meshes)
    return words, "ours" in chosen and all(chosen["ours"][0] <= s for s, _ in chosen.values())


def growth(job):
    """Processor seconds per cell and Newton iteration, large over small."""
    each = {}
    for across in (8, 16):
        seconds, _, newton = min(peers(job).our_beam(job, across, 10 * across, 1.6) for _ in range(3 if across == 8 else 1))
        each[across] = seconds / (10 * across**3) / sum(newton)
    return f"{1e6 * each[8]:.2f} and {1e6 * each[16]:.2f} us: {each[16] / each[8]:.2f} times", each[16] / each[8] < 2


def segregated(job):
    """Compares the segregated method in one load step (total Lagrangian) and in four (updated Lagrangian) with [thesis, table 3.6], and its time with that of
    Newton's method on the same meshes."""
    words, agrees, factor = [], True, 0
    aitken = (".solution-method={type: segregated, acceleration: aitken, max-iterations: 40000, relative-tolerance: 1e-6}",)
    for n, wanted in ((2, 0.3922), (4, 0.4206)):
        found = {}
        for name, steps, sets in (("one", 1, aitken), ("four", 4, aitken), ("newton", 1, (".solution-method.relative-tolerance=1e-6",))):
            run, u = beam(job, n, 10 * n, "saint-venant-kirchhoff", 1.6, steps=steps, more=sets)
            found[name] = u, run.report("solid")["phases"]["solid: linear solver"]
        agrees = agrees and all(abs(found[k][0] / wanted - 1) <= 1e-3 for k in ("one", "four"))
        factor = found["one"][1] / found["newton"][1]
        words.append(f"{n}x{n}x{10 * n}: {found['one'][0]:.5f} in one load step, {found['four'][0]:.5f} in four (thesis {wanted}), Newton "
                     f"{found['newton'][0]:.5f}; solve {found['one'][1]:.2f} s for Newton's {found['newton'][1]:.2f} s: {factor:.0f}x")
    return "; ".join(words), agrees and factor >= 20


def pairs(job):
    """The estimate of a linear static run and what `kinematics: finite-strain` changes, 7 bodies."""
    tests, _ = job.gtest("verification_solid_large_strain_estimate")
    found = {t.rsplit("/", 1)[-1]: (float(v["told"]), float(v["found"])) for t, v in tests.items() if "told" in v}
    text = "; ".join(f"{name.replace('_', ' ')}: {100 * told:.1f} of {100 * true:.1f} %" for name, (told, true) in found.items())
    return text, len(found) >= 6 and all(1 / 1.5 <= told / true <= 1.5 for told, true in found.values())


def flap(job, keys, large, implicit):
    """Tip at the end of the linear flap, then of two schemes of coupling at large strain."""
    found = {}
    for name, own in {"linear": (), "semi-implicit": (large,), "implicit": (large, implicit)}.items():
        tip = job.case("perpendicular-flap", (*keys, *own)).last("solid", "probes.csv")
        found[name] = tip["tip x [m]"], tip["tip y [m]"]
    (along, _), most = found["linear"], found["implicit"][0]
    apart = max(abs(a - b) for a, b in zip(found["semi-implicit"], found["implicit"])) / abs(most)
    return (f"tip {'; '.join(f'{x:.4f}, {y:+.4f} m {name}' for name, (x, y) in found.items())}; linear {100 * (along / most - 1):+.1f} % along the flow, "
            f"schemes {100 * apart:.2f} % apart"), apart <= 0.01
