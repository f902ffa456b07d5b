# SPDX-License-Identifier: Apache-2.0
"""Measures of the atlas: its squares as committed, and the positions that runs between its squares report."""
import csv
import json
import pathlib
import tempfile


# Of each map: its panels, places between its squares, and the quantity whose number is the map's own axis (by a factor).
BETWEEN = [
    ("fluid-diffusion", ["explicit, Adams-Bashforth", "explicit, Runge-Kutta"], [0.07, 0.11, 0.13, 0.2, 0.35], [0.25, 0.75]),
    ("fluid-convection", ["explicit, Adams-Bashforth", "implicit viscous term", "explicit, Runge-Kutta"], [0.3, 0.7, 1.2, 1.7], [0.25, 0.75]),
    ("coupling-mass", ["explicit, predictor 1", "explicit, predictor 2"], [0.5, 0.8, 1.5, 5], [0.05]),
]


def placed(folder):
    """Largest share of the way to a limit in any run.json of the folder; None without one."""
    found = [c for file in pathlib.Path(folder).glob("out/*/run.json") for c in json.loads(file.read_text()).get("atlas", []) if c["map"] != "strong-robin"]
    return max(((1 - c["value"]) / (1 - c["limit"]) if c["floor"] else c["value"] / c["limit"] for c in found), default=None)


def halved(folder):
    """Whether a failed step made the run continue with shorter ones."""
    for file in pathlib.Path(folder).glob("out/*/steps.csv"):
        with open(file, newline="") as rows:
            steps = [float(r["dt [s]"]) for r in csv.DictReader(rows)]
        if steps and min(steps) < 0.75 * steps[0]:
            return True
    return False


def positions(job):
    from couplet.atlas import atlas
    from couplet.atlas.main import MAPS
    maps = {m.name: m for m in MAPS}
    right, early, saved, wrong = 0, 0, 0, []
    with tempfile.TemporaryDirectory(prefix="couplet-atlas-") as scratch:
        for name, panels, xs, ys in BETWEEN:
            for panel, x, y in ((p, x, y) for p in panels for x in xs for y in ys):
                runner = atlas.Runner(job.build, pathlib.Path(scratch) / f"{name}-{panels.index(panel)}-{x}-{y}".replace(" ", ""))
                square = atlas.judged(maps[name], *maps[name].run(panel, x, y, runner))
                used = placed(next(runner.scratch.iterdir()))
                held = square.outcome in (atlas.HOLDS, atlas.POOR)
                if used is not None and held == (used <= 1):
                    right += 1
                elif used is not None and held and used <= 1.5:
                    early += 1  # a bound on the eigenvalues is beyond them on oblique cells
                elif used is not None and held and halved(next(runner.scratch.iterdir())):
                    saved += 1  # the first steps were where it is printed
                else:
                    wrong.append(f"{name} {panel} {x:g}, {y:g}: {used if used is None else round(used, 2)} of the way, {square.outcome}")
    total = right + early + saved + len(wrong)
    return f"{right} of {total} agree, {early} hold up to 1.5 times the limit, {saved} begin beyond it and hold by halved steps" + (f"; not: {'; '.join(wrong)}" if wrong else ""), total >= 50 and not wrong
