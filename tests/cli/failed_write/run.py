# SPDX-License-Identifier: Apache-2.0
"""One write fails, each in turn: the run ends at once with an error, no checkpoint is complete that is not, and a restart goes on from the last good one to what
the whole run gives; also after the end of a field file was lost. Usage: run.py BIN PRELOAD STRIDE"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "support"))
from checks import check, end  # noqa: E402

bin_, preload, stride = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve(), int(sys.argv[3])
CASE = """
simulation: {end-time: 0.2 s, time-step: 0.01 s, accept: [error-estimate, strain-energy], output: {folder: out, interval: 0.05 s}, checkpoint: {interval: 0.05 s}}
participants:
  solid:
    program: solid_solver
    mesh: square.msh
    dimension: 2
    plane: stress
    material: {density: 7800 kg/m^3, youngs-modulus: 210 GPa, poissons-ratio: 0.3}
    boundaries: {left: {type: fixed-displacement, value: [0, 0]}, right: {type: traction, value: [0, "-1e5*sin(30*t)"]}, bottom: {type: free}, top: {type: free}}
    output: {surfaces: [top]}
    probes: {tip: {point: [1, 0.5]}}
"""


def run(folder, *words, **environment):
    return subprocess.run([bin_ / "solid_solver", "case.yaml", "-q", *words], cwd=folder, capture_output=True, text=True, env={**os.environ, **environment})


def probes(folder):
    return (folder / "out/solid/probes.csv").read_text()


with tempfile.TemporaryDirectory(prefix="couplet-failed-write-") as scratch:
    folder = pathlib.Path(scratch)
    shutil.copy(HERE.parent / "wrong/square.msh", folder)
    (folder / "case.yaml").write_text(CASE)
    check("nothing fails", run(folder).returncode == 0)
    whole, k, failed, bad = probes(folder), 1, 0, []
    (folder / "out").rename(folder / "whole")
    while True:
        shutil.rmtree(folder / "out", ignore_errors=True)
        done = run(folder, LD_PRELOAD=str(preload), COUPLET_FAIL=str(k))
        if "this write fails" not in done.stderr:
            break
        failed += 1
        if done.returncode not in (1, 2) or "rror" not in done.stderr:
            bad.append((k, "goes on or crashes", done.returncode, done.stderr[-300:]))
        sets = list((folder / "out/checkpoints").glob("step-*/set.txt"))
        again = run(folder, *(("--restart", "out/checkpoints") if sets else ()))
        if again.returncode != 0 or probes(folder) != whole:
            bad.append((k, f"does not go on from {len(sets)} checkpoints", again.returncode, done.stderr[-200:], again.stderr[-300:]))
        k += stride
    check(f"{failed} failed writes: each ends the run, which goes on from its last good checkpoint", failed > 60 / stride and not bad, "\n".join(map(str, bad)))
    for lost in (1, 4096, 10**9):
        shutil.rmtree(folder / "out", ignore_errors=True)
        run(folder, "--set", "simulation.end-time=0.1 s")
        file = folder / "out/solid/solid.h5"
        os.truncate(file, max(0, file.stat().st_size - lost))
        again = run(folder, "--restart", "out/checkpoints")
        check(f"the last {lost} bytes of a field file are lost: it is set aside", again.returncode == 0 and probes(folder) == whole and (file.parent / "solid.h5.aside").exists(), again.stderr)
end()
