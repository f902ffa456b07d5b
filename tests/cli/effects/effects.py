#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What --explain says of the effects of a scene, and a run of those that it neglects.
Usage: effects.py PROJECT_ROOT BIN"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

root, programs = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()


def ask(program, *arguments):
    result = subprocess.run([str(programs / program), *map(str, arguments)], capture_output=True, text=True, timeout=60)
    assert result.returncode == 0, (program, arguments, result.stdout, result.stderr)
    return result.stdout


def effects(text):
    """name -> on, of the lines of --explain."""
    return {name: state == "on" for state, name in re.findall(r"^  (on|off) +([^:]+):", text, flags=re.M)}


flap, cantilever = root / "configs/perpendicular-flap/case.yaml", root / "configs/cantilever/case.yaml"

# The flap needs a mover and a coupler, and says so; the cantilever needs neither.
text = ask("fluid_solver", flap, "--explain")
assert effects(text)["mesh-motion"] and not effects(text)["turbulence-model"], text
assert re.search(rf"^whole case: +couplet run {re.escape(str(flap))}$", text, re.M), text
text = ask("solid_solver", cantilever, "--explain")
assert "couplet run" not in text and "mesh_mover" not in text, text

# The mesh's cells and size.
assert re.search(r"^mesh: +4096 cells, 1 x 1 m$", ask("fluid_solver", root / "configs/cavity/case.yaml", "--explain"), re.M)

# A key of the command line switches an effect on in what is explained.
assert not effects(ask("solid_solver", cantilever, "--explain"))["gravity"]
name = re.search(r"as '(\w+)'", text).group(1)
assert effects(ask("solid_solver", cantilever, "--explain", "--set", f"participants.{name}.gravity=[0, 0, -9.81]"))["gravity"]

# What a run leaves out is judged while it runs: a traction that grows for ten steps passes the limit of the linear theory
# in its midst, that is said once, with the time; --strict=effects makes it the
# run's failure, a small load does not.
def pulled(load, *more):
    with tempfile.TemporaryDirectory() as folder:
        sets = (f"simulation.output.folder={folder}", "simulation.end-time=10", "participants.solid.mesh-parameters={n_length: 10, n_side: 1}",
                f"participants.solid.boundaries.tip.value=['{load}*t', 0, 0]", *more)
        strict = [s for s in sets if s.startswith("--")]
        keys = [f"--set={s}" for s in sets if not s.startswith("--")]
        return subprocess.run([str(programs / "solid_solver"), str(cantilever), *keys, *strict], capture_output=True, text=True,
                              timeout=100)


large, small = "1e5", "1e3"  # of E = 1e7 Pa: 0.01 and 0.0001 a second
told = r"t = (\S+) s: geometric non-linearity neglected: max \|grad u\| ="
run = pulled(large)
assert run.returncode == 0, run.stdout + run.stderr
times = [float(t) for t in re.findall(told, run.stdout)]
assert len(times) == 1 and 1 < times[0] < 5, (times, run.stdout)
assert "yielding neglected:" not in run.stdout, run.stdout
run = pulled(large, "--strict")
assert run.returncode == 0, run.stdout + run.stderr  # an opinion on what is neglected
run = pulled(large, "--strict=effects")
assert run.returncode == 1 and "--strict: the result is questionable" in run.stdout + run.stderr, run.stdout + run.stderr
run = pulled(small, "--strict=effects")
assert run.returncode == 0 and not re.search(told, run.stdout), run.stdout + run.stderr
assert "geometric non-linearity neglected: max |grad u| =" in run.stdout, run.stdout

# Yielding is judged where the strength is known; the uniaxial stress at the end is 1e4 Pa, at the clamp some more.
for strength, code in (("30 kPa", 0), ("9 kPa", 1)):
    run = pulled(small, f"participants.solid.material.yield-strength={strength}", "--strict=effects")
    assert run.returncode == code and "yielding neglected: max equivalent stress" in run.stdout, run.stdout + run.stderr

# `effects: auto` decides what the case leaves open and says why; what the case says wins; without it nothing is decided.
automatic = ("--set", "simulation.effects=auto")
text = ask("solid_solver", cantilever, "--explain", *automatic, "--set", "participants.solid.analysis=")
assert "auto: analysis: static (no load varies in time)" in text and not effects(text)["inertia"], text
assert "auto: dimension: set by the case; auto would choose 3" in text, text
text = ask("solid_solver", cantilever, "--explain", *automatic, "--set", "participants.solid.analysis=dynamic")
assert "auto: analysis: set by the case; auto would choose static" in text and effects(text)["inertia"], text
assert "auto:" not in ask("solid_solver", cantilever, "--explain")
cavity = root / "configs/cavity/case.yaml"
text = ask("fluid_solver", cavity, "--explain", *automatic, "--set", "participants.fluid.dimension=")
assert "auto: dimension: 2 (the mesh has two-dimensional cells only)" in text and "auto: turbulence: none, laminar" in text, text
with tempfile.TemporaryDirectory() as folder:
    (pathlib.Path(folder) / ".petscrc").write_text("-options_view\n")
    out = subprocess.run([str(programs / "solid_solver"), str(cantilever), *automatic, "--set", "participants.solid.analysis=", "--set",
                          "participants.solid.dimension=", "--set", f"simulation.output.folder={folder}"], capture_output=True, text=True, timeout=100, cwd=folder)
    assert "Option Table" not in out.stdout, out.stdout  # of PETSc, which reads no file beside a case
    assert out.returncode == 0 and "auto: analysis: static" in out.stdout and "auto: dimension: 3" in out.stdout, out.stdout + out.stderr

print("effects: as expected")
