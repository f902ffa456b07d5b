# SPDX-License-Identifier: Apache-2.0
"""A vortex street (2D-2 on a coarse mesh) drifts in phase, which nothing estimates: after a few periods the run says that the error due to the step is
unknown instead of giving the small sum of its local errors. Usage: street.py BIN CONFIGS PERIODS"""
import json
import pathlib
import subprocess
import sys
import tempfile

programs, configs, periods = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), int(sys.argv[3])
F = "participants.fluid."
BEGIN, PERIOD = 2.0, 0.3765  # [s]; the street's first period after the gust, on this mesh

with tempfile.TemporaryDirectory(prefix="couplet-street-") as temporary:
    end = round(BEGIN + periods * PERIOD, 2)
    sets = [F + "mesh-parameters={n: 12}", F + "output={}", f"simulation.end-time={end} s", "simulation.time-step=0.01 s", f"simulation.output={{folder: {temporary}, interval: {end} s}}"]
    done = subprocess.run([str(programs / "fluid_solver"), str(configs / "cylinder/case.yaml"), *(f"--set={s}" for s in sets)], capture_output=True, text=True)
    report = json.loads((pathlib.Path(temporary) / "fluid/run.json").read_text()) if not done.returncode else {}
    good = not done.returncode and report["errors"]["step"] is None and "the error due to the step is unknown" in done.stdout
    print("ok    " if good else "FAILED", f"2D-2, {periods} periods: {report.get('errors')}", "" if good else done.stdout[-1500:])
    sys.exit(not good)
