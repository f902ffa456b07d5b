# SPDX-License-Identifier: Apache-2.0
"""Bars of the porous body (thesis 3.4): convergence, iterations by ranks, memory, scaling. The issue sets no numbers but
asks that they are measured; each line states what must hold."""
from validation.job import Bar

RANKS = (1, 2, 4, 8, 16)
SHORT, LONG = (15, 19, 23, 28), (36, 45, 56, 69)


def study(job):
    return job.beside("configs/porous-body/study.py")


def force(sizes, method="newton-krylov"):
    def measure(job):
        runs = [study(job).run(job, n, method=method) for n in sizes]
        forces = [r["force"] for r in runs]
        steps = [abs(b - a) for a, b in zip(forces, forces[1:])]
        text = ", ".join(f"{r['force']:.2f} N ({r['cells']} cells)" for r in runs)
        return text, steps[-1] < steps[0] and steps[-1] / forces[-1] < 0.01
    return measure


def iterations(method, n, ranks):
    def measure(job):
        runs = [study(job).run(job, n, r, method) for r in ranks]
        text = ", ".join(str(r["iterations"]) + (f" ({r['inner']} inner)" if r["inner"] else "") for r in runs)
        forces = [r["force"] for r in runs]
        return f"{text} on {', '.join(map(str, ranks))} ranks", max(forces) / min(forces) - 1 < 1e-4
    return measure


def scaled(method, sizes, ranks):
    def measure(job):
        runs = [study(job).run(job, n, r, method) for n, r in zip(sizes, ranks)]
        return ", ".join(f"{r['iterations']} ({r['cells']} cells, {n} ranks)" for r, n in zip(runs, ranks)), True
    return measure


def memory(n):
    def measure(job):
        one, two = (study(job).run(job, n, r) for r in (1, 2))
        return (f"{one['memory']:.0f} MB on 1 rank ({1e3 * one['memory'] / one['cells']:.1f} kB per cell), "
                f"{two['memory']:.0f} MB per rank on 2"), two["memory"] < one["memory"]
    return measure


def strong(n):
    def measure(job):
        one, two = (study(job).run(job, n, r)["seconds"] for r in (1, 2))
        return f"{one:.1f} s and {two:.1f} s, speed-up {one / two:.2f}", two < one
    return measure


def weak(small, large):
    def measure(job):
        one, two = study(job).run(job, small, 1), study(job).run(job, large, 2)
        efficiency = one["seconds"] / one["cells"] * two["cells"] / 2 / two["seconds"]
        # The iterations depend more on the mesh than on the ranks: one may be lucky.
        an_iteration = efficiency * two["iterations"] / one["iterations"]
        return (f"{one['cells']} cells {one['seconds']:.1f} s ({one['iterations']} iterations), {two['cells']} cells on 2 ranks "
                f"{two['seconds']:.1f} s ({two['iterations']}): efficiency {100 * efficiency:.0f} %, of an iteration "
                f"{100 * an_iteration:.0f} %"), min(efficiency, an_iteration) > 0.5
    return measure


SAME = "force the same on all to 1e-4; the iterations are only shown"
BARS = [
    Bar("porous body: force over four meshes up to 100 000 cells", "converging, last change below 1 %", force(SHORT)),
    Bar("porous body: force over four meshes, corrected gradient", "converging, last change below 1 %", force(SHORT, "newton-krylov, corrected")),
    Bar("porous body: force over four meshes up to 1.3 million cells", "converging, last change below 1 %", force(LONG), long=True),
    Bar("porous body: iterations, newton-krylov, 96 000 cells", SAME, iterations("newton-krylov", 28, RANKS)),
    Bar("porous body: outer iterations, segregated (thesis: 111, 89, 82, 117, 86)", SAME, iterations("segregated", 28, RANKS), long=True),
    Bar("porous body: iterations, block-coupled (thesis: 854, 868, 871 on 16, 32, 64)", SAME,
        iterations("block-coupled", 28, RANKS), long=True),
    Bar("porous body: iterations at a fixed number of cells per rank, newton-krylov (table 3.10 of [thesis])", "reported",
        scaled("newton-krylov", (18, 22, 28, 35), (2, 4, 8, 16))),
    Bar("porous body: the same, segregated (thesis: 108, 112, 117, 96)", "reported", scaled("segregated", (18, 22, 28, 35), (2, 4, 8, 16)), long=True),
    Bar("porous body: the same, block-coupled (thesis: 850, 1046, 1226, 1558)", "reported",
        scaled("block-coupled", (18, 22, 28, 35), (2, 4, 8, 16)), long=True),
    Bar("porous body: memory, 1.3 million cells", "less on each of 2 ranks than on 1", memory(69), long=True),
    Bar("porous body: strong scaling, 96 000 cells on 1 and 2 ranks", "2 ranks faster", strong(28)),
    Bar("porous body: strong scaling, 1.3 million cells", "2 ranks faster", strong(69), long=True),
    Bar("porous body: weak scaling, 46 000 cells per rank", "efficiency above 50 %", weak(22, 28)),
    Bar("porous body: weak scaling, 650 000 cells per rank", "efficiency above 50 %", weak(55, 69), long=True),
]
