# SPDX-License-Identifier: Apache-2.0
"""Loads, stability, rubber, and bodies of revolution by default settings."""
import csv
import json
import math
import re
import shutil

import couplet
from couplet.runs.process import RunFailed
from couplet.runs.results import Results
from couplet.runs.pool import WARNING


# -- scenes -----------------------------------------------------------------------------------------------------------
def probe(run, column):
    with open(run.folder / "solid" / "probes.csv", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    return float(rows[-1][rows[0].index(column)])


def warnings(run):
    return WARNING.findall(run.log)


# -- motion -----------------------------------------------------------------------------------------------------------
PERIOD, AMPLITUDE = 20.03, 0.09325  # of the continuum; of the p-FEM run in configs/vibrating-cantilever/reference, fitted alike


def vibration(job):
    run = job.case("vibrating-cantilever",
                        ("participants.solid.mesh-parameters={n_length: 20, n_side: 2, shape: 1}", "simulation.end-time=60"))
    got = job.beside("configs/vibrating-cantilever/vibration.py").numbers(run.folder / "solid")
    off = got["period"] / PERIOD - 1, got["amplitude"] / AMPLITUDE - 1
    said = warnings(run)
    return (f"period {got['period']:.2f} s ({100 * off[0]:+.2f} %), amplitude {got['amplitude']:.4f} m ({100 * off[1]:+.2f} %)"
            f"{', ' + said[0] if said else ', no warning'}"), max(map(abs, off)) <= 0.03 and not said


def strip(job):
    run = job.case("undamped-strip", ())
    with open(run.folder / "solid" / "energies.csv", encoding="utf-8") as file:
        rows = [[float(v) for v in row[1:3]] for row in list(csv.reader(file))[1:]]
    first, worst = sum(rows[0]), max(abs(sum(row) / sum(rows[0]) - 1) for row in rows)
    said = warnings(run)
    return f"within {worst:.1e} of {first:.0f} J{', ' + said[0] if said else ', no warning'}", worst <= 1e-6 and not said


# -- stability --------------------------------------------------------------------------------------------------------
LEE = 18.5


def snap(job):
    """The first limit load [kN] in run.json, and what else the run has to say."""
    run = job.case("lees-frame")
    findings = json.loads((run.folder / "solid" / "run.json").read_text())["findings"]
    found = next(f["number"] for f in findings if f["id"] == "limit-load")
    worse = [f["id"] for f in findings if f["severity"] != "note"]
    error = found / LEE - 1
    return f"{found:.4g} kN ({100 * error:+.2f} %), {', '.join(worse) or 'no warning'}", abs(error) <= 0.02 and not worse



# -- loads ------------------------------------------------------------------------------------------------------------
S = "participants.solid."
B = f"{S}boundaries."
PIN, WEIGHT = 20e3, -200.0
BEAM = ("participants.solid.mesh-parameters={n: 2, nl: 20, L: 10, shape: 1}", f"{S}probes.tip.point=[10, 0.5, 0.5]")


def last(run, name):
    return {key: values[-1] for key, values in couplet.read_csv(run.folder / "solid" / name).items()}


def eye_resultant(job, *sets):
    r = last(job.case("eye-bar", sets), "reactions.csv")
    load = math.hypot(r["load x [N]"] - PIN, r["load y [N]"] - WEIGHT, r["load z [N]"]) / PIN
    held = math.hypot(*(r[f"clamp {a} [N]"] + r[f"load {a} [N]"] for a in "xyz")) / PIN
    return f"load {load:.1e}, reaction {held:.1e}", load <= 1e-12 and held <= 1e-9


def dam(job):
    """Water against the side of an upright wall of 10 m, 3 cells of which a level of 7.3 m cuts: rho g h^2 / 2 on 1 m."""
    level, weight = 7.3, 1000 * 9.81
    run = job.case("slender-beam", (
        *BEAM, f"{B}tip={{type: free}}",
        "%ssides={type: free, parts: [{where: y < 1e-9, type: hydrostatic-pressure, density: 1000, gravity: [-9.81, 0, 0], level: %g}]}"
        % (B, level)))
    r, wanted = last(run, "reactions.csv"), weight * level**2 / 2
    error = math.hypot(r["load y [N]"] - wanted, r["load x [N]"], r["load z [N]"]) / wanted
    return f"{error:.1e}", error <= 1e-12


# -- rubber -----------------------------------------------------------------------------------------------------------
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


# -- revolved ---------------------------------------------------------------------------------------------------------
def bisect(wrong, low, high):
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if wrong(middle) < 0 else (low, middle)
    return low


def hot_inner_wall():
    """Of an incompressible ring in plane strain with stretches s(R): r^2 = c + 2 int s^3 R dR, and no traction at either wall:
    int (t_hoop - t_radial) / r dr = 0 with t_hoop - t_radial = 2 (c10 + c01 / s^2) (b_hoop - b_radial)."""
    n, c10, c01 = 2000, 0.8, 0.2

    def gap(inner):
        square, total = inner * inner, 0.0
        for i in range(n):
            R = 1 + (i + 0.5) / n
            s = 1 + 0.2 * math.log(2 / R) / math.log(2)
            at = square + s**3 * R / n  # r^2 in the middle
            square += 2 * s**3 * R / n
            hoop = at / (R * s) ** 2  # of the elastic part; the radial one follows from its volume
            radial = s * s / hoop
            total += 2 * (c10 + c01 / s**2) * (hoop - radial) * s**3 * R / at / n
        return total

    return bisect(gap, 0.9, 1.5) - 1


def sheet_inner_wall():
    """Of an incompressible sheet (neo-Hooke, mu = 1): dP/dR = (P_hoop - P) / R, P = a - a^-3 b^-2, no traction at the hole, outer
    radius 3."""
    n = 200

    def radial(P, b):
        return bisect(lambda a: a - a**-3 * b**-2 - P, 0.1, 10)

    def outer(inner):
        y = [inner, 0.0]

        def rate(R, at):
            b = at[0] / R
            a = radial(at[1], b)
            return (a, (b - b**-3 * a**-2 - at[1]) / R)

        h = 1 / n
        for i in range(n):
            R = 1 + i * h
            k = rate(R, y)
            k2 = rate(R + h / 2, [y[j] + h / 2 * k[j] for j in (0, 1)])
            y = [y[j] + h * k2[j] for j in (0, 1)]
        return y[0] - 3

    return bisect(outer, 1.0, 3.0) - 1


def run_of(job, file):
    name = file.replace("/", "-")
    return job.once(("file", file), lambda: job.case_run(job.root / "configs" / f"{file}.yaml", job.scratch / name, (), {"solid": 1}, 600))


def ring(job, case, right, within):
    """`right`: the function that gives it."""
    run = run_of(job, f"rubber-ring/{case}")
    error = probe(run, "inner wall x [m]") / globals()[right]() - 1
    said = warnings(run)
    return f"{100 * error:+.3f} %{', ' + said[0] if said else ', no warning'}", abs(error) <= within and not said
