# SPDX-License-Identifier: Apache-2.0
"""Heat between a fluid and a solid. wall: a composite wall against its closed form, on 1, 2 and 3 ranks. energy: an insulated one keeps its heat. order:
second order in time while its left side warms up. substeps: the schemes agree where the fluid divides its steps. steady: a run with a frozen flow
ends by itself. passes: iterations per step for ratios of the conductances, steps and orders, where the temperature
varies along the wall. restart: a flap in a hot stream goes on bit for bit, and on more ranks. alone: each program by itself is refused. apart: so are surfaces that do not meet. With a JSON file,
it keeps the numbers for `scripts/validate heat`. Usage: conjugate.py BIN PART [JSON]"""
import csv
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import COUPLED, check, end, failed, mpmd, said  # noqa: E402

BIN, part = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
HERE = pathlib.Path(__file__).resolve().parent
STREAM = HERE.parents[2] / "configs/hot-stream"
WALL = ("coupler", "fluid_solver", "solid_solver")
EXACT = 0.5 * 50 / (1 / 0.6 + 0.5 / 1.5)  # [W]
numbers = {}


def run(folder, *sets, programs=WALL, ranks=(), restart=None):
    words = [f"--set={s}" for s in sets] + (["--restart", restart] if restart else [])
    said(mpmd([[BIN / program, "case.yaml", *words] for program in programs], ranks), 600, cwd=folder)
    return folder / "out"


def wall(folder, *sets, **more):
    shutil.rmtree(folder / "out", ignore_errors=True)
    for file in ("case.yaml", "wall.geo"):
        shutil.copy(HERE / file, folder)
    return run(folder, *sets, **more)


def column(out, file, name):
    with open(out / file, encoding="utf-8") as lines:
        names, *rows = csv.reader(lines)
    return np.array([float(row[names.index(name)]) for row in rows])


def passes(out):
    return np.unique(column(out, "coupler/residuals.csv", "step"), return_counts=True)[1]


def within(claim, value, low, high):
    numbers[claim] = value
    check(claim, low <= value <= high, f"{value:.6g} (from {low:.6g} to {high:.6g})")


def last_state(out, step):
    state = {}
    for file in sorted((out / f"checkpoints/step-{step:08d}").glob("*.h5")):
        with h5py.File(file) as data:
            data.visititems(lambda name, item: state.update({f"{file.stem}: {name}": item[()]}) if isinstance(item, h5py.Dataset) else None)
    return state


def composite_wall(folder):
    steady = ("simulation.time-step=50 s", "simulation.end-time=6000 s", "coupling.convergence.relative=1e-6")
    heats = []
    for ranks in ((1, 1, 1), (1, 2, 1), (2, 3, 2)):
        out = wall(folder, *steady, ranks=ranks)
        heats.append([column(out, "solid/heat.csv", "left [W]")[-1], column(out, "fluid/heat.csv", "left [W]")[-1]])
    within("composite wall under a sheared fluid: error of the heat [1]", float(np.abs(np.array(heats[0]) / EXACT - 1).max()), 0, 1e-8)
    within("composite wall, 2 and 3 ranks: difference [1]", float(np.abs(np.array(heats) / EXACT - heats[0][0] / EXACT).max()), 0, 1e-8)


def insulated(folder):
    out = wall(folder, "participants.fluid.boundaries.left={type: no-slip}", "participants.fluid.heat.initial-temperature=350 K",
               "participants.solid.heat.boundaries.right.type=adiabatic", "participants.solid.heat.boundaries.right.value=")
    fluid, solid = column(out, "fluid/heat.csv", "stored [J]"), column(out, "solid/heat.csv", "stored [J]")
    total = fluid + solid
    within("insulated wall: change of the heat of both in 80 steps, of what passes [1]", float(np.ptp(total) / (fluid[0] - fluid[-1])), 0, 1e-10)


def sub_steps(folder):
    """A film acts in all sub-steps, whichever scheme repeats them."""
    heats = []
    for scheme in ("auto", "implicit"):
        out = wall(folder, "participants.fluid.time-step=0.1 s", f"coupling.scheme={scheme}", "coupling.convergence.relative=1e-8", "simulation.end-time=5 s")
        heats.append(column(out, "coupler/amounts.csv", "solid takes heat [W]"))
    within("five sub-steps of the fluid: difference of the schemes [1]", float(np.abs(heats[0] - heats[1]).max() / np.abs(heats[1]).max()), 0, 1e-6)


def steady(folder):
    """The flow is frozen after 5 s, and the run ends by itself at the exact heat; a restart ends at the same step."""
    keys = ("participants.fluid.heat.frozen-flow=5 s", "simulation.until-steady=1e-5", "simulation.end-time=1000 s", "simulation.time-step=2.5 s",
            "simulation.checkpoint={interval: 25 s, keep: 100}", "coupling.convergence.relative=1e-6")
    out = wall(folder, *keys)
    t, heat = (column(out, "solid/heat.csv", name) for name in ("time [s]", "left [W]"))
    within("frozen flow until steady: error of the heat [1]", float(abs(heat[-1] / EXACT - 1)), 0, 2e-5)
    within("and the time when it ends [s]", float(t[-1]), 30, 200)
    shutil.copytree(out / "checkpoints/step-00000010", folder / "middle")
    again = run(folder, *keys, restart="middle")
    check("a run that goes on ends at the same step", column(again, "solid/heat.csv", "time [s]")[-1] == t[-1] and column(again, "solid/heat.csv", "left [W]")[-1] == heat[-1])


def order(folder):
    """The temperature of the left wall rises smoothly; that of the solid's interface after 4 s."""
    values = []
    for steps in (40, 80, 160):
        out = wall(folder, f"simulation.time-step={4 / steps} s", "simulation.end-time=4 s", "coupling.convergence.relative=1e-8",
                   "participants.fluid.boundaries.left.temperature=300 + 50*(1 - cos(t))")
        values.append([column(out, "solid/heat.csv", "stored [J]")[-1], column(out, "fluid/heat.csv", "stored [J]")[-1]])
    gaps = np.abs(np.diff(values, axis=0))
    within("composite wall whose side warms: order in time, least of both programs", float(np.log2(gaps[0] / gaps[1]).min()), 1.85, 2.6)


def iterations(folder):
    worst, most = 0, 0
    for members in ("fluid, solid", "solid, fluid"):
        for ratio in (1e-3, 1e-2, 0.1, 1, 10, 100, 1e3):
            for step in (0.5, 50):
                out = wall(folder, f"participants.solid.material.conductivity={0.3 * ratio}", f"participants.solid.material.specific-heat={20 * ratio}",
                           f"coupling.exchange.participants=[{members}]", f"simulation.time-step={step} s", f"simulation.end-time={20 * step} s",
                           "participants.solid.heat.boundaries.right.value=300 + 40*sin(9*y)*(1 - exp(-t))")
                counts = passes(out)
                print(f"{members}, ratio {ratio:g}, steps of {step} s: {counts.mean():.2f} iterations per step, at most {counts.max()}", flush=True)
                worst, most = max(worst, counts.mean()), max(most, counts.max())
    within("ratios of conductances 1e-3 to 1e3: iterations per step, largest mean", float(worst), 1, 4)
    numbers["ratios of conductances 1e-3 to 1e3: iterations of a step, most"] = float(most)


def restart(folder):
    coarse = ("participants.fluid.mesh-parameters={n_side: 10, n_tip: 1, growth: 1.5, wall_growth: 1.5, wall_cells: 3}",
              "participants.mover.mesh-parameters={n_side: 10, n_tip: 1, growth: 1.5, wall_growth: 1.5, wall_cells: 3}",
              "participants.solid.mesh-parameters={n_side: 20, n_tip: 2}", "simulation.output.interval=0", "simulation.end-time=0.08 s")
    for file in STREAM.parent.joinpath("perpendicular-flap").glob("*.geo"):
        (folder / "perpendicular-flap").mkdir(exist_ok=True)
        shutil.copy(file, folder / "perpendicular-flap")
    here = folder / "hot-stream"
    here.mkdir()
    shutil.copy(STREAM / "case.yaml", here)
    whole = last_state(run(here, *coarse, "simulation.checkpoint={interval: 0.04 s, keep: 10}", programs=COUPLED), 8)
    shutil.copytree(here / "out/checkpoints/step-00000004", here / "middle")
    shutil.copytree(here / "out", here / "whole")
    again = last_state(run(here, *coarse, programs=COUPLED, restart="middle"), 8)
    apart = [key for key in whole if key not in again or not np.array_equal(whole[key], again[key], equal_nan=True)]
    check("a flap in a hot stream goes on bit for bit", len(whole) > 40 and not apart, f"{len(whole)} tables, apart: {apart[:5]}")
    tip, warm = (column(here / "whole", *of)[-1] for of in (("solid/probes.csv", "tip x [m]"), ("fluid/heat.csv", "stored [J]")))
    out = run(here, *coarse, programs=COUPLED, ranks=(1, 3, 2, 2))
    more = (column(out, "solid/probes.csv", "tip x [m]")[-1], column(out, "fluid/heat.csv", "stored [J]")[-1])
    within("and on 2 and 3 ranks: difference of the tip and of the heat [1]", float(max(abs(more[0] / tip - 1), abs(more[1] / warm - 1))), 0, 1e-5)


def alone(folder):
    for file in ("case.yaml", "wall.geo"):
        shutil.copy(HERE / file, folder)
    for program, participant, says in (("fluid_solver", "fluid", "conjugate: true"), ("solid_solver", "solid", "heat.boundaries.left")):
        done = subprocess.run([BIN / program, "case.yaml", "--participant", participant], capture_output=True, text=True, cwd=folder, timeout=60)
        told = done.stdout + done.stderr
        check(f"{program} alone is refused", done.returncode != 0 and says in told, told[-400:])


def apart(folder):
    for file in ("case.yaml", "wall.geo"):
        shutil.copy(HERE / file, folder)
    for keys, wanted in (("participants.solid.mesh-parameters={n: 8, m: 7, x0: 2, x1: 2.5}", "Check the meshes' units and positions"),
                         ("coupling.mapping.type=nearest", "do not nest")):
        done = subprocess.run(mpmd([BIN / program, "case.yaml", f"--set={keys}"] for program in WALL), capture_output=True, text=True, cwd=folder, timeout=60)
        told = done.stdout + done.stderr
        check(f"{keys} is refused", done.returncode != 0 and wanted in told, told[-600:])


PARTS = {"wall": composite_wall, "energy": insulated, "order": order, "substeps": sub_steps, "steady": steady, "passes": iterations, "restart": restart, "alone": alone, "apart": apart}
with tempfile.TemporaryDirectory(prefix="couplet-conjugate-") as name:
    for chosen in PARTS if part == "all" else [part]:
        place = pathlib.Path(name) / chosen
        place.mkdir()
        PARTS[chosen](place)
if len(sys.argv) > 3:
    pathlib.Path(sys.argv[3]).write_text(json.dumps({"numbers": numbers, "failed": failed}, indent=1))
end()
