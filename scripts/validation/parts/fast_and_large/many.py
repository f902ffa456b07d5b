# SPDX-License-Identifier: Apache-2.0
"""Many ranks, by count and model: benchmarks/scaling."""
import importlib
import json
import sys

SCENES = ("fluid", "solid", "mover", "flap")


def scaling(job, name):
    folder = str(job.root / "benchmarks/scaling")
    if folder not in sys.path:
        sys.path.insert(0, folder)
    return importlib.import_module(name)


def rows(job, scene, ranks):
    """Counts per step of the programs of one scene on these numbers of ranks."""
    counts = scaling(job, "counts")
    return job.once(("counts", scene, tuple(ranks)), lambda: counts.scan({scene: counts.SCENES[scene]}, ranks, job.build))


def words(found, key):
    return "; ".join(f"{program} " + ", ".join(f"{r[key]:.0f} on {r['ranks']}" for r in found if r["program"] == program)
                     for program in dict.fromkeys(r["program"] for r in found))


def per_step(job, key, ranks, scenes=SCENES):
    """One of the counts on several numbers of ranks: `neighbours` must not be all others, `reductions` not grow but for the iterations, `gathers` be none."""
    found = [row for scene in scenes for row in rows(job, scene, ranks)]
    sign = {"neighbours": "exchanges messages with all others", "reductions": "reductions per step", "gathers": "gathers or scatters"}[key]
    wrong = [line for line in scaling(job, "counts").failures(found) if sign in line]
    return words(found, key), not wrong


def flat(job, ranks, share):
    """Iterations of the linear solvers on these numbers of ranks beside those on the first."""
    got, worst = [], 0
    for scene in ("fluid", "solid"):
        own = rows(job, scene, ranks)
        change = max(abs(r["iterations"] / own[0]["iterations"] - 1) for r in own)
        got.append(f"{scene} " + ", ".join(f"{r['iterations']:.1f} on {r['ranks']}" for r in own) + f" ({100 * change:.0f} %)")
        worst = max(worst, change)
    return "; ".join(got), worst <= share


def predicted(job, nodes, cores):
    """Weak scaling as the model makes it of the committed counts."""
    model = scaling(job, "model")
    counts = json.loads((job.root / "benchmarks/scaling/counts.json").read_text())
    found = {program: (weak, strong) for program, ranks, weak, strong in model.predictions(counts, nodes, cores, 1e6) if ranks == nodes * cores}
    return "; ".join(f"{program} {100 * weak:.0f} % weak, {100 * strong:.0f} % strong" for program, (weak, strong) in found.items()), all(w >= 0.9 for w, _ in found.values())
