# SPDX-License-Identifier: Apache-2.0
"""Measures of the porous body (thesis 3.4): convergence, iterations by ranks, memory, scaling. The issue sets no numbers but
asks that they are measured; each line states what must hold."""


def study(job):
    return job.beside("configs/porous-body/study.py")


def force(job, sizes, method="newton-krylov"):
    runs = [study(job).run(job, n, method=method) for n in sizes]
    forces = [r["force"] for r in runs]
    steps = [abs(b - a) for a, b in zip(forces, forces[1:])]
    text = ", ".join(f"{r['force']:.2f} N ({r['cells']} cells)" for r in runs)
    return text, steps[-1] < steps[0] and steps[-1] / forces[-1] < 0.01


def iterations(job, method, n, ranks):
    runs = [study(job).run(job, n, r, method) for r in ranks]
    text = ", ".join(str(r["iterations"]) + (f" ({r['inner']} inner)" if r["inner"] else "") for r in runs)
    forces = [r["force"] for r in runs]
    return f"{text} on {', '.join(map(str, ranks))} ranks", max(forces) / min(forces) - 1 < 1e-4


def scaled(job, method, sizes, ranks):
    runs = [study(job).run(job, n, r, method) for n, r in zip(sizes, ranks)]
    return ", ".join(f"{r['iterations']} ({r['cells']} cells, {n} ranks)" for r, n in zip(runs, ranks)), True


def memory(job, n):
    one, two = (study(job).run(job, n, r) for r in (1, 2))
    return (f"{one['memory']:.0f} MB on 1 rank ({1e3 * one['memory'] / one['cells']:.1f} kB per cell), "
            f"{two['memory']:.0f} MB per rank on 2"), two["memory"] < one["memory"]


def strong(job, n):
    one, two = (study(job).run(job, n, r)["seconds"] for r in (1, 2))
    return f"{one:.1f} s and {two:.1f} s, speed-up {one / two:.2f}", two < one


def weak(job, small, large):
    one, two = study(job).run(job, small, 1), study(job).run(job, large, 2)
    efficiency = one["seconds"] / one["cells"] * two["cells"] / 2 / two["seconds"]
    # The iterations depend more on the mesh than on the ranks: one may be lucky.
    an_iteration = efficiency * two["iterations"] / one["iterations"]
    return (f"{one['cells']} cells {one['seconds']:.1f} s ({one['iterations']} iterations), {two['cells']} cells on 2 ranks "
            f"{two['seconds']:.1f} s ({two['iterations']}): efficiency {100 * efficiency:.0f} %, of an iteration "
            f"{100 * an_iteration:.0f} %"), min(efficiency, an_iteration) > 0.5
