# SPDX-License-Identifier: Apache-2.0
"""The estimated errors of displacement and stress of a static run, compared with the true ones: committed bodies, several meshes each, default settings, against
a mesh several times as fine."""
import csv
import json
import math

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
    run = job.alone(case, (f"participants.solid.mesh-parameters={{{mesh}}}", *keys))
    with open(run.folder / "solid" / "probes.csv", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    at = next(i for i, name in enumerate(rows[0]) if name.startswith(column))
    return float(rows[-1][at]), discretisation(run.folder / "solid")


def stress(job, case, mesh, keys, place):
    """(xx, yy, zz and sqrt 2 times xy, yz, xz [Pa]; estimated error over their norm)"""
    probe = f"participants.solid.probes.surface={{point: {list(place)}, fields: [stress]}}"
    folder = job.alone(case, (f"participants.solid.mesh-parameters={{{mesh}}}", probe, *keys)).folder / "solid"
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
