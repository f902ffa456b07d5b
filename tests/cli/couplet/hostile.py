# SPDX-License-Identifier: Apache-2.0
"""Cases and results folders from elsewhere, and damaged ones.
programs  try to start a program or a shell. Reading starts none: check, explain, docs, compare, plot, watch, stop and export, nor does `resume` of such a folder. Each attack would
          leave a file; besides, every process that the command itself starts is recorded, and must be a program of Couplet.
links     in the place of each file and folder that a command writes lead to files and folders of the user, which stay as they are.
names     of cases, participants, patches and probes that would become lines of scripts, entries of dictionaries, or paths.
damage    of each file of the newest checkpoint and of the results: `resume` gives the results of a run that nobody disturbed, or says why not.
faults    a short selection.
Usage: hostile.py BIN [PART ...]"""
import contextlib
import io
import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import threading

from scene import ROOT, call_here
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


def programs():
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
        check("no attack was forgotten", len(all_attacks) >= 30)


# -- links, names, damage ----------------------------------------------------------------------------------------------
MOVING = CASE.replace("    analysis: static\n", "").replace("end-time: 1 s, time-step: 1 s", "end-time: 4 ms, time-step: 1 ms, checkpoint: {interval: 1 ms}, diagnostics: without-errors").replace("probes:", "output: {surfaces: [top]}\n    probes:")
PLOT = "plot: {panels: [{field: displacement}]}\n"
STUDY = "study: {participant: solid, axes: {n: {key: simulation.time-step, values: [1 ms, 2 ms]}}, quantities: {q: {monitor: solid/probes.csv, column: 'corner x [m]'}}}\n"
FLOW = """simulation: {end-time: 1 s, time-step: 1 s}
participants:
  air: {program: fluid_solver, mesh: square.msh, dimension: 2, density: 1 kg/m^3, viscosity: 1 Pa s,
    boundaries: {left: {type: inlet, velocity: ['0.1*t', 0]}, right: {type: outlet, pressure: 0}, top: {type: no-slip}, bottom: {type: no-slip}}}
"""
XML = """<precice-configuration><data:vector name="D"/><mesh name="M" dimensions="3"><use-data name="D"/></mesh><mesh name="N" dimensions="3"><use-data name="D"/></mesh>
<participant name="One"><provide-mesh name="M"/><write-data name="D" mesh="M"/></participant><participant name="Two"><provide-mesh name="N"/><receive-mesh name="M" from="One"/><read-data name="D" mesh="N"/>
<mapping:nearest-neighbor direction="read" from="M" to="N" constraint="consistent"/></participant><m2n:sockets acceptor="One" connector="Two"/>
<coupling-scheme:serial-explicit><participants first="One" second="Two"/><max-time-windows value="2"/><time-window-size value="1"/><exchange data="D" mesh="M" from="One" to="Two"/></coupling-scheme:serial-explicit>
</precice-configuration>"""
DECK = """*NODE\n1,0,0\n2,1,0\n3,1,1\n4,0,1\n*ELEMENT,TYPE=CPS4,ELSET=all\n1,1,2,3,4\n*NSET,NSET=root\n1,4\n*MATERIAL,NAME=m\n*ELASTIC\n1e9,.3
*SOLID SECTION,ELSET=all,MATERIAL=m\n*BOUNDARY\nroot,1,2\n*STEP\n*STATIC\n*DLOAD\n1,P2,1e3\n*END STEP\n"""
MOST = 25  # places of links for each command
WRITERS = (("plot", "case.yaml"), ("plot", "out"), ("plot", "out/solid/probes.csv"), ("plot", "out", "--field", "displacement"), ("plot", "out", "--field", "displacement", "--surface", "top"),
           ("plot", "case.yaml", "--film"), ("export", "out", "--to", "vtk"), ("export", "static.yaml", "--to", "calculix"), ("export", "static.yaml", "--to", "openfoam"),
           ("export", "flow.yaml", "--to", "openfoam"), ("import", "p.xml"), ("import", "d.inp"), ("weather", "w.csv"), ("weather", "w.csv", "-o", "x.csv.gz"), ("new", "mine"),
           ("run", "case.yaml", "-q", "--picture"), ("resume", "out", "--set", "simulation.end-time=6 ms"), ("study", "study.yaml"), ("mesh", "cut", "case.yaml"))


def couplet(folder, *words):
    """Runs a command in a folder. Those that start a job or draw many pictures do so in a process of their own."""
    if words[0] in ("run", "resume", "study"):
        return subprocess.run([ROOT / "scripts/couplet", *words], cwd=folder, env={**os.environ, "COUPLET_BIN": str(BIN)}, capture_output=True, text=True, timeout=120)
    with contextlib.chdir(folder):
        return call_here(BIN, *words)


def tree(folder):
    """{relative name: content} of all below a folder; the content of folders is None."""
    return {str(f.relative_to(folder)): None if f.is_dir() and not f.is_symlink() else os.readlink(f).encode() if f.is_symlink() else f.read_bytes() for f in sorted(folder.rglob("*"))}


class Scene:
    """A folder of a case that was run; `fresh` copies it beside a folder of the user."""

    def __init__(self, scratch):
        self.scratch, self.sound = scratch, scratch / "sound"
        self.sound.mkdir()
        shutil.copy(MESH, self.sound)
        hours = "\n".join(f"{h},500,20,3,50,100000" for h in range(8760))
        for name, text in {"case.yaml": MOVING + PLOT, "static.yaml": CASE, "flow.yaml": FLOW, "study.yaml": MOVING + STUDY, "p.xml": XML, "d.inp": DECK, "w.csv": f"hour,dni,t2m,ws10m,rh,sp [Pa]\n{hours}\n"}.items():
            (self.sound / name).write_text(text)
        done = couplet(self.sound, "run", "case.yaml", "-q")
        assert done.returncode == 0, done.stderr
        self.trials = 0

    def fresh(self, folder="case"):
        self.trials += 1
        for name in (folder, "home"):
            shutil.rmtree(self.scratch / name, ignore_errors=True)
        shutil.copytree(self.sound, self.scratch / folder, symlinks=True)
        (self.scratch / "home/folder").mkdir(parents=True)
        (self.scratch / "home/victim.txt").write_text("PRECIOUS")
        return self.scratch / folder

    def linked(self, words, name, target):
        """What a command does to the folder of the user if the place of a file or folder that it writes is a link there. Empty if nothing."""
        folder = self.fresh()
        place = folder / name
        if words[0] == "run":
            shutil.rmtree(folder / "out")
        if place.is_dir():  # of results that are there
            shutil.copytree(place, self.scratch / "home/folder", dirs_exist_ok=True)
            shutil.rmtree(place)
        home = tree(self.scratch / "home")
        place.parent.mkdir(parents=True, exist_ok=True)
        place.unlink(missing_ok=True)
        place.symlink_to(self.scratch / "home" / target)
        done = couplet(folder, *words)
        good = tree(self.scratch / "home") == home and "Traceback" not in done.stderr + done.stdout
        return [] if good else [(name, target, done.stderr[-200:])]

    def links(self):
        for words in WRITERS:
            folder = self.fresh()
            if words[0] == "run":
                shutil.rmtree(folder / "out")
            before = tree(folder)
            done = couplet(folder, *words)
            written = {name: content for name, content in tree(folder).items() if before.get(name, b"") != content and not re.search(r"(^|/)\.\w*lock$|\.part$", name)}
            if check(f"{' '.join(words)}: ends well", done.returncode == 0 and written, done.stderr[-300:]):
                continue
            bad, names = [], sorted(set(written) - {"out"})  # which may be a link (docs/formats.md)
            for name in names[::1 + len(names) // MOST]:
                for target in ["folder"] if written[name] is None else ["victim.txt", ".bash_login"]:
                    bad += self.linked(words, name, target)
            check(f"{' '.join(words)}: {len(names)} files and folders", not bad, bad)

    def names(self):
        odd = ["x\ntouch PWNED\n", "x\ttab", "\x1b[31m", "x\u009b31m", "../../up", "/tmp/up", "a/b", "..", ".", "-rf", "$(touch PWNED)", "`touch PWNED`", "a;}b{", "#include", "$x", "a b", "a,b", 'a"b', "x" * 300]
        where = {"simulation.name": lambda n: CASE.replace("{end-time", f"{{name: {n}, end-time", 1), "participant": lambda n: CASE.replace("  solid:", f"  {n}:", 1),
                 "probe": lambda n: CASE.replace("corner:", f"{n}:"), "patch": lambda n: CASE.replace("      top:", f"      {n}:"), "output folder": lambda n: CASE.replace("time-step: 1 s", f"time-step: 1 s, output: {{folder: {n}}}"),
                 "picture": lambda n: CASE + PLOT.replace("panels", f"file: {n}, panels"), "mesh": lambda n: CASE.replace("square.msh", n)}
        for key, made in where.items():
            bad = []
            for name in odd:
                folder = self.fresh()
                text = json.dumps(name)
                (folder / "case.yaml").write_text(made(text))
                if key == "patch":  # whose mesh has it, too
                    (folder / "square.msh").write_text((folder / "square.msh").read_text().replace('"top"', f'"{name}"'))
                outside = {n: c for n, c in tree(self.scratch).items() if not n.startswith("case/")}
                commands = [("check", "case.yaml"), ("run", "case.yaml", "--slurm=--time=1", "--print"), ("run", "case.yaml", "-q"), ("plot", "case.yaml"), ("export", "case.yaml", "--to", "openfoam")]
                done = {words: couplet(folder, *words) for words in commands}
                script = done[commands[1]]
                lines = script.stdout.splitlines()
                harmless = script.returncode == 2 or all(line.startswith("#") for line in lines[:-1]) and lines[-1].startswith("exec ")
                foam = "".join(f.read_text() for f in (folder / "openfoam").rglob("*") if f.is_file())
                left = {n for n, c in tree(self.scratch).items() if not n.startswith("case/") and outside.get(n, b"") != c} if key != "output folder" else set()
                controls = [words[0] for words, one in done.items() if re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f]", one.stdout + one.stderr)]
                plain = re.fullmatch(r"[\w.-]+", name)
                if not harmless or left or controls or list(folder.rglob("PWNED")) or foam and key == "patch" and not plain or any("Traceback" in one.stderr + one.stdout for one in done.values()) or (
                        any(c in name for c in "\n\t\x1b\x9b") and done[commands[0]].returncode != 2):
                    bad.append((name, harmless, left, controls, [(words[0], one.returncode, one.stderr[-200:]) for words, one in done.items()]))
            check(f"names: {key}", not bad, bad)

    def damage(self):
        from couplet.runs.progress import Progress
        ways = {"a bit": flipped, "another bit": lambda data: flipped(data, 0.9), "cut": lambda data: data[:len(data) // 2], "empty": lambda data: b"", "lost": None}
        result = (self.sound / "out/solid/probes.csv").read_bytes()
        newest = sorted((self.sound / "out/checkpoints").glob("step-*"))[-1].relative_to(self.sound)
        files = sorted(str(f.relative_to(self.sound)) for f in (self.sound / "out").rglob("*") if f.is_file() and f.stat().st_size > 0)
        for name in files:
            bad = []
            for way, change in ways.items():
                folder = self.fresh()
                data = (folder / name).read_bytes()
                (folder / name).unlink()
                if change:
                    (folder / name).write_bytes(change(data))
                around = [couplet(folder, *words) for words in (("report", "out"), ("watch", "out", "--once"), ("compare", "out", "out"), ("plot", "out"))]
                Progress(folder / "out").state()
                done = couplet(folder, "resume", "out")
                said = done.stdout + done.stderr
                whole = (folder / "out/solid/probes.csv").read_bytes() if (folder / "out/solid/probes.csv").exists() else b""
                fine = done.returncode == 0 and whole == result or done.returncode in (1, 2) or name == "out/solid/probes.csv" and ("warning" in said or change)
                if name.startswith(str(newest)) and ("bit" in way or not name.endswith("set.txt")):
                    fine = done.returncode == 0 and whole == result and ("is damaged" in said or "is missing" in said)
                if not fine or any("Traceback" in one.stdout + one.stderr for one in (*around, done)):
                    bad.append((way, done.returncode, said[-300:], *(one.stderr[-200:] for one in around if "Traceback" in one.stderr)))
            check(f"damage: {name}", not bad, bad)

    def faults(self):
        for words, name, target in ((("plot", "case.yaml"), "out/case.png", "victim.txt"), (("export", "out", "--to", "vtk"), "out/solid/vtk", "folder"),
                                    (("export", "static.yaml", "--to", "calculix"), "calculix", "folder"), (("import", "p.xml"), "p.yaml", ".bash_login"),
                                    (("import", "d.inp"), "d.yaml", ".bash_login"), (("import", "d.inp"), "d-mesh.msh", "victim.txt")):
            bad = self.linked(words, name, target)
            check(f"{' '.join(words)} does not follow a link", not bad and (self.scratch / "case" / name).is_symlink(), bad)
        folder = self.fresh()
        (folder / "case.yaml").write_text(CASE.replace("{end-time", '{name: "x\\ntouch PWNED\\n", end-time', 1))
        check("a name of two lines is refused", couplet(folder, "check", "case.yaml").returncode == 2 == couplet(folder, "run", "case.yaml", "--slurm=--time=1", "--print").returncode)
        (folder / "static.yaml").write_text(CASE.replace("top:", '"a;}b{":'))
        (folder / "square.msh").write_text(MESH.read_text().replace('"top"', '"a;}b{"'))
        check("a patch that would end an entry of OpenFOAM is refused", couplet(folder, "export", "static.yaml", "--to", "openfoam").returncode == 2)
        newest = folder / "out/checkpoints/step-00000004/solid.h5"
        newest.write_bytes(flipped(newest.read_bytes()))
        shutil.rmtree(folder / "out/solid")
        (folder / "case.yaml").write_text(MOVING)
        (folder / "square.msh").write_bytes(MESH.read_bytes())
        done = couplet(folder, "resume", "out")
        check("the checkpoint before the damaged one is used", done.returncode == 0 and "is damaged" in done.stderr and "step-00000003 is used" in done.stderr, done.stderr[-500:])
        check("lost tables are named", "probes.csv' did not exist at the restart: it begins at t = 0.003 s" in done.stdout, done.stdout[-500:])
        bad_requests(folder / "out")


def flipped(data, place=0.5):
    """The data with another bit in the middle, or at another place."""
    data = bytearray(data)
    data[int(len(data) * place)] ^= 1
    return bytes(data)


def bad_requests(folder):
    """A request without a token that is no address is answered, and nothing is printed."""
    from couplet.command import page
    from couplet.runs.progress import Progress
    server, _ = page.server(Progress(folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with contextlib.redirect_stderr(io.StringIO()) as said:
        for request, code in ((b"GET http://[::1/ HTTP/1.0", b"400"), (b"POST / HTTP/1.0", b"501"), (b"\xff\xfe", b"400"), (b"GET /?token=%ff%00&token= HTTP/1.0", b"403")):
            with socket.create_connection(server.server_address) as s:
                s.sendall(request + b"\r\n\r\n")
                answer = s.recv(1000)
                check(f"watch --web: {request!r}", code in answer[:200], answer[:60])
        with socket.create_connection(server.server_address) as s:  # leaves at once
            s.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
            s.sendall(b"GET / HTTP/1.0\r\n\r\n")
    server.shutdown()
    check("watch --web: nothing is printed", said.getvalue() == "", said.getvalue()[-300:])


def main(parts):
    if "programs" in parts:
        programs()
    with tempfile.TemporaryDirectory(prefix="couplet-hostile-") as scratch:
        scene = Scene(pathlib.Path(scratch))
        for part in parts:
            if part != "programs":
                getattr(scene, part)()
        print(f"{scene.trials} trials with links, names and damaged files")
    print(f"{len(failed)} checks failed" if failed else "all checks passed")
    sys.exit(1 if failed else 0)


main(sys.argv[2:] or ["programs"])
