#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The tank of Solar One with its wall as a program of its own, on several ranks, against the tank alone.
Usage: run.py PROJECT BIN MPIRUN..."""
import importlib.util
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import mpmd, said  # noqa: E402

project, programs, mpirun = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3:]
case = project / "configs/thermocline-solar-one-wall/case.yaml"
file = case.parent / "compare.py"
spec = importlib.util.spec_from_file_location("compare", file)
module = importlib.util.module_from_spec(spec)
spec.loader.exec_module(module)

with tempfile.TemporaryDirectory(prefix="couplet-tank-") as folder:
    folder = pathlib.Path(folder)
    alone = project / "configs/thermocline-solar-one/case.yaml"
    said([programs / "thermocline", alone, f"--set=simulation.output.folder={folder}/alone"])
    found = {}
    for ranks in ((1, 1), (2, 2)):
        out = folder / f"coupled-{ranks[0]}"
        parts = [[programs / program, case, f"--set=simulation.output.folder={out}"] for program in ("coupler", "thermocline", "solid_solver")]
        said(mpmd(parts, (1, *ranks), mpirun))
        found[ranks], _ = module.compare(out, folder / "alone/tank")
        print(ranks, found[ranks])
    one, more = found.values()
    apart = abs(one["stress at 3.4 m"] / more["stress at 3.4 m"] - 1)
    print(f"ranks agree to {apart:.1e}")
    sys.exit(0 if one["mean"] < 0.07 and one["at 3.4 m"] < 0.03 and apart < 1e-8 else 1)
