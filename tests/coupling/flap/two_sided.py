#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A soft light flap, wet on both sides, by the Robin interface without acceleration: together its sides converge in a few passes a step,
also on several ranks and across a restart; the failing neighbour, each side for itself, does not in 30. Coarse meshes.
Usage: two_sided.py CONFIG_FOLDER BIN"""
import csv
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import COUPLED, mpmd, require  # noqa: E402

SOURCE, BIN = (pathlib.Path(path).resolve() for path in sys.argv[1:3])
FLUID_MESH = "mesh-parameters={n_side: 20, n_tip: 4, growth: 1.25, wall_cells: 5}"
SETS = ("simulation.end-time=0.05", "simulation.max-step-halvings=0", "simulation.output.interval=0", "simulation.checkpoint={interval: 0.01, keep: 9}",
        "participants.fluid.boundaries.inlet.ramp=0.4", "participants.fluid.viscosity=0.01", "participants.solid.material.density=10",
        "participants.solid.material.youngs-modulus=1e4", "participants.solid.interface={surface-density: true}", "coupling.order=structure-first",
        "coupling.acceleration={type: constant, initial-relaxation: 1}", "participants.fluid.boundaries.flap.impedance=structure",
        f"participants.fluid.{FLUID_MESH}", f"participants.mover.{FLUID_MESH}", "participants.solid.mesh-parameters={n_side: 40, n_tip: 8}")


def launch(here, name, *sets, ranks=1, restart=None):
    words = [f"--set={s}" for s in (*SETS, f"simulation.output.folder={name}", *sets)] + (["--restart", restart] if restart else [])
    line = mpmd([[BIN / program, "case.yaml", *words] for program in COUPLED], (1, ranks, ranks))
    return subprocess.run(line, cwd=here, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=280)


def table(file):
    with open(file, encoding="utf-8") as text:
        return list(csv.reader(text))[1:]


def main():
    with tempfile.TemporaryDirectory(prefix="couplet-two-sided-") as name:
        here = pathlib.Path(name)
        for file in ("case.yaml", "fluid.geo", "solid.geo"):
            shutil.copy(SOURCE / file, here)
        together = launch(here, "together")
        require("together: exit code", together.returncode == 0, f"{together.returncode}\n{together.stdout[-2000:] if together.returncode else ''}")
        require("together: the log names the two sides", "Robin interface: 95 % of it lies opposite itself" in together.stdout, "")
        passes = len(table(here / "together/coupler/residuals.csv")) / 5
        require("together: at most 10 passes a step", passes <= 10, passes)
        apart = launch(here, "apart", "participants.fluid.boundaries.flap.sides=apart")
        require("apart: the coupling fails, by name", apart.returncode != 0 and "did not converge" in apart.stdout, apart.returncode)
        tips = table(here / "together/solid/probes.csv")
        launch(here, "ranks", ranks=2)
        gap = max(abs(float(a[1]) - float(b[1])) for a, b in zip(table(here / "ranks/solid/probes.csv"), tips)) / abs(float(tips[-1][1]))
        require("fluid and solid on 2 ranks: tips apart", gap < 1e-4, gap)
        shutil.copytree(here / "together/checkpoints/step-00000003", here / "set")
        launch(here, "on", restart="set")
        require("restart bit for bit", table(here / "on/solid/probes.csv")[-2:] == tips[-2:], tips[-1])


main()
