#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Files of HDF5 that somebody else made or spoiled, through plate_modal: --check finds them, the run refuses them with file, object,
what was found and what was expected, nothing crashes. Usage: run.py BIN"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

programs = pathlib.Path(sys.argv[1]).resolve()
failed = 0
MESHED = """simulation: {end-time: 0.004 s, time-step: 0.001 s, output: {folder: out}, checkpoint: {interval: 0.002 s}}
participants:
  p:
    program: plate_modal
    mesh: plate.msh
    material: {density: 7800 kg/m^3, youngs-modulus: 210 GPa, poissons-ratio: 0.3}
    thickness: 10 mm
    modes: {number: 4}
    gravity: [0, 0, -9.81]
    boundaries: {left: {type: clamped}, right: {type: clamped}, top: {type: free}, bottom: {type: free}}
"""
OF_FILE = """simulation: {end-time: 0.004 s, time-step: 0.001 s, output: {folder: out}, checkpoint: {interval: 0.002 s}}
participants:
  p:
    program: plate_modal
    modes: {file: modes.h5}
    gravity: [0, 0, -9.81]
"""


def plate_mesh(n=4):
    """A square of n x n quadrilaterals, gmsh 2.2."""
    points = [f"{1 + i + (n + 1) * j} {i / n} {j / n} 0" for j in range(n + 1) for i in range(n + 1)]
    at = lambda i, j: 1 + i + (n + 1) * j
    lines = [(1, at(0, j), at(0, j + 1)) for j in range(n)] + [(2, at(n, j), at(n, j + 1)) for j in range(n)]
    lines += [(3, at(i, n), at(i + 1, n)) for i in range(n)] + [(4, at(i, 0), at(i + 1, 0)) for i in range(n)]
    elements = [f"1 2 {k} {k} {a} {b}" for k, a, b in lines]
    elements += [f"3 2 5 1 {at(i, j)} {at(i + 1, j)} {at(i + 1, j + 1)} {at(i, j + 1)}" for j in range(n) for i in range(n)]
    names = '1 1 "left"\n1 2 "right"\n1 3 "top"\n1 4 "bottom"\n2 5 "plate"'
    numbered = "\n".join(f"{i} {e}" for i, e in enumerate(elements, 1))
    return (f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n{names}\n$EndPhysicalNames\n$Nodes\n{len(points)}\n" + "\n".join(points)
            + f"\n$EndNodes\n$Elements\n{len(elements)}\n{numbered}\n$EndElements\n")


def run(folder, *options):
    done = subprocess.run([programs / "plate_modal", "case.yaml", *map(str, options)], cwd=folder, capture_output=True, text=True, timeout=60)
    return done.returncode, done.stdout + done.stderr


def expect(claim, answer, codes, *words):
    global failed
    code, said = answer
    missing = [w for w in words if w not in said]
    good = code in codes and not missing
    failed += not good
    print(f"{'ok' if good else 'not ok'}  {claim}: code {code}{'' if good else f', missing {missing}: {said[-600:]}'}", flush=True)


def spoiled(folder, file, how, name, n):
    done = subprocess.run([programs / "tests/spoil_hdf5", folder / file, how, name, str(n)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"spoil_hdf5 {file} {how} {name}: {done.stderr}")


with tempfile.TemporaryDirectory() as top:
    top = pathlib.Path(top)
    made = top / "made"
    made.mkdir()
    (made / "case.yaml").write_text(MESHED)
    (made / "plate.msh").write_text(plate_mesh())
    expect("a plate of a mesh runs and writes modes and checkpoints", run(made), [0])
    last = max((made / "out/checkpoints").glob("step-*"))
    expect("--check with --restart of a sound checkpoint", run(made, "--check", "--restart", last), [0], "valid")

    def fresh(name):
        folder = top / name
        folder.mkdir()
        (folder / "case.yaml").write_text(OF_FILE)
        shutil.copy(made / "out/p/modes.h5", folder)
        return folder

    folder = fresh("sound")
    expect("--check of sound modes", run(folder, "--check"), [0], "valid")
    expect("a run on them", run(folder), [0])
    for how, name, n, words in (("attribute", "mass", 6, "contains 6 values (float64); expected one number"),
                                ("attribute", "mass", 2000, "contains 2000 values (float64); expected one number"),
                                ("attribute", "format", 3, "one fixed-length text"),
                                ("table", "frequency", 3, "the table 'shape/vertices' has 150 rows of 4 values; expected 150 of 3"),
                                ("external", "frequency", 1, "a link to another file"),
                                ("cut", "participation", 1, "it has no 'participation'")):
        folder = fresh(f"{how}-{name}-{n}")
        spoiled(folder, "modes.h5", how, name, n)
        expect(f"--check of modes.h5, {how} {name} {n}", run(folder, "--check"), [2], "modes.file", "modes.h5", words)
        expect(f"the run on modes.h5, {how} {name} {n}", run(folder), [2], "modes.h5", words)
    for how, name, n, words in (("attribute", "version", 6, "contains 6 values (float64); expected one number"),
                                ("attribute", "set", 500, "one fixed-length text"),
                                ("table", "arrays/state", 900, "values"),
                                ("table", "layout/state", 900, "the layout of 'state' is for 900 ranks"),
                                ("external", "arrays/state", 1, "a link to another file")):
        folder = top / f"restart-{how}-{name.replace('/', '-')}"
        shutil.copytree(made, folder)
        spoiled(folder, f"out/checkpoints/{last.name}/p.h5", how, name, n)
        restart = pathlib.Path("out/checkpoints") / last.name
        expect(f"--check --restart, {how} {name} with digests that fit", run(folder, "--check", "--restart", restart), [2], "p.h5", words)
        expect(f"the restart, {how} {name}", run(folder, "--restart", restart, "--set", "simulation.end-time=0.006"), [1, 2], "p.h5", words)
print(f"{failed} scenes failed" if failed else "all scenes as they should be")
sys.exit(1 if failed else 0)
