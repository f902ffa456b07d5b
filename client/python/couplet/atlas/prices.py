# SPDX-License-Identifier: Apache-2.0
"""What each effect adds to a scene, one at a time: seconds of its steps, memory, processes."""
import copy
import csv
import dataclasses
import pathlib
import re
import shutil

import yaml

from couplet.places import ROOT
from couplet.runs import Case, launch

FINITE = {"solid.kinematics": "finite-strain", "solid.material.law": "saint-venant-kirchhoff"}
FLAP_MESH = {"n_side": 20, "n_tip": 2, "growth": 1.3, "wall_growth": 1.3}


@dataclasses.dataclass
class Scene:
    """`adds`: {effect: keys that switch it on}; `lacks`: {effect of the scene: keys without it}. None leaves a key out."""
    name: str
    case: str  # in configs
    base: dict
    adds: dict = dataclasses.field(default_factory=dict)
    lacks: dict = dataclasses.field(default_factory=dict)


SCENES = [
    Scene("static bracket", "cantilever", {"solid.mesh-parameters": {"n_length": 40, "n_side": 4}}, {
        "gravity": {"solid.gravity": [0, -9.81, 0]}, "body force": {"solid.body-force": [0, -1, 0]},
        "thermal strain": {"solid.material.expansion": 1e-5, "solid.temperature": "300 K", "solid.thermal-expansion": {}},
        "geometric non-linearity": FINITE, "inertia": {"solid.analysis": "dynamic"}}),
    Scene("vibrating beam", "vibrating-cantilever", {"solid.mesh-parameters": {"n_length": 30, "n_side": 3}, "simulation.end-time": 2}, {
        "structural damping": {"solid.damping": {"stiffness": 0.01}}, "energies": {"solid.output": {"energies": True}},
        "geometric non-linearity": FINITE,
        "near incompressibility": {"solid.material.poissons-ratio": 0.45,
                                   "solid.solution-method": {"face-gradient": "symmetric", "volume-strain": "cells"}}}),
    Scene("channel", "cavity", {"simulation.end-time": 0.4, "fluid.boundaries.walls": {"type": "outlet"}}, {
        "turbulence model": {"fluid.turbulence": {"model": "wale"}}, "running statistics": {"fluid.statistics": {"start": 0}},
        "body force": {"fluid.body-force": [0, 1e-3]}, "energy budget": {"fluid.output": {"energy-budget": True}},
        "immersed bodies": {"fluid.bodies": {"ball": {"level": "sqrt((x-0.5)^2+(y-0.5)^2)-0.1"}}}}),
    Scene("flap", "perpendicular-flap", {
        "fluid.mesh-parameters": FLAP_MESH, "mover.mesh-parameters": FLAP_MESH, "solid.mesh-parameters": {"n_side": 40, "n_tip": 4},
        "simulation.end-time": 0.2}, {
        "iteration of the whole step": {"coupling.scheme": "implicit"}, "turbulence model": {"fluid.turbulence": {"model": "wale"}},
        "geometric non-linearity": FINITE}, {
        "mesh motion": {"coupling.mesh": None, "participants.mover": None},
        "iteration of pressure and structure": {"coupling.scheme": "explicit"}}),
    Scene("tank", "thermocline-solar-one", {"simulation.end-time": "5 day"}, {"resolved grains": {"tank.bed.shells": 5}}, {
        "ground": {"tank.ground": None}, "filler mechanics": {"tank.filler-mechanics": None}, "insulation": {"tank.insulation": None},
        "mixing": {"tank.bed.mix-inversions": False}}),
]


def changed(data, keys, participants):
    """The case with other keys; they start at a participant unless they start with a section."""
    data = copy.deepcopy(data)
    for key, value in keys.items():
        path = key.split(".")
        node = data["participants"] if path[0] in participants else data
        for part in path[:-1]:
            node = node.setdefault(part, {})
        if value is None:
            node.pop(path[-1], None)
        else:
            node[path[-1]] = value
    return data


def cost(scene, keys, build, scratch, turns=2):
    """(seconds, MB, processes): the least of some runs. Seconds: processor time; of a coupled job the sum of what its participants worked."""
    source = ROOT / "configs" / scene.case
    plain = yaml.safe_load((source / "case.yaml").read_text())
    data = changed(plain, {**scene.base, "simulation.output": {"folder": "out", "interval": "1000 day"}, **keys}, plain["participants"])
    data.pop("study", None)
    folder = pathlib.Path(scratch) / f"{scene.case}-{len(list(pathlib.Path(scratch).iterdir()))}"
    folder.mkdir(parents=True)
    for file in source.glob("*.geo"):
        shutil.copy(file, folder)
    (folder / "case.yaml").write_text(yaml.safe_dump(data, sort_keys=False))
    found = []
    for _ in range(turns):
        shutil.rmtree(folder / "out", ignore_errors=True)
        run = launch(Case(folder / "case.yaml", build).command({}), folder / "run.log", folder=folder, timeout=600)
        # One process alone: its processor time, which a busy machine changes little. Several wait for each other: their own clocks.
        seconds = 0.0 if data.get("coupling") else run.cpu
        for file in () if seconds else (folder / "out").glob("*/steps.csv"):
            with open(file, newline="") as rows:
                seconds += sum(float(r["seconds [s]"]) for r in csv.DictReader(rows))
        memory = re.findall(r"peak memory of .*: (\d+) MB on the rank", (folder / "run.log").read_text())
        processes = len(data["participants"]) + (1 if data.get("coupling") else 0)
        found.append((seconds, sum(map(float, memory)), processes))
    return tuple(min(column) for column in zip(*found))


def measure(scene, build, scratch):
    """[(effect or "", seconds, MB, processes)]: the scene itself, then what each effect adds."""
    plain = cost(scene, {}, build, scratch)
    rows = [("", *plain)]
    for sign, effects in ((1, scene.adds), (-1, scene.lacks)):
        for name, keys in effects.items():
            rows.append((name, *(sign * (a - b) for a, b in zip(cost(scene, keys, build, scratch), plain))))
    return rows


def write(file, table):
    """`table`: {scene: rows}"""
    with open(file, "w", newline="") as out:
        rows = csv.writer(out, lineterminator="\n")
        rows.writerow(["scene", "effect", "seconds", "MB", "processes"])
        for scene, lines in table.items():
            rows.writerows([scene, name, f"{s:.4g}", f"{m:.0f}", p] for name, s, m, p in lines)


def read(file):
    table = {}
    if pathlib.Path(file).exists():
        with open(file, newline="") as rows:
            for r in csv.DictReader(rows):
                table.setdefault(r["scene"], []).append((r["effect"], float(r["seconds"]), float(r["MB"]), int(r["processes"])))
    return table


def picture(table, file):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(2, len(table), figsize=(3.4 * len(table), 6.4), dpi=100, constrained_layout=True, squeeze=False)
    for column, (scene, rows) in enumerate(table.items()):
        names = [name for name, *_ in rows[1:]]
        for ax, item, unit in ((axes[0][column], 1, "% of the time of its steps"), (axes[1][column], 2, "MB")):
            whole = rows[0][1] / 100 if item == 1 else 1
            values = [r[item] / whole for r in rows[1:]]
            ax.barh(names, values, color=["#c0504d" if v > 0 else "#7cc67c" for v in values])
            for i, v in enumerate(values):
                ax.text(max(v, 0), i, f" {v:+.0f}", va="center", fontsize=7)
            ax.set_xlabel(unit, fontsize=8)
            ax.tick_params(labelsize=7)
            ax.margins(x=0.25)
        axes[0][column].set_title(f"{scene}: {rows[0][1]:.2g} s, {rows[0][2]:.0f} MB,\n{rows[0][3]} process{'es' if rows[0][3] > 1 else ''}", fontsize=9)
    figure.suptitle("What each effect adds", fontsize=11)
    figure.savefig(file)
    plt.close(figure)


def page(table):
    text = ("## What each effect adds\n\nFrom `scripts/stability --prices`: the same scene with and without each effect; seconds of "
            "processor time (of a coupled job what its participants worked, without waiting; the less of two runs), memory and processes. "
            "Differences of a tenth and of 1 MB are noise.\n\n"
            "| scene | effect | seconds | MB | processes |\n|---|---|---|---|---|\n")
    for scene, rows in table.items():
        for name, s, m, p in rows:
            text += f"| {scene} | {name} | {s:+.3g} | {m:+.0f} | {p:+d} |\n" if name else f"| {scene} | (the scene itself) | {s:.3g} | {m:.0f} | {p} |\n"
    return text + "\n![What each effect adds](stability/prices.png)\n"
