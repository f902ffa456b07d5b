# SPDX-License-Identifier: Apache-2.0
"""The linear solid: motion, ranks, speed."""


# -- parallel ---------------------------------------------------------------------------------------------------------
def body(job, n, ranks=1, method="newton-krylov"):
    """A compression of the porous body."""
    return job.beside("configs/porous-body/study.py").run(job, n, ranks, method)


def force(job, sizes):
    runs = [body(job, n) for n in sizes]
    forces = [r["force"] for r in runs]
    steps = [abs(b - a) for a, b in zip(forces, forces[1:])]
    text = ", ".join(f"{r['force']:.2f} N ({r['cells']} cells)" for r in runs)
    return text, steps[-1] < steps[0] and steps[-1] / forces[-1] < 0.01


def iterations(job, method, n, ranks):
    runs = [body(job, n, r, method) for r in ranks]
    text = ", ".join(str(r["iterations"]) + (f" ({r['inner']} inner)" if r["inner"] else "") for r in runs)
    forces = [r["force"] for r in runs]
    return f"{text} on {', '.join(map(str, ranks))} ranks", max(forces) / min(forces) - 1 < 1e-4


def strong(job, n):
    one, two = (body(job, n, r)["seconds"] for r in (1, 2))
    return f"{one:.1f} s and {two:.1f} s, speed-up {one / two:.2f}", two < one


def weak(job, small, large):
    one, two = body(job, small, 1), body(job, large, 2)
    efficiency = one["seconds"] / one["cells"] * two["cells"] / 2 / two["seconds"]
    # The iterations depend more on the mesh than on the ranks: one may be lucky.
    an_iteration = efficiency * two["iterations"] / one["iterations"]
    return (
        (
            f"{one['cells']} cells {one['seconds']:.1f} s ({one['iterations']} iterations), {two['cells']} cells on 2"
            f" ranks {two['seconds']:.1f} s ({two['iterations']}): efficiency {100 * efficiency:.0f} %, of an iteration"
            f" {100 * an_iteration:.0f} %"
        ),
        min(efficiency, an_iteration) > 0.5,
    )


# -- speed ------------------------------------------------------------------------------------------------------------
FINE, FINEST = (32, 48, 24), (64, 96, 48)


def race(job):
    return job.beside("benchmarks/peers/race.py")


def cells_per_second(job, method, wanted):
    foam, mine = race(job).foam_plate(job, FINE, times=3), race(job).our_plate(job, FINE, method, times=3)
    rate = f"{mine['cells'] / mine['seconds']:.0f} cells/s"
    if foam is None:
        return f"{rate}; solidDisplacementFoam is not installed", False
    ratio = foam["seconds"] / mine["seconds"]
    return f"{ratio:.1f} times, {rate}", ratio >= wanted


def memory(job, method):
    r = race(job).our_plate(job, FINEST, method)
    kb = r["memory"] / r["cells"] / 1e3
    return f"{kb:.2f} kB", kb <= 2.0


def reproduced(found):
    """Checks {what: {name: (ratio, the published one or None)}}: each within a factor of 1.5 of the thesis."""
    text = "; ".join(
        f"{what}: "
        + ", ".join(
            f"{name} {ratio:.2f}" + (f" ({wanted})" if wanted else "") for name, (ratio, wanted) in ratios.items()
        )
        for what, ratios in found.items()
    )
    return text, all(
        wanted is None or 1 / 1.5 <= ratio / wanted <= 1.5
        for ratios in found.values()
        for ratio, wanted in ratios.values()
    )


def table_3_1_a(job):
    """Case A, meshes 2 to 4: processor seconds of the whole program, and iterations."""
    found, words = {}, []
    for refine, (s, sa) in {2: (1.9, 2.0), 4: (1.9, 2.4), 8: (1.5, 2.4)}.items():
        runs = {
            m: race(job).ours(
                job,
                "le11",
                [
                    "participants.solid.mesh-parameters={refine: %d}" % refine,
                    "participants.solid.solution-method={%s, relative-tolerance: 1e-7, max-iterations: 20000}"
                    % race(job).METHODS[m],
                ],
            )
            for m in ("S", "SA", "C", "newton-krylov")
        }
        t = {m: run.cpu for m, (run, _, _) in runs.items()}
        found[f"refine {refine}"] = {
            "S/SA": (t["S"] / t["SA"], s),
            "SA/C": (t["SA"] / t["C"], sa),
            "C/newton-krylov": (t["C"] / t["newton-krylov"], None),
        }
        words.append(", ".join(f"{m} {int(n[-1])}" for m, (_, _, n) in runs.items()))
    text, met = reproduced(found)
    return f"{text}; iterations {'; '.join(words)}", met


def table_3_1(job):
    """Case B, meshes 2 to 4 (the first is too short for the clock)."""
    found = {}
    for n, (s, sa) in {(8, 12, 6): (2.1, 5.7), (16, 24, 12): (3.8, 4.3), FINE: (4.3, 3.4)}.items():
        t = {m: race(job).our_plate(job, n, m, 1e-7)["solution"] for m in ("S", "SA", "C", "newton-krylov")}
        found["x".join(map(str, n))] = {
            "S/SA": (t["S"] / t["SA"], s),
            "SA/C": (t["SA"] / t["C"], sa),
            "C/newton-krylov": (t["C"] / t["newton-krylov"], None),
        }
    return reproduced(found)
