#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Closed fluids under elastic walls: what is pumped in is what the wall gives way, on any number of ranks and across a restart,
for a moving mesh, and for a balloon in a channel; without the key such a fluid is refused.
Usage: cavity.py CONFIGS BIN"""
import csv
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import mpmd, require  # noqa: E402

CONFIGS, BIN = map(pathlib.Path, sys.argv[1:3])
CAVITY = [("coupler", ""), ("fluid_solver", ""), ("solid_solver", ""), ("mesh_mover", "")]
BALLOON = [("coupler", ""), ("fluid_solver", "inside"), ("fluid_solver", "channel"), ("solid_solver", "")]
SMALL = ["participants.fluid.mesh-parameters={n: 8}", "participants.mover.mesh-parameters={n: 8}",
         "participants.lid.mesh-parameters={n: 8}", "simulation.end-time=0.16", "simulation.output.interval=0"]


def run(folder, case, programs, sets, ranks=(1, 1, 1, 1), restart=None):
    words = [f"--set=simulation.output.folder={folder}", *(f"--set={s}" for s in sets), *(["--restart", restart] if restart else [])]
    parts = [[BIN / program, CONFIGS / case / "case.yaml", *words, *(["--participant", participant] if participant else [])] for program, participant in programs]
    return subprocess.run(mpmd(parts, ranks), capture_output=True, text=True, timeout=600)


def done(*args, **more):
    result = run(*args, **more)
    if result.returncode != 0:
        sys.exit(f"exit code {result.returncode}\n{result.stdout[-3000:]}\n{result.stderr[-2000:]}")


def rows(folder, file):
    with (folder / "coupler" / file).open() as lines:
        return [[float(v) for v in row] for row in list(csv.reader(lines))[1:]]


def passes(folder):
    return len(rows(folder, "residuals.csv")) / len(rows(folder, "volume.csv"))


with tempfile.TemporaryDirectory(prefix="couplet-cavity-") as scratch:
    here = pathlib.Path(scratch)
    done(here / "one", "closed-cavity", CAVITY, [*SMALL, "simulation.checkpoint={interval: 0.08, keep: 9}"])
    one = rows(here / "one", "volume.csv")
    inflow = one[-1][3]
    require("moving mesh: volume error over the inflow, on faces that turn", max(abs(r[4]) for r in one) < 1e-10 * inflow,
          max(abs(r[4]) for r in one) / inflow)
    require("moving mesh: passes a step", passes(here / "one") <= 6, passes(here / "one"))

    half = [s.replace("0.16", "0.08") for s in SMALL]
    done(here / "three", "closed-cavity", CAVITY, half, (2, 3, 2, 1))
    three = rows(here / "three", "volume.csv")
    apart = max(abs(a[k] / b[k] - 1) for a, b in zip(one[:4], three, strict=True) for k in (1, 2))
    require("2 + 3 + 2 ranks: level and volume apart", apart < 1e-5, apart)

    done(here / "second", "closed-cavity", CAVITY, SMALL, restart=here / "one" / "checkpoints/step-00000004")
    second = rows(here / "second", "volume.csv")
    require("restart bit for bit", second == one[4:], f"{len(second)} rows")

    end = ["simulation.end-time=0.1", "simulation.output.interval=0"]
    done(here / "balloon", "balloon", BALLOON, end)
    steps = rows(here / "balloon", "volume.csv")
    worst = max(abs(b[4] - a[4]) / abs(b[3] - a[3]) for a, b in zip(steps, steps[1:]))
    require("balloon in a channel: volume of a step over its inflow", worst < 1e-10, worst)
    require("balloon in a channel: passes a step", passes(here / "balloon") <= 6, passes(here / "balloon"))

    refused = run(here / "none", "closed-cavity", CAVITY, [*SMALL, "participants.fluid.volume-level=none"])
    require("without the key: refused", refused.returncode != 0 and "set 'volume-level: structure'" in refused.stdout + refused.stderr,
          f"exit code {refused.returncode}")
    shorter = run(here / "sub-steps", "closed-cavity", CAVITY, [*SMALL, "coupling.sub-steps={lid: 3}"])
    require("sub-steps of the lid: refused", shorter.returncode != 0 and "does not support sub-steps" in shorter.stdout + shorter.stderr,
          f"exit code {shorter.returncode}")
    outlet = run(here / "outlet", "balloon", BALLOON, [*end, "participants.channel.volume-level=structure"])
    require("with the key and an outlet: refused", outlet.returncode != 0 and "this fluid has an outlet" in outlet.stdout + outlet.stderr,
          f"exit code {outlet.returncode}")
print("all checks passed")
