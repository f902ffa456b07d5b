#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""--check opens every file that a run would open: for each key that names one (scenes.py) a right file passes, and a missing, a
folder in its place and each broken one is found, with the key, the file and what is wrong. Checkpoints likewise. The keys are
compared with those that the programs declare, so that a new one cannot be forgotten.
Usage: run.py BIN [I/N]   (I/N: every N-th scene from the I-th on, and every N-th checkpoint)"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from scenes import MESH, SCENES, WRONG

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import share  # noqa: E402

BIN = pathlib.Path(sys.argv[1]).resolve()
ENVIRONMENT = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_rmaps_base_oversubscribe="1",
                   OMP_NUM_THREADS="1")
PROGRAMS = ("solid_solver", "fluid_solver", "mesh_mover", "plate_modal", "thermocline", "coupler")
RAN = (0, 4)  # 4: the scenes of four cells are no good answers, but they ran to their end
count = failed = 0


def scene_of(base):
    """A scene that runs: the coupled one with its solid on the fluid's side."""
    text = (WRONG / f"{base}.yaml").read_text()
    return text.replace("      bottom: {type: fixed-displacement, value: [0, 0]}\n      top: {type: interface}",
                        "      bottom: {type: interface}\n      top: {type: fixed-displacement, value: [0, 0]}")


def run(program, folder, *arguments):
    return subprocess.run([BIN / program, "case.yaml", *arguments], cwd=folder, env=ENVIRONMENT, capture_output=True, text=True,
                          errors="replace", timeout=60, check=False)


def expect(what, result, code, words=()):
    """Compares one answer of --check."""
    global count, failed
    count += 1
    missing = [w for w in words if w not in result.stderr]
    if result.returncode != code or missing:
        failed += 1
        print(f"not ok  {what}: exit code {result.returncode} instead of {code}; missing in its words: {missing}\n    {result.stderr.strip()[:600]}")


def put(path, content):
    if path.is_dir():
        path.rmdir()
    path.unlink(missing_ok=True)
    if content is not None:
        path.write_bytes(content)


def modes(folder):
    """A right file of modes: of the plate of plate.yaml."""
    made = folder / "made"
    made.mkdir()
    (made / "square.msh").write_bytes(MESH)
    (made / "case.yaml").write_text((WRONG / "plate.yaml").read_text().replace("    contact: {height: -1 cm}\n", ""))
    result = run("plate_modal", made)
    if result.returncode not in RAN:
        raise SystemExit(f"no modes: {result.stderr}")
    return (made / "out/plate/modes.h5").read_bytes()


def look_at(scene, folder):
    (folder / "square.msh").write_bytes(MESH)
    (folder / "case.yaml").write_text(scene.text())
    participant = scene.key.split(".")[1]
    arguments = ("--check", "--participant", participant)
    right, broken = scene.right, dict(scene.broken)
    if right is None:
        right = modes(folder)
        broken |= {"half of it": (right[:len(right) // 2], [""]), "no HDF5": (b"hello\n", [""]), "nothing": (b"", [""])}
    file = folder / scene.file
    name = f"{scene.program}, {scene.key}"
    put(file, right)
    expect(f"{name}: a right one", run(scene.program, folder, *arguments), 0)
    put(file, None)
    expect(f"{name}: none", run(scene.program, folder, *arguments), 2, [scene.key, scene.file])
    file.mkdir()
    expect(f"{name}: a folder", run(scene.program, folder, *arguments), 2, [scene.key, scene.file])
    for what, (content, words) in broken.items():
        put(file, content)
        expect(f"{name}: {what}", run(scene.program, folder, *arguments), 2, [scene.key, scene.file, *words])


def look_at_restart(folder, program, participant, base, job):
    """A checkpoint as a run leaves it, then one that lacks, or has changed, a file."""
    (folder / "square.msh").write_bytes(MESH)
    (folder / "case.yaml").write_text(scene_of(base))
    result = subprocess.run([str(part) for part in job], cwd=folder, env=ENVIRONMENT, capture_output=True, text=True, timeout=120, check=False)
    sets = sorted((folder / "out/checkpoints").glob("step-*"))
    if result.returncode not in RAN or not sets:
        raise SystemExit(f"no checkpoint of {base}: {result.stderr}")
    name = f"{program}, --restart"
    arguments = ("--check", *(("--participant", participant) if program != "coupler" else ()), "--restart")
    for place in (sets[-1], sets[-1].parent):
        expect(f"{name}: a right one", run(program, folder, *arguments, place), 0)
    expect(f"{name}: none", run(program, folder, *arguments, "nowhere"), 2, ["nowhere", "no complete checkpoint"])
    own = f"{participant}.h5"
    for file in (own, "keys.txt"):
        damaged = folder / f"damaged-{file}"
        shutil.copytree(sets[-1], damaged)
        content = bytearray((damaged / file).read_bytes())
        content[len(content) // 2] ^= 4
        (damaged / file).write_bytes(content)
        expect(f"{name}: a flipped bit in {file}", run(program, folder, *arguments, damaged), 2, [damaged.name, file])
        (damaged / file).unlink()
        expect(f"{name}: no {file}", run(program, folder, *arguments, damaged), 2, [damaged.name, file])
    text = (folder / "case.yaml").read_text()
    if program in ("coupler", "solid_solver"):
        (folder / "case.yaml").write_text(text.replace("youngs-modulus: 1 MPa", "youngs-modulus: 2 MPa"))
        expect(f"{name}: another case", run(program, folder, *arguments, sets[-1]), 2 if base != "coupled" or program == "coupler" else 0,
               ["youngs-modulus"])
        (folder / "case.yaml").write_text(text)


def look_at_runs(folder, together):
    """A file that --check has not been asked about ends the run itself, alone and coupled, with the line."""
    old, new = "right: {type: traction, value: [1000, 0]}", "right: {type: traction, value: [0, {of: t, file: p.csv, column: p}]}"
    (folder / "square.msh").write_bytes(MESH)
    runs = (("alone, --strict", "solid", (old, new), [BIN / "solid_solver", "case.yaml", "--strict"]),
                                  ("coupled", "coupled", ("      left: {type: free}\n      right: {type: free}\n",
                                                          "      left: {type: free}\n      " + new + "\n"), together),
                                  ("coupled, --strict", "coupled", ("      left: {type: free}\n      right: {type: free}\n",
                                                                    "      left: {type: free}\n      " + new + "\n"),
                                   [part + " --strict" if part == "case.yaml" else part for part in together]))
    for what, base, edit, job in share(runs, sys.argv[2:]):
        (folder / "case.yaml").write_text(scene_of(base).replace(*edit))
        job = " ".join(map(str, job)).split()
        for text, code, words in ((b"t;p\n0;1000.5\n2;3000.5\n", 0, []),
                                  (b"t;p\n0,0;1000,5\n1,5;2000,5\n2,5;3000,5\n", 2, ["p.csv:2: '0,0' has a decimal comma; write 0.0"])):
            (folder / "p.csv").write_bytes(text)
            shutil.rmtree(folder / "out", ignore_errors=True)
            result = subprocess.run(job, cwd=folder, env=ENVIRONMENT, capture_output=True, text=True, timeout=60, check=False)
            if code == 0 and (result.returncode in RAN or "--strict" in job and "p.csv" not in result.stderr):
                result.returncode = 0  # what --strict finds in four cells is not the table
            expect(f"a run {what}: {text[:20]!r}", result, code, words)


def look_at_keys():
    """Keys of texts that speak of a file: declared ones against those of the scenes."""
    for program in PROGRAMS:
        docs = subprocess.run([BIN / program, "--docs"], env=ENVIRONMENT, capture_output=True, text=True, check=True).stdout
        own = docs.split("\n## `simulation`")[0]
        rows = re.findall(r"^\| `([\w-]+)` \| (?:text|list of texts) \|(.*)$", own, flags=re.M)
        declared = {key for key, rest in rows if re.search(r"\bfiles?\b|csv|\.h5|modes written by", rest) or key in ("mesh", "file", "air", "path")}
        declared -= {"to", "from", "folder", "digest"}  # days of the weather's file; where a run writes; a number of a file
        tried = {scene.word for scene in SCENES if scene.program == program and scene.word}
        expect(f"{program}: keys of files are {sorted(declared)}, tried are {sorted(tried)}",
               subprocess.CompletedProcess([], 0 if declared == tried else 1, "", ""), 0)


def main():
    look_at_keys()
    global count, failed
    with tempfile.TemporaryDirectory(prefix="couplet-check-files-") as name:
        base = pathlib.Path(name).resolve()
        scenes = share(SCENES, sys.argv[2:])
        for number, scene in enumerate(scenes):
            folder = base / f"scene-{number}"
            folder.mkdir()
            look_at(scene, folder)
            shutil.rmtree(folder)
        together = ["mpirun", "--oversubscribe", *" : ".join(f"-n 1 {BIN / p} case.yaml" for p in ("coupler", "fluid_solver", "solid_solver", "mesh_mover")).split()]
        restarts = (("coupler", "coupler", "coupled", together), ("mesh_mover", "mover", "coupled", together),
                    *((program, participant, participant, [BIN / program, "case.yaml"]) for program, participant in (
                        ("solid_solver", "solid"), ("fluid_solver", "fluid"), ("plate_modal", "plate"), ("thermocline", "tank"))))
        for program, participant, scene, job in share(restarts, sys.argv[2:]):
            folder = base / f"restart-{program}"
            folder.mkdir()
            look_at_restart(folder, program, participant, scene, job)
        folder = base / "runs"
        folder.mkdir()
        files, files_failed, count, failed = count, failed, 0, 0
        look_at_runs(folder, together)
    print(f"{files} files, {files_failed} judged wrongly\n{count} runs, {failed} judged wrongly")
    sys.exit(1 if failed or files_failed or files * len(SCENES) < 200 * len(scenes) else 0)


main()
