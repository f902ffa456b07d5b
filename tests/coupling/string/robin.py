#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The Robin interface on the elastic wall of string.py: few passes at any mass ratio beside Aitken's many, the same motion, also in a
closed domain, on several ranks and across a restart; arrangements that cannot work are refused.
Usage: robin.py BIN TOYS"""
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import mpmd, require  # noqa: E402

os.environ["PATH"] = os.pathsep.join(sys.argv[1:3] + [os.environ["PATH"]])
MU = 5 / (math.pi * math.tanh(0.1 * math.pi))
HERE = pathlib.Path(__file__).resolve().parent
CLOSED = "participants.fluid.boundaries.ends={type: no-slip}"
PUMP = "participants.fluid.boundaries.bottom={type: inlet, velocity: [0, 1e-7 * sin(100 * pi * t)]}"


def launch(inverse, sets, ranks, restart):
    sets = [f"participants.wall.surface-density={MU * inverse}", "simulation.end-time=0.008", "coupling.predictor.order=2",
            "coupling.acceleration.filter=1e-5", "coupling.acceleration.type=iqn-ils", "simulation.output.interval=0", *sets]
    words = [*(f"--set={s}" for s in sets), *(["--restart", restart] if restart else [])]
    line = mpmd([[program, "case.yaml", *words] for program in ("coupler", "fluid_solver", "toy_wall")], ranks)
    return subprocess.run(line, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=600)


def run(name, inverse, *sets, ranks=(1, 1, 1), restart=None):
    """Passes a step and the rows of the wall's motion."""
    done = launch(inverse, [f"simulation.output.folder={name}", *sets], ranks, restart)
    if done.returncode != 0:
        sys.exit(f"exit code {done.returncode}\n{done.stdout[-3000:]}")
    motion, passes = table(f"{name}/wall/mode.csv"), table(f"{name}/coupler/residuals.csv")
    return len(passes) / len({row[2] for row in passes}), motion


def watched(name):
    """Rows of watch.csv: time, force as the fluid gives it, flux of the wall's velocity, force as the wall takes it."""
    return table(f"{name}/coupler/watch.csv")


WATCH = ("coupling.watch={out: {participant: fluid, data: velocity}, given: {participant: fluid, data: pressure-force}, "
         "taken: {participant: wall, data: pressure-force}}")


def robin(inverse, share=1.0):
    return ["coupling.order=structure-first", f"participants.fluid.boundaries.wall.surface-density={share * MU * inverse}"]


def table(file):
    return [[float(word) for word in line.split(",")] for line in pathlib.Path(file).read_text().splitlines()[1:]]


def apart(a, b):
    return max(abs(x[1] - y[1]) for x, y in zip(a, b)) / max(abs(y[1]) for y in b)


with tempfile.TemporaryDirectory(prefix="couplet-robin-") as folder:
    for file in ("case.yaml", "channel.geo"):
        shutil.copy(HERE / file, folder)
    os.chdir(folder)
    for inverse in (0.05, 20):
        few, motion = run(f"robin-{inverse}", inverse, *robin(inverse), WATCH)
        many, same = run(f"aitken-{inverse}", inverse, "coupling.acceleration.type=aitken", "coupling.acceleration.initial-relaxation=0.05")
        require(f"rho_s h/(rho_f mu_1) {inverse}: passes a step, Robin at most 4.5, Aitken more", few <= 4.5 and many > few, f"{few} and {many}")
        require(f"rho_s h/(rho_f mu_1) {inverse}: the same motion", apart(motion, same) < 1e-5, apart(motion, same))
    quarter, motion = run("quarter", 0.05, *robin(0.05, 0.25))
    require("a quarter of the mass given: passes a step, and the same motion", quarter <= 6 and apart(motion, table("robin-0.05/wall/mode.csv")) < 1e-5, quarter)

    few, motion = run("closed", 0.5, *robin(0.5), CLOSED, PUMP, WATCH)
    require("closed and pumped: passes a step at most 4.5", few <= 4.5, few)
    # What the pump brings in through 5 m goes out through the wall; the same forces on both sides.
    through = max(abs(row[3] / (5e-7 * math.sin(100 * math.pi * row[0])) - 1) for row in watched("closed"))
    require("closed and pumped: flux watched through the wall over what is pumped in, apart", through < 1e-8, through)
    forces = max(abs(row[k] - row[k + 3]) for row in watched("closed") for k in (1, 2)) / max(abs(row[2]) for row in watched("closed"))
    require("forces watched on both sides, apart (the wall has those of the pass before)", forces < 1e-6, forces)
    nobody = launch(0.5, [*robin(0.5), "coupling.watch={out: {participant: fluid, data: heat}}"], (1, 1, 1), None)
    require("a datum that there is not: refused", nobody.returncode != 0 and "coupling.watch.out.data: 'fluid' neither gives nor takes 'heat'" in
          nobody.stdout, f"exit code {nobody.returncode}")
    stranger = launch(0.5, [*robin(0.5), "coupling.watch={out: {participant: fluids, data: velocity}}"], (1, 1, 1), None)
    require("a participant that there is not: refused", stranger.returncode == 2 and "'fluids' takes no part in the coupling" in stranger.stdout,
          f"exit code {stranger.returncode}")
    _, level = run("level", 0.5, CLOSED, PUMP, "participants.fluid.volume-level=structure", "coupling.convergence.relative=1e-8")
    require("closed and pumped: the motion is that of the level from the structure", apart(motion, level) < 1e-4, apart(motion, level))

    _, motion = run("ranks", 0.05, *robin(0.05), WATCH, ranks=(2, 3, 1))
    require("2 + 3 ranks: motion apart", apart(motion, table("robin-0.05/wall/mode.csv")) < 1e-5, apart(motion, table("robin-0.05/wall/mode.csv")))
    run("first", 0.05, *robin(0.05), WATCH, "simulation.end-time=0.004")
    _, second = run("second", 0.05, *robin(0.05), WATCH, restart="first/checkpoints")
    require("restart bit for bit", second == table("robin-0.05/wall/mode.csv")[4:] and watched("second") == watched("robin-0.05")[4:],
          f"{len(second)} rows")
    ranked, alone = ([list(column) for column in zip(*watched(name))] for name in ("ranks", "robin-0.05"))
    differ = max(max(abs(x - y) for x, y in zip(a, b)) / max(map(abs, b)) for a, b in zip(ranked, alone) if max(map(abs, b)) > 1e-15)
    require("2 + 3 ranks: integrals watched, apart", differ < 1e-5, differ)

    refused = launch(1, ["participants.fluid.boundaries.wall.surface-density=1"], (1, 1, 1), None)
    require("without structure-first: refused", refused.returncode != 0 and "structure-first" in refused.stdout, f"exit code {refused.returncode}")
    both = launch(1, [*robin(1), CLOSED, "participants.fluid.volume-level=structure"], (1, 1, 1), None)
    require("with a level as well: refused", both.returncode != 0, f"exit code {both.returncode}")
print("all checks passed")
