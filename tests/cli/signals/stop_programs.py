#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A stop is honoured by programs whose libraries have started while they run, PETSc's among them: SIGTERM after the first steps ends with
code 3, a checkpoint and a report. The fluid alone, and each participant of the flap.  Usage: stop_programs.py BIN CONFIGS"""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import COUPLED, check, end, living, mpmd  # noqa: E402

PROGRAMS, CONFIGS = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
PATIENCE = 120
MESH = "{n_side: 20, n_tip: 2, growth: 1.35, wall_growth: 1.35, wall_cells: 5}"


def stop(words, program, out, reports):
    with open(out.parent / f"{out.name}.log", "w+", encoding="utf-8") as log:
        job = subprocess.Popen([str(w) for w in words], stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT, start_new_session=True)
        limit = time.monotonic() + PATIENCE
        steps = out / reports / "steps.csv"
        while job.poll() is None and time.monotonic() < limit and not (steps.exists() and steps.read_text().count("\n") > 3):
            time.sleep(0.02)
        victim = next((pid for pid, its_name in living(job.pid).items() if its_name == program), None)
        if victim:
            os.kill(victim, signal.SIGTERM)
        try:
            code = job.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            os.killpg(job.pid, signal.SIGKILL)
            code = job.wait()
        log.seek(0)
        text = log.read()
    check(f"{program} {'alone' if words[0] != 'mpirun' else 'of the flap'}: stops with code 3, its state and its report",
          code == 3 and "by a signal; the state is saved" in text and list(out.glob("checkpoints/step-*/set.txt")) and (out / reports / "run.json").exists(),
          "" if code == 3 else (code, text[-1500:]))


with tempfile.TemporaryDirectory(prefix="couplet-stop-programs-") as name:
    top = pathlib.Path(name)
    long = ["--set", "simulation.end-time=1000 s", "--set", "simulation.output.interval=0"]
    stop([PROGRAMS / "fluid_solver", CONFIGS / "cavity/case.yaml", *long, "--set", f"simulation.output.folder={top / 'alone'}", "--set",
          "participants.fluid.mesh-parameters={n: 16}"], "fluid_solver", top / "alone", "fluid")
    for program in ("fluid_solver", "solid_solver", "mesh_mover", "coupler"):
        out = top / program
        words = [*long, *(f"--set={s}" for s in (f"simulation.output.folder={out}", f"participants.fluid.mesh-parameters={MESH}",
                                                 f"participants.mover.mesh-parameters={MESH}"))]
        stop(mpmd([PROGRAMS / each, CONFIGS / "perpendicular-flap/case.yaml", *words] for each in COUPLED), program, out, "fluid")
end()
