#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A step that fails names its cause: where the coupling is unstable, the mesh that folds is what follows from it. Seven runs of a soft
leaflet in water, and their neighbours: the same leaflet by the default scheme, and a motion that is too large for the mesh although
the coupling is stable. Usage: run.py BIN MPIRUN... -- [quick | all]"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import COUPLED, check, end, mpmd  # noqa: E402

programs = pathlib.Path(sys.argv[1]).resolve()
mpirun, what = sys.argv[2:sys.argv.index("--")], sys.argv[-1]
here = pathlib.Path(__file__).resolve().parent


def run(*sets):
    """Exit code, and the error in which the coupler gives the run up."""
    with tempfile.TemporaryDirectory() as folder:
        for name in ("case.yaml", "fluid.geo", "solid.geo"):
            shutil.copy(here / name, folder)
        line = mpmd([[programs / program, "case.yaml", *(f"--set={s}" for s in sets)] for program in COUPLED], mpirun=mpirun)
        done = subprocess.run(line, cwd=folder, capture_output=True, text=True, timeout=200)
        errors = [e for e in (done.stdout + done.stderr).splitlines() if "[coupler 0] error: " in e]
        return done.returncode, errors[-1].split("error: ", 1)[1] if errors else ""


def explicit(n):
    meshes = [f"participants.{p}.mesh-parameters.n={k * n}" for p, k in (("fluid", 1), ("mover", 1), ("solid", 2))]
    return ["coupling.scheme=explicit", f"simulation.time-step={0.02 / n}", *meshes]


def relaxed(scheme):
    return [f"coupling.scheme={scheme}", "coupling.acceleration.type=constant", "coupling.acceleration.initial-relaxation=1"]


cases = {f"explicit, mesh {n}": (explicit(n), "the added-mass instability of explicit coupling: ", "scheme: semi-implicit") for n in ((2,) if what == "quick" else (1, 2, 3, 4, 5))}
cases |= {f"{scheme}, relaxation 1": (relaxed(scheme), "the coupling diverges: the residual grew 6.", "iqn-ils") for scheme in ("implicit", "semi-implicit")}
for name, (sets, cause, cure) in cases.items():
    code, said = run(*sets)
    check(f"{name}: the coupling is named first", code == 1 and said.split(" = ")[0].startswith("The run ends at t") and cause in said.split("Thereupon")[0], said[:200])
    check(f"{name}: with its cure, and no other advice", cure in said and "Try a smaller step" not in said, said[-200:])

code, said = run("coupling.scheme=auto", "simulation.end-time=0.05")
check("the default scheme runs", code == 0 and not said, said[:200])
# A heavy leaflet in a gas, which its weight lays flat: one pass a step is enough, the mesh is not.
code, said = run("coupling.scheme=explicit", "participants.fluid.density=1", "participants.solid.gravity=[2000, 0]", "participants.mover.method=laplacian")
check("a motion that is too large for the mesh: the mesh is named, and the coupling is not", code == 1 and "instability" not in said and "mesh motion" in said, said[:200])
end()
