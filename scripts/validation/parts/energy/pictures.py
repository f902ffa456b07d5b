# SPDX-License-Identifier: Apache-2.0
"""The committed studies of accuracy against time: three gradients, all cell kinds, several methods, CalculiX beside."""
import csv
import re

GRADIENTS = {"thesis", "corrected", "symmetric"}
SPACE, PLANE = {"hexahedra", "prisms", "tetrahedra"}, {"quadrilaterals", "triangles"}
STUDIES = {  # name: (folder in docs/validation/studies, quantity, cells)
    "plate B": ("elliptic-plate-gradients", "displacement", SPACE), "LE1": ("le1-gradients", "stress at D", PLANE),
    "LE10": ("le10-gradients", "stress at D", SPACE), "LE11": ("le11-gradients", "stress at A", SPACE), "beam C": ("cantilever-gradients", "tip", SPACE)}
TARGET = 0.01  # error to which the cheapest runs are told


def cheapest(series):
    """(seconds, name) of the cheapest point from which on its series stays within TARGET: a coarse mesh may come near by chance. `series`:
    {name: [(seconds, error, what)] from coarse to fine}; none: inf."""
    found = [(float("inf"), "none")]
    for name, points in series.items():
        for k, (seconds, _, what) in enumerate(points):
            if all(error <= TARGET for _, error, _ in points[k:]):
                found.append((seconds, what))
    return min(found)


def ours(rows, quantity, gradient):
    """Series of a gradient, as `cheapest` takes them."""
    found = {}
    for r in sorted(rows, key=lambda r: float(r["mesh"])):
        if r["gradient"] == gradient:
            found.setdefault((r["method"], r["cells"]), []).append(
                (float(r["processor [s]"]), float(r[f"error of {quantity}"]), f"{r['mesh']}-{r['method']}-{r['cells']}"))
    return found


def theirs(peers):
    found = {}
    for who, seconds, error in peers:
        if "CalculiX" in who:
            found.setdefault(who, []).append((float(seconds), float(error), who))
    return found


def lacking(rows, cells, folder, quantity, peers):
    """What a study should show and does not."""
    good = [r for r in rows if not r["reason"]]
    sizes = {}
    for r in good:
        sizes.setdefault((r["gradient"], r["cells"], r["method"]), set()).add(r["mesh"])
    found = [f"{g} on {c} by multigrid on two meshes" for g in sorted(GRADIENTS) for c in sorted(cells) if len(sizes.get((g, c, "multigrid"), ())) < 2]
    found += [f"two methods of {g}" for g in sorted(GRADIENTS) if len({m for other, _, m in sizes if other == g}) < 2]
    found += [f"why {m} takes no symmetric gradient" for m in ("segregated", "block-coupled")
              if not any(r["method"] == m and r["gradient"] == "symmetric" and "face-gradient: symmetric" in r["reason"] for r in rows)]
    found += [] if any("CalculiX" in who for who, _, _ in peers) else ["CalculiX"]
    picture = folder / f"error-{quantity.replace(' ', '-')}.png"
    return found + ([] if picture.exists() else [picture.name])


def pictures(job):
    texts, met = [], True
    for name, (place, quantity, cells) in STUDIES.items():
        folder = job.root / "docs/validation/studies" / place
        with open(folder / "runs.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        good = [r for r in rows if not r["reason"]]
        peers = re.findall(r"^\| ((?:CalculiX \w+|solidDisplacementFoam)(?:, [\w, -]+)?) \| ([\d.e+-]+) \| ([\d.e+-]+) \|", (folder / "report.md").read_text(), re.M)
        missing = lacking(rows, cells, folder, quantity, peers)
        best = [(g, *cheapest(ours(good, quantity, g))) for g in sorted(GRADIENTS)] + [("CalculiX", *cheapest(theirs(peers)))]
        told = [f"{who} {seconds:.2f} s ({what.replace('CalculiX ', '')})" if what != "none" else f"{who} none" for who, seconds, what in best]
        texts.append(f"{name}: {len(good)} runs, {len(rows) - len(good)} refused or failed with their reason; to {100 * TARGET:g} %: {', '.join(told)}"
                     + (f"; lacking: {', '.join(missing)}" if missing else ""))
        met = met and not missing
    return "; ".join(texts), met
