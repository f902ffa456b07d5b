#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A program that is stopped while gmsh meshes leaves no folder behind, and ends by the signal.  Usage: stop_meshing.py BIN"""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import check, end  # noqa: E402

SOLVER = pathlib.Path(sys.argv[1]).resolve() / "fluid_solver"
CASE = """simulation: {end-time: 1 s, time-step: 1 s}
participants:
  water: {program: fluid_solver, mesh: box.geo, dimension: 3, density: 1000, viscosity: 1e-3, boundaries: {}}
"""
ENDLESS = 'SetFactory("OpenCASCADE");\nBox(1) = {0, 0, 0, 1, 1, 1};\nMeshSize {:} = 0.002;\nPhysical Volume("water") = {1};\n'

with tempfile.TemporaryDirectory(prefix="couplet-stop-meshing-") as name:
    top = pathlib.Path(name)
    (top / "case.yaml").write_text(CASE)
    (top / "box.geo").write_text(ENDLESS)
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        own = top / number.name
        own.mkdir()
        surroundings = {**os.environ, "TMPDIR": str(own), "XDG_CACHE_HOME": str(top)}
        # Another program may have left the signal ignored.
        job = subprocess.Popen([SOLVER, "case.yaml"], cwd=top, env=surroundings, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                               text=True, preexec_fn=lambda: signal.signal(number, signal.SIG_DFL))  # pylint: disable=cell-var-from-loop
        limit = time.monotonic() + 60
        while not list(own.glob("couplet-gmsh-*/gmsh.log")) and job.poll() is None and time.monotonic() < limit:
            time.sleep(0.02)
        started = bool(list(own.glob("couplet-gmsh-*")))
        job.send_signal(number)
        said = job.communicate(timeout=60)[0]
        check(f"{number.name} while gmsh meshes: nothing is left", started and job.returncode != 0 and not list(own.glob("couplet-gmsh-*")),
              (started, job.returncode, list(own.iterdir()), said[-500:]))
end()
