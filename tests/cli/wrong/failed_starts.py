# SPDX-License-Identifier: Apache-2.0
"""A start that fails over the results of an earlier run leaves every file of them as it was, byte for byte.
Usage: failed_starts.py BIN COUPLET"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "support"))
from checks import check, end, mpmd, require  # noqa: E402

bin_, couplet = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
PROGRAMS = {"solid": ["solid_solver"], "plate": ["plate_modal"], "tank": ["thermocline"], "fluid": ["fluid_solver"],
            "coupled": ["coupler", "fluid_solver", "solid_solver", "mesh_mover"]}
WAYS = [  # base case, what goes wrong, words of all programs, environment or None
    ("solid", "a negative modulus", ["--set=participants.solid.material.youngs-modulus=-1 MPa"], {}),
    ("solid", "an unknown key", ["--set=participants.solid.material.young=1 MPa"], {}),
    ("solid", "a mesh that is not there", ["--set=participants.solid.mesh=none.msh"], {}),
    ("solid", "a patch that is not in the mesh", ["--set=participants.solid.boundaries.lid={type: free}"], {}),
    ("solid", "a probe outside the body", ["--set=participants.solid.probes={far: {point: [9, 9]}}"], {}),
    ("solid", "a surface that is not in the mesh", ["--set=participants.solid.output.surfaces=[lid]"], {}),
    ("solid", "no checkpoint", ["--restart", "none"], {}),
    ("solid", "an end before the checkpoint", ["--restart", "out/checkpoints", "--set=simulation.end-time=0.5 s"], {}),
    ("solid", "a restart with another modulus", ["--restart", "out/checkpoints", "--set=participants.solid.material.youngs-modulus=2 MPa", "--set=simulation.end-time=2 s"], {}),
    ("solid", "a program that dies while it starts", ["--set=participants.solid.material.youngs-modulus=2 MPa"], {"COUPLET_FAULT": "solid:initialise:1"}),
    ("plate", "a probe off the surface", ["--set=participants.plate.probes={far: {point: [9, 9, 9]}}"], {}),
    ("plate", "more amplitudes than modes", ["--set=participants.plate.modes={number: 2}", "--set=participants.plate.initial-amplitudes=[0, 0, 1]"], {}),
    ("tank", "weather that is not there", ["--set=participants.tank.ambient={file: none.csv}"], {}),
    ("fluid", "a negative viscosity", ["--set=participants.fluid.viscosity=-1 Pa s"], {}),
    ("coupled", "a solid with a mesh that is not there", ["--set=participants.solid.mesh=none.msh"], {}),
    ("coupled", "a fluid without an interface", ["--set=participants.fluid.boundaries.bottom={type: slip}"], {}),
    ("coupled", "a solid without an interface", ["--set=participants.solid.boundaries.bottom={type: free}"], {}),
    ("coupled", "a mesh that does not follow the interface", ["--set=participants.mover.boundaries.bottom={type: fixed}"], {}),
    ("coupled", "a solid that dies while it starts", ["--set=participants.solid.material.density=5 kg/m^3"], {"COUPLET_FAULT": "solid:initialise:1"}),
    ("coupled", "a restart of the coupler with another end", ["--restart", "out/checkpoints", "--set=simulation.end-time=0.5 s"], {}),
    ("coupled", "a launch line without the mover", None, {}),
    ("coupled", "couplet run with a wrong value", ["couplet", "--set=participants.fluid.density=-1 kg/m^3"], {}),
]


def line(base, words):
    programs = PROGRAMS[base]
    if words is None:
        programs, words = programs[:-1], []
    if words[:1] == ["couplet"]:
        return [str(couplet), "run", "case.yaml", *words[1:]]
    return [str(bin_ / programs[0]), "case.yaml", *words] if len(programs) == 1 else mpmd([(bin_ / p, "case.yaml", *words) for p in programs])


def content(folder):
    return {str(file.relative_to(folder)): file.read_bytes() for file in sorted(folder.rglob("*")) if file.is_file()}


with tempfile.TemporaryDirectory(prefix="couplet-failed-starts-") as scratch:
    for base in PROGRAMS:
        folder = pathlib.Path(scratch) / base
        folder.mkdir()
        shutil.copy(HERE / "square.msh", folder)
        text = (HERE / f"{base}.yaml").read_text()  # the solid meets the fluid at its bottom
        text = text.replace("bottom: {type: fixed-displacement, value: [0, 0]}", "top: {type: fixed-displacement, value: [0, 0]}").replace("top: {type: interface}", "bottom: {type: interface}") if base == "coupled" else text
        (folder / "case.yaml").write_text(text)
        first = ["couplet"] if base == "coupled" else []
        done = subprocess.run(line(base, first), cwd=folder, capture_output=True, text=True, timeout=120)
        require(f"{base} runs", done.returncode in (0, 4), done.stderr[-2000:] if done.returncode not in (0, 4) else "")
        good = content(folder)
        for _, what, words, more in (way for way in WAYS if way[0] == base):
            done = subprocess.run(line(base, words), cwd=folder, capture_output=True, text=True, timeout=120, env={**os.environ, **more})
            now = content(folder)
            differ = sorted(name for name in good.keys() | now.keys() if good.get(name) != now.get(name))
            check(f"{base}, {what}: ends with an error and leaves all {len(good)} files", done.returncode not in (0, 3, 4) and not differ, f"{done.returncode} {differ} {done.stderr[-600:] if done.returncode in (0, 4) else ''}")
end()
