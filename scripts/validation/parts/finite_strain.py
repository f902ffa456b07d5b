# SPDX-License-Identifier: Apache-2.0
"""The solid at large strain: bending, motion, speed."""
import math

# -- bending ----------------------------------------------------------------------------------------------------------
# u1 / L of converged three-dimensional finite elements (L = 10 sides).
SVK = {0.2: 0.06639, 0.4: 0.13108, 0.8: 0.24992, 1.6: 0.43134}
EDGE = {"quarter": (0.1, 0.1, 0.5), "middle": (0.1, 0.1, 1.0)}  # places on an edge of the section


def beam(job, across, along, law, load, length=2.0, steps=1, more=()):
    """Results of case E, and its deflection over the length."""
    pull = load * 15.293e6 * (0.2**4 / 12) / (0.04 * length**2) / math.sqrt(2)
    edge = ", ".join("%s: {point: [%g, %g, %g], fields: [stress]}" % (name, *x) for name, x in EDGE.items())
    run = job.case(
        "bent-beam",
        (
            ".mesh-parameters={n: %d, m: %d, L: %g}" % (across, along, length),
            f".material.law={law}",
            f".boundaries.tip.value=[{pull!r}*t, {pull!r}*t, 0]",
            f".probes={{tip: {{point: [0, 0, {length}]}}, {edge}}}",
            f"simulation.time-step={1 / steps!r}",
            *more,
        ),
    )
    tip = run.last("solid", "probes.csv")
    return run, math.hypot(tip["tip x [m]"], tip["tip y [m]"]) / length


def kirchhoff(job, across):
    errors = {K: 100 * (beam(job, across, 10 * across, "saint-venant-kirchhoff", K)[1] / u - 1) for K, u in SVK.items()}
    return ", ".join(f"K {K}: {e:+.3f} %" for K, e in errors.items()), all(abs(e) <= 0.3 for e in errors.values())


def slender(job, across):
    """Table 3.7, and of figures 3.12 and 3.13 the growth of the axis and the largest shear."""
    words, close, maps = [], True, job.beside("configs/bent-beam/maps.py")
    for sides, wanted in {10: 0.82253, 20: 0.81280, 40: 0.81050}.items():
        run, u = beam(job, across, sides * across, "neo-hookean", 10, 0.2 * sides, more=(".output={strain: true}",))
        words.append(
            f"L {sides}: {u:.5f} ({100 * (u / wanted - 1):+.2f} %, elastica {100 * (u / 0.81061 - 1):+.2f} %),"
            f" {maps.text(maps.Section(run.folder, across))}"
        )
        close = close and abs(u / wanted - 1) <= 0.002
    return "; ".join(words), close


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
    text = (
        f"{x.max():.3f}, {x.min():.3f} m: {errors[0]:+.2f}, {errors[1]:+.2f} %; energy {whole[-1] / whole[0] - 1:+.1e}"
    )
    return text, max(map(abs, errors)) <= limit


# -- speed ------------------------------------------------------------------------------------------------------------
def peers(job):
    return job.beside("benchmarks/peers/race.py")


def race(job, across, along, times, most):
    found = peers(job).bent_beam(job, across, along, 1.6, times)
    mine, u = found.pop("ours")
    words = [f"ours {mine:.2f} s ({100 * (u / SVK[1.6] - 1):+.2f} %)"]
    words += [f"{who} {s:.2f} s ({100 * (v / SVK[1.6] - 1):+.2f} %): {s / mine:.1f}x" for who, (s, v) in found.items()]
    return (
        "; ".join(words) + ("" if found else "; CalculiX is not installed"),
        bool(found) and min(s for s, _ in found.values()) / mine >= most,
    )


def best(job):
    """The cheapest of each one's meshes that errs by at most 0.1 %, each run three times in turns."""
    meshes = {
        "ours": [(2, 20), (4, 40)],
        "C3D8I": [(2, 20), (4, 40), (4, 80), (8, 40), (8, 80)],
        "C3D20": [(2, 5), (2, 10), (2, 20), (4, 20), (4, 40)],
    }
    chosen = {}
    for who, mesh in ((who, mesh) for who, some in meshes.items() for mesh in some):
        runs = [
            (
                peers(job).our_beam(job, *mesh, 1.6)[:2]
                if who == "ours"
                else peers(job).calculix_bent(job, *mesh, 1.6, who)
            )
            for _ in range(3)
        ]
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
        seconds, _, newton = min(
            peers(job).our_beam(job, across, 10 * across, 1.6) for _ in range(3 if across == 8 else 1)
        )
        each[across] = seconds / (10 * across**3) / sum(newton)
    return f"{1e6 * each[8]:.2f} and {1e6 * each[16]:.2f} us: {each[16] / each[8]:.2f} times", each[16] / each[8] < 2


def segregated(job):
    """Compares the segregated method in one load step (total Lagrangian) and in four (updated Lagrangian) with [thesis,
    table 3.6], and its time with that of Newton's method on the same meshes."""
    words, agrees, factor = [], True, 0
    aitken = (
        ".solution-method={type: segregated, acceleration: aitken, max-iterations: 40000, relative-tolerance: 1e-6}",
    )
    for n, wanted in ((2, 0.3922), (4, 0.4206)):
        found = {}
        for name, steps, sets in (
            ("one", 1, aitken),
            ("four", 4, aitken),
            ("newton", 1, (".solution-method.relative-tolerance=1e-6",)),
        ):
            run, u = beam(job, n, 10 * n, "saint-venant-kirchhoff", 1.6, steps=steps, more=sets)
            found[name] = u, run.report("solid")["phases"]["solid: linear solver"]
        agrees = agrees and all(abs(found[k][0] / wanted - 1) <= 1e-3 for k in ("one", "four"))
        factor = found["one"][1] / found["newton"][1]
        words.append(
            f"{n}x{n}x{10 * n}: {found['one'][0]:.5f} in one load step, {found['four'][0]:.5f} in four (thesis"
            f" {wanted}), Newton {found['newton'][0]:.5f}; solve {found['one'][1]:.2f} s for Newton's"
            f" {found['newton'][1]:.2f} s: {factor:.0f}x"
        )
    return "; ".join(words), agrees and factor >= 20


def pairs(job):
    """The estimate of a linear static run and what `kinematics: finite-strain` changes, 7 bodies."""
    tests, _ = job.gtest("verification_solid_large_strain_estimate")
    found = {t.rsplit("/", 1)[-1]: (float(v["told"]), float(v["found"])) for t, v in tests.items() if "told" in v}
    text = "; ".join(
        f"{name.replace('_', ' ')}: {100 * told:.1f} of {100 * true:.1f} %" for name, (told, true) in found.items()
    )
    return text, len(found) >= 6 and all(1 / 1.5 <= told / true <= 1.5 for told, true in found.values())


def flap(job, keys, large, implicit):
    """Tip at the end of the linear flap, then of two schemes of coupling at large strain."""
    found = {}
    for name, own in {"linear": (), "semi-implicit": (large,), "implicit": (large, implicit)}.items():
        tip = job.case("perpendicular-flap", (*keys, *own)).last("solid", "probes.csv")
        found[name] = tip["tip x [m]"], tip["tip y [m]"]
    (along, _), most = found["linear"], found["implicit"][0]
    apart = max(abs(a - b) for a, b in zip(found["semi-implicit"], found["implicit"])) / abs(most)
    return (
        (
            f"tip {'; '.join(f'{x:.4f}, {y:+.4f} m {name}' for name, (x, y) in found.items())}; linear"
            f" {100 * (along / most - 1):+.1f} % along the flow, schemes {100 * apart:.2f} % apart"
        ),
        apart <= 0.01,
    )
