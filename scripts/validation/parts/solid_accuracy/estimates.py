# SPDX-License-Identifier: Apache-2.0
"""Estimated errors, and time to equal error beside quadratic tetrahedra of CalculiX."""
import csv
import json
import math
import re
import shutil

import couplet
from couplet.peers import calculix
from couplet.peers.solid import Solid
from couplet.runs import Case
from couplet.runs.process import launch
from validation.parts.solid_accuracy.scenes import probe


# -- elements ---------------------------------------------------------------------------------------------------------
S = "participants.solid."
TIP, FORK = -2.4535e-4, "tuning-fork"
TURNS, MODES, LONG = 3, 8, 10  # [s] of a run that is measured once
# Each from the coarsest.
BRACKET = {"ours": (0.01, 0.008, 0.006, 0.005, 0.0036, 0.0028, 0.0022), "C3D10": (0.02, 0.015, 0.012, 0.01)}
PRONGS = {"ours": (0.0025, 0.00175, 0.00125, 0.001), "C3D10": (0.005, 0.004, 0.0035, 0.003, 0.0025, 0.002)}
FINEST = 0.00125


def solid(job, case, h):
    """The case as CalculiX is given it; motion is no obstacle to modes."""
    data = Case(job.root / "configs" / case / "case.yaml").data
    section = data["participants"]["solid"]
    data = {**data, "participants": {"solid": {**section, "analysis": "static", "mesh-parameters": {"h": h}}}}
    return Solid(data, "solid", job.root / "configs" / case, job.scratch / "meshes", "CalculiX")


def written(job, case, h, step=None):
    """Folder with the input of the case, and the input; `step`: other lines in place of the static step."""
    def make():
        what, folder = calculix.Input(solid(job, case, h), "C3D10"), job.scratch / f"ccx-{case}-{h}"
        what.write(folder)
        if step:
            text = (folder / "case.inp").read_text()
            (folder / "case.inp").write_text(text[:text.index("*STEP")] + step)
        return folder, what
    return job.once(("ccx", case, h, step), make)


def median_of(run):
    """The median by processor seconds of TURNS runs, of one run where that is long; `run`: () -> (seconds, ...)"""
    runs = [run()]
    if runs[0][0] <= LONG:
        runs += [run() for _ in range(TURNS - 1)]
    return sorted(runs)[len(runs) // 2]


def calculix_seconds(folder):
    return median_of(lambda: (launch(["ccx", "case"], folder / "log", folder).cpu,))[0]


def our_run(job, case, h):
    return job.case_run(job.root / "configs" / case / "case.yaml", job.scratch / "ours", (f"{S}mesh-parameters={{h: {h}}}",), {"solid": 1}, 3600)


def our_seconds(job, case, h):
    """(whole process, of it before the first step and after the last: start-up, reading, writing)"""
    def once():
        run = our_run(job, case, h)
        steps = sum(float(x) for x in re.findall(r"^(?:begin_step|solve|accept_step)\s+([\d.]+)", run.log, re.M))
        return run.cost.cpu, run.cost.cpu * max(0, 1 - steps / run.cost.wall)
    return median_of(once)


def cheapest(meshes, error, limit):
    """(h, error) of the coarsest mesh that is within the limit as the next finer one is, if one is left."""
    found = None
    for h in meshes:
        e = error(h)
        if abs(e) > limit:
            found = None
        elif found:
            break
        else:
            found = h, e
    if found is None:
        raise LookupError(f"h = {h:g}, the finest of those tried, is {100 * abs(e):.2f} % off, limit {100 * limit:.2f} %")
    return found


def our_tip(job, h):
    return probe(our_run(job, "filleted-bracket", h), "tip y [m]") / TIP - 1


def their_tip(job, h):
    folder, what = written(job, "filleted-bracket", h)
    launch(["ccx", "case"], folder / "log", folder)
    what.read(folder, folder / "out" / "solid")
    return couplet.read_csv(folder / "out" / "solid" / "probes.csv")["tip y [m]"][-1] / TIP - 1


def installed(measure):
    def of(job):
        return measure(job) if shutil.which("ccx") else ("CalculiX is not installed", False)
    return of


@installed
def bracket(job):
    (h, mine), (k, theirs) = (cheapest(BRACKET[who], lambda x, f=f: f(job, x), 0.005) for who, f in (("ours", our_tip), ("C3D10", their_tip)))
    seconds, around = our_seconds(job, "filleted-bracket", h)
    other = calculix_seconds(written(job, "filleted-bracket", k)[0])
    return (f"h {h:g} {100 * mine:+.2f} % in {seconds:.2f} s, {around:.2f} s of it start-up, reading and writing; C3D10 h {k:g} {100 * theirs:+.2f} % in {other:.2f} s: "
            f"{seconds / other:.2f} times", seconds <= 2 * other)


STEP = f"*STEP\n*FREQUENCY\n{MODES}\n*END STEP\n"


def their_modes(job, h):
    folder, _ = written(job, FORK, h, STEP)
    launch(["ccx", "case"], folder / "log", folder)
    rows = re.findall(r"^\s+\d+\s+\S+E\S+\s+\S+E\S+\s+(\S+E\S+)\s+\S+E\S+\s*$", (folder / "case.dat").read_text(), re.M)
    return [float(f) for f in rows[:MODES]]


def our_modes(job, h):
    with open(our_run(job, FORK, h).folder / "solid" / "modes.csv", encoding="utf-8") as file:
        return [float(row[1]) for row in list(csv.reader(file))[1:]]


def worst(found, right):
    return max(abs(a / b - 1) for a, b in zip(found, right, strict=True))


@installed
def fork(job):
    right = job.once("fine fork", lambda: their_modes(job, FINEST))
    (h, mine), (k, theirs) = (cheapest(PRONGS[who], lambda x, f=f: worst(f(x), right), 0.02)
                              for who, f in (("ours", lambda x: our_modes(job, x)), ("C3D10", lambda x: their_modes(job, x))))
    mine_s, other = our_seconds(job, FORK, h)[0], calculix_seconds(written(job, FORK, k, STEP)[0])
    return (f"h {h:g} {100 * mine:.2f} % in {mine_s:.2f} s; C3D10 h {k:g} {100 * theirs:.2f} % in {other:.2f} s: {mine_s / other:.1f} times",
            mine_s <= 2 * other)


# -- estimates --------------------------------------------------------------------------------------------------------
NONE = ()
SOFT = ("simulation.accept=[buckling]",)  # Cook's load is near the one that buckles the panel


def beam(length):
    return (f"participants.solid.probes.tip.point=[{length}, 0.5, 0.5]",)


def beam_meshes(length, shape):
    return [f"n: {n}, nl: {nl}, L: {length}, shape: {shape}" for n, nl in ((1, 10), (2, 20), (2, 40), (3, 30), (4, 40))]


def rings(text, sizes):
    return [text.format(r=r, t=3 * r // 2, z=3 * r // 4) for r in sizes]


# (case, displacement, meshes, the fine one, further keys)
BODIES = (
    ("cook", "corner y", [f"n: {n}, shape: 0" for n in (4, 8, 16, 32)], "n: 128, shape: 0", SOFT),
    ("cook", "corner y", [f"n: {n}, shape: 1" for n in (4, 8, 16, 32)], "n: 128, shape: 0", SOFT),
    ("le1", "D x", rings("nr: {r}, nt: {t}", (4, 8, 16, 32)), "nr: 128, nt: 192", NONE),
    ("lame-cylinder", "inside x", rings("nr: {r}, nt: {t}, shape: 0", (4, 8, 16)), "nr: 96, nt: 144, shape: 0", NONE),
    ("lame-cylinder", "inside x", rings("nr: {r}, nt: {t}, shape: 1", (4, 8, 16)), "nr: 96, nt: 144, shape: 0", NONE),
    ("off-axis-bar", "tip y", [f"n: {n}, shape: 0" for n in (4, 8, 16)], "n: 64, shape: 0", NONE),
    ("off-axis-bar", "tip y", [f"n: {n}, shape: 1" for n in (4, 8, 16)], "n: 64, shape: 0", NONE),
    ("slender-beam", "tip y", beam_meshes(10, 0), "n: 6, nl: 80, L: 10, shape: 0", beam(10)),
    ("slender-beam", "tip y", beam_meshes(10, 1), "n: 6, nl: 80, L: 10, shape: 0", beam(10)),
    ("slender-beam", "tip y", beam_meshes(40, 0), "n: 6, nl: 80, L: 40, shape: 0", beam(40)),
    ("slender-beam", "tip y", beam_meshes(40, 1), "n: 6, nl: 80, L: 40, shape: 0", beam(40)),
    ("filleted-bracket", "tip y", [f"h: {h}" for h in (0.01, 0.006, 0.004)], "h: 0.002", NONE),
    ("elliptic-plate", "hole-top z", rings("nr: {r}, nt: {t}, nz: {z}, shape: 0", (4, 8, 12)), "nr: 32, nt: 48, nz: 24, shape: 0", NONE),
    ("elliptic-plate", "hole-top z", rings("nr: {r}, nt: {t}, nz: {z}, shape: 1", (4, 8, 12)), "nr: 32, nt: 48, nz: 24, shape: 0", NONE),
)

# Where the stress of these bodies is read, in the same order: surfaces, none of them where it is singular.
STRESSED = (((0.024, 0.022), (0.024, 0.052)), ((0.024, 0.022), (0.024, 0.052)), ((2, 0),), ((7, 0),), ((7, 0),), ((0.1, 0.01),), ((0.1, 0.01),),
            ((5, 1, 0.5), (2, 1, 0.5)), ((5, 1, 0.5), (2, 1, 0.5)), ((20, 1, 0.5), (8, 1, 0.5)), ((20, 1, 0.5), (8, 1, 0.5)),
            ((0.0229289322, 0.0229289322, 0.015),), ((2, 0, 0.6),), ((2, 0, 0.6),))


def discretisation(folder):
    """What mesh, steps and solvers leave, without what neglected effects change."""
    parts = json.loads((folder / "run.json").read_text())["errors"]
    return sum(parts[k] or 0 for k in ("mesh", "step", "linear"))


def look(job, case, column, mesh, keys):
    """(displacement at the probe, estimate of its error)"""
    run = job.case(case, (f"participants.solid.mesh-parameters={{{mesh}}}", *keys))
    with open(run.folder / "solid" / "probes.csv", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    at = next(i for i, name in enumerate(rows[0]) if name.startswith(column))
    return float(rows[-1][at]), discretisation(run.folder / "solid")


def stress(job, case, mesh, keys, place):
    """(xx, yy, zz and sqrt 2 times xy, yz, xz [Pa]; estimated error over their norm)"""
    probe = f"participants.solid.probes.surface={{point: {list(place)}, fields: [stress]}}"
    folder = job.case(case, (f"participants.solid.mesh-parameters={{{mesh}}}", probe, *keys)).folder / "solid"
    with open(folder / "probes.csv", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    parts = {name[len("surface stress-"):].split()[0]: float(value) for name, value in zip(rows[0], rows[-1]) if name.startswith("surface stress-")}
    findings = json.loads((folder / "run.json").read_text())["findings"]
    told = next(f["number"] for f in findings if f["id"] == "stress-error" and "'surface'" in f["sentence"])
    return [value * (1 if name[0] == name[1] else math.sqrt(2)) for name, value in parts.items()], told


def stress_ratios(job):
    def make():
        found = []
        for (case, _, meshes, fine, keys), places in zip(BODIES, STRESSED):
            for place in places:
                right = stress(job, case, fine, keys, place)[0]
                for mesh in meshes:
                    value, told = stress(job, case, mesh, keys, place)
                    found.append(((told or 0) * math.hypot(*right) / math.dist(value, right), f"{case} {{{mesh}}}"))
        return found
    return job.once("estimates of stress beside errors", make)


def stress_within(job):
    found = stress_ratios(job)
    inside = sum(1 / 3 <= r <= 3 for r, _ in found)
    (small, where), large = min(found), max(found)[0]
    return f"{inside} of {len(found)}, {100 * inside / len(found):.0f} %; least {small:.2f} ({where}), largest {large:.0f}", inside >= 0.8 * len(found)


def ratios(job):
    def make():
        found = []
        for case, column, meshes, fine, keys in BODIES:
            right = look(job, case, column, fine, keys)[0]
            for mesh in meshes:
                value, told = look(job, case, column, mesh, keys)
                found.append((told / abs(value / right - 1), f"{case} {{{mesh}}}"))
        return found
    return job.once("estimates beside errors", make)


def within(job, factor, wanted):
    found = ratios(job)
    inside = sum(1 / factor <= r <= factor for r, _ in found)
    return f"{inside} of {len(found)}, {100 * inside / len(found):.0f} %", inside >= wanted * len(found)


def least(job):
    ratio, where = min(ratios(job))
    return f"least {ratio:.2f} ({where}), largest {max(ratios(job))[0]:.0f}", ratio >= 1 / 3
