#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A tank whose ground and blanket are participants of their own, on several ranks, against the tank that has them itself.
Usage: parts.py PROJECT BIN MPIRUN..."""
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import mpmd, said  # noqa: E402

project, programs, mpirun = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3:]
# Without the gas: the roof's blanket belongs to the tank.
same = ["--set=participants.tank.ullage=", "--set=simulation.end-time=24 h"]
height = "--set=participants.blanket.height=12.76 m"


def last(folder, name):
    rows = np.genfromtxt(folder / "tank" / name, delimiter=",", skip_header=1)
    return rows[rows[:, 0] == rows[-1, 0]]


with tempfile.TemporaryDirectory(prefix="couplet-parts-") as folder:
    folder = pathlib.Path(folder)
    said([programs / "thermocline", project / "configs/thermocline-solar-one/case.yaml", *same, "--set=simulation.time-step=5 min", f"--set=simulation.output.folder={folder}/alone"])
    case = project / "configs/thermocline-solar-one-parts/case.yaml"

    def job(ranks, *words):
        return mpmd([[programs / "coupler", case, *words], *([programs / "thermocline", case, "--participant", name, *words] for name in ("tank", "soil", "blanket"))],
                    (1, *3 * [ranks]), mpirun)
    found = []
    for ranks in (1, 2):
        log = said(job(ranks, *same, height, f"--set=simulation.output.folder={folder}/{ranks}"))
        found.append(folder / str(ranks))
        books = re.findall(r"(ground|insulation): .* taken from the tank, (\S+) MWh passed on; energy balance error (\S+) of", log)
        if len(books) != 2:
            sys.exit("the elements say nothing of their books:\n" + log)
    # A blanket of another height than the wall: refused, with both.
    refused = subprocess.run(job(1, *same, "--set=participants.blanket.height=12.5 m", f"--set=simulation.output.folder={folder}/wrong"), capture_output=True, text=True)
    if refused.returncode == 0 or "participants.blanket.height is 12.5 m, but that of the tank is 12.76 m of wall" not in refused.stderr + refused.stdout:
        sys.exit(f"a blanket that is too low: exit code {refused.returncode}\n" + refused.stderr)
    alone = folder / "alone"
    amounts = np.genfromtxt(found[0] / "coupler" / "amounts.csv", delimiter=",", names=True)
    given = np.array([list(row)[1:] for row in amounts])
    unbalanced = np.abs(given[:, 0::2] - given[:, 1::2]).max() / np.abs(given).max()
    fluid = np.abs(last(alone, "bed.csv")[:, 2] - last(found[0], "bed.csv")[:, 2]).max()
    stress = np.abs(last(alone, "wall.csv")[:, 3] - last(found[0], "wall.csv")[:, 3]).max()
    lost = dict(zip(("insulation", "ground"), last(alone, "tank.csv")[-1][[7, 9]] / 3.6e9))  # to air and soil [MWh]
    losses = [abs(float(passed) / lost[name] - 1) for name, passed, _ in books]
    books = max(float(off) for *_, off in books)
    apart = np.abs(last(found[0], "bed.csv") - last(found[1], "bed.csv")).max()
    print(f"fluid {fluid:.3f} K, stress {stress / 1e6:.3f} MPa, losses {losses[0]:.2e} and {losses[1]:.2e}, "
          f"books {books:.1e}, given and taken {unbalanced:.1e}, ranks {apart:.1e}")
    ok = fluid < 0.2 and stress < 1e6 and max(losses) < 0.01 and unbalanced < 1e-12 and apart == 0 and books < 1e-9
    sys.exit(0 if ok else 1)
