# SPDX-License-Identifier: Apache-2.0
"""Cases and results folders from elsewhere that try to start a program or a shell. Reading starts none: check, explain, docs, compare, plot, watch, stop and export, nor does
`resume` of such a folder. Each attack would leave a file; besides, every process that the command itself starts is recorded, and must be a program of Couplet.
Usage: hostile.py BIN"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests/support"))
from checks import check, failed  # noqa: E402

BIN, MESH = pathlib.Path(sys.argv[1]).resolve(), ROOT / "tests/mistakes/square.msh"
OURS = ("coupler", "fluid_solver", "solid_solver", "mesh_mover", "thermocline", "plate_modal")
CASE = (ROOT / "tests/mistakes/solid.yaml").read_text()
WATCHER = """import os, sys
def look(event, words, file=os.environ["COUPLET_STARTED"]):
    if event in ("subprocess.Popen", "os.system", "os.exec", "os.posix_spawn", "os.spawn"):
        with open(file, "a") as out:
            out.write(f"{words[0] if event != 'subprocess.Popen' else words[1][0]}\\n")
sys.addaudithook(look)
"""


def attacks(bad):
    """{name: (text of the case, files beside it, job.json or changes of it)}; `bad` is the command of a shell that leaves a file."""
    python = f"import os\nos.system('{bad}')\ndef curve(folder):\n    return {{'t': [0, 1]}}\n"
    script = (f"#!/bin/sh\n{bad}\n", 0o755)

    def program(name):
        return CASE.replace("program: solid_solver", f"program: {json.dumps(name)}")

    def plot(text):
        return CASE + f"plot: {{panels: [{{x: {{}}, y: {{}}, curves: [{text}]}}]}}\n"

    def mesh(name):
        return CASE.replace("square.msh", json.dumps(name))
    shells = {f"program {name}": (program(name), {"run.sh": script, "own": script, "other.py": (python, 0o644)}, {})
              for name in ("/bin/sh", "../../bin/sh", "sh", "bash", "python3", "./run.sh", "run.sh", "own", "other", "relay", f"solid_solver; {bad}", f"$({bad})", f"`{bad}`", "env", "gmsh", "-c")}
    return shells | {
        "a program of --set in the record": (CASE, {"own": script}, {"sets": ["participants.solid.program=own"]}),
        "a participant of --set in the record": (CASE, {"own": script}, {"sets": ["participants.solid={program: own}"]}),
        "a command in the record": (CASE, {}, {"with": {"solid": ["sh", "-c", bad]}}),
        "another folder of programs in the record": (CASE, {"bin/solid_solver": script}, {"bin": "bin", "build": "."}),
        "a case elsewhere in the record": (CASE, {"other/case.yaml": (program("own"), 0o644), "other/own": script}, {"case": "../other/case.yaml"}),
        "ranks in the record": (CASE, {"own": script}, {"ranks": {"solid": f"1 {bad}"}}),
        "a geo that was allowed to run commands": (mesh("a.geo"), {"a.geo": (f'SystemCall "{bad}";\n', 0o644)}, {"flags": ["--allow-commands"]}),
        "a geo": (mesh("a.geo"), {"a.geo": (f'SystemCall "{bad}";\nMerge "|{bad}";\n', 0o644), "a.geo.opt": (f'SystemCall "{bad}";\n', 0o644)}, {}),
        "a mesh that is a pipe": (mesh(f"|{bad}"), {}, {}),
        "a plot.py": (CASE, {"plot.py": (python, 0o644)}, {}),
        "a curve in Python": (plot("{python: 'own.py: curve', y: t}"), {"own.py": (python, 0o644)}, {}),
        "a quantity in Python": (CASE + "study: {participant: solid, quantities: {q: {python: 'own.py: curve', item: 0}}}\n", {"own.py": (python, 0o644)}, {}),
        "a tag of Python": (CASE + f"plot: !!python/object/apply:os.system ['{bad}']\n", {"out/solid/effective.yaml": (f"a: !!python/object/apply:os.system ['{bad}']\n", 0o644)}, {}),
        "modules beside the case": (CASE, {name: (python, 0o644) for name in ("yaml.py", "numpy.py", "h5py.py", "json.py", "couplet/__init__.py", "sitecustomize.py")}, {}),
        "settings beside the case": (CASE, {".petscrc": (f"-start_in_debugger noxterm,{bad}\n-options_monitor\n", 0o644), "matplotlibrc": ("text.usetex: true\nbackend: module://own\n", 0o644), "own.py": (python, 0o644)}, {}),
        "names of columns": (CASE, {"out/solid/probes.csv": (f"time [s],`{bad}` [m],$({bad}) [m],|{bad}\n0,1,2,3\n1,2,3,4\n", 0o644)}, {}),
        "a table that is a pipe": (CASE.replace("1 MPa", f"'table(t, \"|{bad}\")'"), {}, {}),
    }


def commands(folder):
    yield from (["check", "case.yaml", "--bin", BIN], ["explain", "case.yaml", "--bin", BIN], ["check", "case.yaml", "--bin", BIN, "--set", "participants.solid.material.density=1 kg/m^3"])
    yield from (["plot", "case.yaml"], ["plot", "out"], ["watch", "out", "--once"], ["stop", "out", "--within", "1"], ["compare", "out", "same"])
    yield from (["export", "case.yaml", "--to", "calculix", "--folder", "x"], ["study", "case.yaml", "--print"], ["resume", "out", "--bin", BIN])


def main():
    with tempfile.TemporaryDirectory(prefix="couplet-hostile-") as scratch:
        scratch = pathlib.Path(scratch)
        mark, started = scratch / "EXECUTED", scratch / "started"
        (scratch / "watcher").mkdir()
        (scratch / "watcher/sitecustomize.py").write_text(WATCHER)
        environment = {**os.environ, "COUPLET_STARTED": str(started), "PYTHONPATH": str(scratch / "watcher")}
        (scratch / "sound").mkdir()
        shutil.copy(MESH, scratch / "sound")
        (scratch / "sound/case.yaml").write_text(CASE.replace("time-step: 1 s}", "time-step: 1 s, checkpoint: {interval: 1 s}}"))
        ran = subprocess.run([ROOT / "scripts/couplet", "run", "case.yaml", "-q", "--bin", BIN], cwd=scratch / "sound", capture_output=True, text=True)
        if check("the sound case runs", ran.returncode == 0, ran.stderr):
            sys.exit(1)
        calls = 0
        all_attacks = attacks(f"touch {mark}")
        for name, (text, files, record) in all_attacks.items():
            folder = scratch / "case"
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(scratch / "sound", folder)
            shutil.copytree(folder / "out", folder / "same")
            (folder / "case.yaml").write_text(text)
            for file, (content, mode) in files.items():
                (folder / file).parent.mkdir(parents=True, exist_ok=True)
                (folder / file).write_text(content)
                (folder / file).chmod(mode)
            job = json.loads((folder / "out/job.json").read_text())
            (folder / "out/job.json").write_text(json.dumps(job | record))
            bad = []
            for words in commands(folder):
                started.write_text("")
                done = subprocess.run([ROOT / "scripts/couplet", *words], cwd=folder, env=environment, capture_output=True, text=True, timeout=120)
                calls += 1
                others = [line for line in started.read_text().splitlines() if pathlib.Path(line).parent != BIN or pathlib.Path(line).name not in OURS]
                if mark.exists() or others or "Traceback" in done.stderr:
                    bad.append((words[0], "executed" if mark.exists() else others or done.stderr[-300:]))
                mark.unlink(missing_ok=True)
            check(name, not bad, bad)
        built = subprocess.run([ROOT / "scripts/couplet", "docs", "--build", scratch / "site"], cwd=folder, env=environment, capture_output=True, text=True)
        check("docs, in a folder with modules", not mark.exists(), built.stderr[-300:])
        print(f"{len(all_attacks)} hostile cases and results folders, {calls + 1} commands: {len(failed)} started a program")
        sys.exit(1 if failed or len(all_attacks) < 30 else 0)


main()
