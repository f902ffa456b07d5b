# SPDX-License-Identifier: Apache-2.0
"""Surfaces that should move together, in real cases: of another size, held by the mesh mover, held by the structure; and the
start of every shipped coupled case, which has none of it. Usage: walls.py BIN CONFIGS flap | shipped | timeout"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import yaml

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import check, end  # noqa: E402

binaries, configs = (pathlib.Path(p).resolve() for p in sys.argv[1:3])
root = configs.parent
PATIENCE = 600  # [s] with one job
FINDINGS = ("the coupled surfaces do not match", "mesh motion: '", "0 m at every interface vertex", "would not follow")
COARSE = ["participants.fluid.mesh-parameters={n_side: 10, n_tip: 1, growth: 1.5, wall_growth: 1.5, wall_cells: 3}",
          "participants.mover.mesh-parameters={n_side: 10, n_tip: 1, growth: 1.5, wall_growth: 1.5, wall_cells: 3}",
          "participants.solid.mesh-parameters={n_side: 20, n_tip: 2}", "simulation.end-time=0.12 s", "simulation.output.interval=1 s"]
# Programs of somebody else, as the cases' own launchers start them.
GUESTS = {"heater": ["/usr/bin/python3", configs / "warm-flap/heater.py", "heater"],
          "spring_cylinder_py": ["/usr/bin/python3", root / "client/examples/spring_cylinder.py", "body", "2", "0", "4", "0.01"],
          "tube_fluid": None}


def run(words, folder):
    environment = dict(os.environ, PYTHONPATH=str(root / "client/python"))
    try:
        done = subprocess.run(list(map(str, words)), cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=PATIENCE, env=environment)
        return done.returncode, done.stdout
    except subprocess.TimeoutExpired as late:
        return None, (late.stdout or b"").decode() + f"\n(still running after {PATIENCE} s)"


def couple(folder, file, sets):
    """Launches a coupled case; None if it needs a program that is not at hand."""
    participants = yaml.safe_load((folder / file).read_text())["participants"]
    options = [word for s in sets for word in ("--set", s)]
    words = ["mpirun", "--oversubscribe", "-n", "1", binaries / "coupler", file, *options]
    for name, keys in participants.items():
        program = keys["program"]
        words += [":", "-n", "1"]
        if program in GUESTS:
            if GUESTS[program] is None or subprocess.run(["/usr/bin/python3", "-c", "import mpi4py"], capture_output=True).returncode != 0:
                return None, ""
            words += GUESTS[program]
        else:
            words += [binaries / program, file, "--participant", name, *options]
    return run(words, folder)


def copy(case, folder):
    for file in (configs / case).iterdir():
        if file.is_file() and file.suffix in (".yaml", ".geo", ".msh", ".csv", ".h5", ".py"):
            shutil.copy(file, folder)


def flap(folder):
    copy("perpendicular-flap", folder)
    code, output = couple(folder, "case.yaml", COARSE)
    check("the case as it is: no finding", code == 0 and not any(f in output for f in FINDINGS), output[-2000:])
    code, output = couple(folder, "case.yaml", [*COARSE, "participants.solid.mesh-scale=1.05"])
    check("a solid 5 % larger: its faces do not nest, which the case's map refuses", code == 2 and "do not nest" in output, output[-2000:])
    code, output = couple(folder, "case.yaml", [*COARSE, "participants.solid.mesh-scale=1.05", "coupling.mapping.type=projection"])
    check("a solid 5 % larger: flagged with the number", "the coupled surfaces do not match, so parts of one surface have no partner on the other: area 2.205 m^2 ('solid') and 2.1 m^2 "
          "('fluid'), which differ by 4.8 %" in output, output[-2000:])
    held = "participants.mover.boundaries.flap.type=fixed"
    code, output = run([binaries / "coupler", "case.yaml", "--check", "--set", held], folder)
    check("the mover's patch fixed: refused by --check", code == 2 and "holds the wall 'flap' fixed by `type: fixed`" in output, output)
    code, output = couple(folder, "case.yaml", [*COARSE, held])
    check("... and at the roll call", code == 2 and "holds the wall 'flap' fixed by `type: fixed`" in output and "step 1" not in output, output)


def shipped(folder):
    """One step of each case; a participant of somebody else is started as the case's launcher does it."""
    cases = sorted(p for p in [*configs.glob("*/*.yaml"), *(root / "tests/coupling").glob("piston/case.yaml")] if "\ncoupling:" in p.read_text())
    started = 0
    for file in cases:
        here = folder / f"{file.parent.name}-{file.stem}" / file.parent.name
        # Its own files, and those of the cases beside it whose meshes it takes.
        for source in [file.parent, *(file.parents[1] / name for name in set(re.findall(r"\.\./([\w-]+)/", file.read_text())))]:
            if not source.is_dir():  # the results of another case, which a plot shows
                continue
            (here.parent / source.name).mkdir(parents=True, exist_ok=True)
            for other in source.iterdir():
                if other.is_file() and other.stat().st_size < 5e7:
                    shutil.copy(other, here.parent / source.name)
        dt = yaml.safe_load(file.read_text())["simulation"]["time-step"]
        code, output = couple(here, file.name, [f"simulation.end-time={dt}", "simulation.checkpoint.interval=0 s"])
        name = f"{file.parent.name}/{file.name}"
        if code is None and not output:
            print(f"skipped  {name}: needs a program that only its own launcher starts, or mpi4py")
            continue
        if "modes.h5' does not exist" in output:
            print(f"skipped  {name}: needs the modes that another run leaves")
            continue
        found = re.findall("|".join(map(re.escape, FINDINGS)), output)
        check(f"{name}: starts, no finding", code == 0 and not found, f"code {code}, {found}\n{output[-2500:]}")
        started += 1
    check("at least ten cases were started", started >= 10, str(started))


def timeout(folder):
    copy("perpendicular-flap", folder)
    code, output = run([binaries / "coupler", "case.yaml", "--print-config"], folder)
    found = re.search(r"hang-timeout: ([\d.]+)", output)
    check("hang-timeout is 600 s where a case does not give it", code == 0 and found and float(found[1]) == 600, output[:800])


with tempfile.TemporaryDirectory(prefix="couplet-walls-") as scratch:
    {"flap": flap, "shipped": shipped, "timeout": timeout}[sys.argv[3]](pathlib.Path(scratch).resolve())
end()
