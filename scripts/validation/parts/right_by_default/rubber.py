# SPDX-License-Identifier: Apache-2.0
"""A bonded rubber block compressed to half its height, by default settings: how far each mesh follows it, and why it ends there."""
import re
import shutil

import couplet
from couplet.runs.process import RunFailed
from couplet.runs.results import Results

S = "participants.solid."
HALF, NUMBER = 0.5, r"([-+.\de]+)"
FOLD = "the free surface has folded beyond the plane of the support"


def compressed(n, depth, share):
    """Keys of a block of n cells along each half that ends at this share of its height."""
    z = ", 0" if depth else ""
    sets = ["simulation.time-step=0.05", f"{S}mesh-parameters={{n: {n}, depth: {depth:g}}}", f"{S}boundaries.top.value=[0, -{share / 2}*t{z}]"]
    return sets + ([f"{S}dimension=3", f"{S}boundaries.back={{type: symmetry}}", f"{S}boundaries.front={{type: free}}", f"{S}probes.side.point=[0.5, 0, 0]"] if depth else [])


def followed(job, n, depth=0.0, timeout=3600):
    """(share of the height by which it is compressed at the end, last words or None)"""
    def make():
        out, said = job.scratch / f"block-{n}-{depth:g}", None
        try:
            job.case_run(job.root / "configs/rubber-block/case.yaml", out, compressed(n, depth, HALF), {"solid": 1}, timeout)
        except RunFailed:
            said = re.findall(r"error: (.*)", (out / "run.log").read_text())[-1]
        return HALF * couplet.read_csv(out / "solid" / "steps.csv")["time [s]"][-1], said, Results(out)
    return job.once(("block", n, depth), make)


def cause(said):
    if said is None:
        return "no message"
    cell = re.search(rf"worst cell is at \({NUMBER}, {NUMBER}, {NUMBER}\)", said)
    return f"worst cell ({', '.join(cell.groups())}) m, {'names the fold and the cure' if FOLD in said and 'End the load here' in said else 'does not name the fold'}"


def half(job, n, depth=0.0):
    share, said, _ = followed(job, n, depth)
    return f"{100 * share:.1f} %; {cause(said)}", share >= HALF - 1e-9


def force(run, share):
    """Of the platen [N], interpolated between the equilibria."""
    table = couplet.read_csv(run.folder / "solid" / "reactions.csv")
    times, forces = list(table["time [s]"]), list(table["top y [N]"])
    i = next(i for i, t in enumerate(times) if t >= share / HALF - 1e-9)
    if times[i] == share / HALF or i == 0:
        return forces[i]
    w = (share / HALF - times[i - 1]) / (times[i] - times[i - 1])
    return (1 - w) * forces[i - 1] + w * forces[i]


def reaction(job):
    """At 10 and 20 %, where 8, 16 and 32 across still stand."""
    words, converges = [], True
    for share in (0.1, 0.2):
        f = [-force(followed(job, n)[2], share) / 1e3 for n in (8, 16, 32)]
        gaps = abs(f[1] / f[0] - 1), abs(f[2] / f[1] - 1)
        converges = converges and gaps[1] < gaps[0]
        words.append(f"{100 * share:g} %: {', '.join(f'{x:.2f}' for x in f)} kN per m, {100 * gaps[0]:.2f} and {100 * gaps[1]:.2f} % apart")
    return "; ".join(words), converges


def by_arc_length(job):
    """8 across along the path of equilibria through its limit points."""
    out = job.scratch / "block-arc"
    job.case_run(job.root / "configs/rubber-block/case.yaml", out,
                 ("simulation.time-step=0.05", f"{S}mesh-parameters={{n: 8}}", f"{S}boundaries.top.value=[0, -0.25]",
                  f"{S}load-stepping={{type: arc-length, first-load-factor: 0.05}}", "simulation.accept=[unstable-equilibrium]"), {"solid": 1}, 3600)
    factors = couplet.read_csv(out / "solid" / "path.csv")["load factor [1]"]
    turns = [i for i in range(1, len(factors) - 1) if (factors[i] - factors[i - 1]) * (factors[i + 1] - factors[i]) < 0 and max(factors[:i + 1]) <= 1]
    return f"{100 * HALF * min(1, max(factors)):.1f} %, through {len(turns)} limit points", max(factors) >= 1


def beside_elements(job):
    """64 across, and dolfinx with quadratic displacement and linear pressure on the same mesh."""
    share, said, _ = followed(job, 64)
    got = f"{100 * share:.1f} %; {cause(said)}"
    python = shutil.which("python3", path="/usr/bin")
    if not python or job.run([python, "-c", "import dolfinx"]).returncode:
        return f"{got}; dolfinx is not installed", False
    found = job.run([python, job.root / "benchmarks/peers/dolfinx_block.py", "64"], timeout=3600).stdout
    theirs = float(re.search(rf"^64 {NUMBER}", found, re.M)[1])
    return f"{got}; dolfinx 0.5.2 {100 * theirs:.1f} %", share >= theirs and FOLD in (said or "")
