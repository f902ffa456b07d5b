# SPDX-License-Identifier: Apache-2.0
"""Bodies in one iteration, with the real solvers: two flaps in one flow; fluid, structure and a program that warms the structure; a
rigid leaflet on a hinge. They run, each answers, and a restart continues bit for bit with the history of the quasi-Newton method. The leaflet moves
in the same way in a fluid on two ranks.
Usage: run.py PROJECT BUILD two-flaps|warm-flap|hinged-leaflet"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import check, end  # noqa: E402

project, build, case = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
bodies = {"two-flaps": ["front", "rear"], "warm-flap": ["solid"], "hinged-leaflet": ["leaflet"]}[case]
steps, middle = 4, 2
if case == "warm-flap" and subprocess.run(["/usr/bin/python3", "-c", "import mpi4py, numpy"], capture_output=True).returncode:
    print("skipped: Python without mpi4py and numpy")
    sys.exit(0)


def run(folder, *options):
    """Rows of the tips' motion by body."""
    words = ["--set", f"simulation.output.folder={folder}/out", "--set", f"simulation.end-time={steps / 100}", "--set",
             "simulation.checkpoint.interval=0.02", *options]
    environment = dict(os.environ, COUPLET_BIN=str(build / "bin"), PYTHONPATH=str(project / "client/python"))
    start = [project / "configs" / case / "run"]
    if case == "hinged-leaflet":
        start = [sys.executable, "-m", "couplet", "run", "-q", "--bin", str(build / "bin"), str(project / "configs" / case)]
        words += ["--set", 'participants.fluid.boundaries.inlet.velocity=["10*t", 0]', "--set", "participants.leaflet.body.springs.rest-rotation=[0 deg]"]
    done = subprocess.run([*start, *words], capture_output=True, text=True, timeout=280, env=environment)
    if done.returncode:
        print(done.stdout[-3000:], done.stderr[-3000:])
    check("exit code 0", done.returncode == 0, str(done.returncode))
    return {b: (pathlib.Path(folder) / "out" / b / "probes.csv").read_text().splitlines()[1:] for b in bodies}


def tip(rows, column=1):
    return float(rows[-1].split(",")[column])


with tempfile.TemporaryDirectory() as first, tempfile.TemporaryDirectory() as second:
    whole = run(first)
    shutil.copytree(pathlib.Path(first) / "out/checkpoints", pathlib.Path(second) / "saved")
    after = run(second, "--restart", f"{second}/saved/step-{middle:08d}")
    for body in bodies:
        check(f"{body}: restart continues bit for bit", after[body] == whole[body][middle:] and len(whole[body]) == steps,
              f"{after[body]} {whole[body]}")
    if case == "two-flaps":
        # The front one feels the stream, the rear one, a tenth as heavy, the change of pressure behind it.
        check("both flaps move", min(abs(tip(whole[b])) for b in bodies) > 1e-5, str([tip(whole[b]) for b in bodies]))
    elif case == "hinged-leaflet":
        two = run(second, "-n", "fluid=2")
        check("the leaflet opens", tip(whole["leaflet"]) > 1e-6, str(tip(whole["leaflet"])))
        check("two ranks of the fluid give the same", abs(tip(two["leaflet"]) / tip(whole["leaflet"]) - 1) < 1e-6, f"{two} {whole}")
    else:
        cold = run(second, "--set", "participants.solid.material.expansion=0")
        # alpha dT / 2 of the mean over the thickness, for a height of 1 m: 1e-4 * 60 (1 - exp(-0.04/0.2)) / 2 = 5.4e-4 m
        growth = tip(whole["solid"], 2) - tip(cold["solid"], 2)
        check("the warm flap grows", 2e-4 < growth < 1.5e-3, f"{growth:.2e} m")
end()
