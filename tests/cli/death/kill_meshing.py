# SPDX-License-Identifier: Apache-2.0
"""A solver killed while gmsh is meshing for it leaves no gmsh behind after 5 s; and what gmsh has at hand while it runs: its own home
and working directory, no new privileges, limits, the filter of its calls.
Usage: kill_meshing.py BIN WRONG_FOLDER"""
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

PATIENCE = 120  # [s] until gmsh runs, on a busy machine
# Millions of turns of gmsh's own language: it is at work for minutes.
SLOW = "For i In {1:100000000}\n  x = i;\nEndFor\n"
programs, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
failed = []


def check(name, good, detail=""):
    print(f"{'ok' if good else 'not ok'}  {name}{'' if good else f': {detail}'}", flush=True)
    if not good:
        failed.append(name)


def running(marker):
    """{process id: command line} of gmsh: it has its folder in its command line or its environment."""
    found = {}
    for entry in pathlib.Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                line = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
                variables = (entry / "environ").read_bytes().decode(errors="replace")
                state = (entry / "stat").read_text().rpartition(")")[2].split()[0]
            except OSError:
                continue
            if (f"{marker}/couplet-gmsh-" in line or f"TMPDIR={marker}/couplet-gmsh-" in variables) and state not in "ZX":
                found[int(entry.name)] = line
    return found


def innermost(marker):
    """gmsh itself, once it is at work."""
    for process, line in running(marker).items():
        if line and line.split()[0].endswith("gmsh") and "mesh.msh" in line:
            return process
    return None


def environment(folder):
    """The environment of a run, its temporary folder below `folder`."""
    (folder / "tmp").mkdir()
    env = {**os.environ, "TMPDIR": str(folder / "tmp"), "HOME": str(folder / "home"), "COUPLET_SECRET": "1"}
    for name in ("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"):
        env[name] = "1"
    return env


def status(process, key):
    for line in pathlib.Path(f"/proc/{process}/status").read_text().splitlines():
        if line.startswith(key + ":"):
            return line.split()[1]
    return None


def look_at(process, name, folder):
    """What holds for gmsh while it runs."""
    proc = pathlib.Path(f"/proc/{process}")
    variables = dict(v.split("=", 1) for v in proc.joinpath("environ").read_bytes().decode().split("\0") if "=" in v)
    own = str(folder / "tmp")
    check(f"{name}: HOME and TMPDIR are its own folder", variables["HOME"].startswith(own) and variables["TMPDIR"].startswith(own), variables)
    check(f"{name}: a clean environment", "COUPLET_SECRET" not in variables and not any(v.startswith("OMPI_") for v in variables), variables)
    check(f"{name}: works in its own folder", os.readlink(proc / "cwd").startswith(own), os.readlink(proc / "cwd"))
    check(f"{name}: no new privileges", status(process, "NoNewPrivs") == "1", status(process, "NoNewPrivs"))
    limits = {line[:25].strip(): line[25:].split()[0] for line in proc.joinpath("limits").read_text().splitlines()[1:]}
    for what in ("Max cpu time", "Max file size", "Max address space"):
        check(f"{name}: {what} is limited", limits[what] != "unlimited", limits)
    check(f"{name}: no core file", limits["Max core file size"] == "0", limits)
    check(f"{name}: its calls are filtered", status(process, "Seccomp") == "2", status(process, "Seccomp"))


def scene(name, command):
    with tempfile.TemporaryDirectory() as top:
        folder = pathlib.Path(top).resolve()
        (folder / "home").mkdir()
        (folder / "home/.gmshrc").write_text("General.Verbosity = 99;\n")
        (folder / "case.yaml").write_text((source / "solid.yaml").read_text().replace("square.msh", "slow.geo"))
        (folder / "slow.geo").write_text(SLOW)
        env = environment(folder)
        with open(folder / "log", "w", encoding="utf-8") as log:
            job = subprocess.Popen([*command, programs / "solid_solver", "case.yaml"], cwd=folder, env=env, stdout=log, stderr=log,
                                   start_new_session=True)
        marker, end = str(folder / "tmp"), time.monotonic() + PATIENCE
        while (gmsh := innermost(marker)) is None and job.poll() is None and time.monotonic() < end:
            time.sleep(0.05)
        text = (folder / "log").read_text()
        check(f"{name}: gmsh runs", gmsh is not None, text[-800:])
        if gmsh is not None:
            look_at(gmsh, name, folder)
            solver = job.pid if not command else solver_of(folder)
            os.kill(solver, signal.SIGKILL)
            start = time.monotonic()
            while running(marker) and time.monotonic() - start < 5:
                time.sleep(0.05)
            check(f"{name}: nothing is left 5 s after the death of the solver", not running(marker), running(marker))
        for process in running(marker):
            os.kill(process, signal.SIGKILL)
        if job.poll() is None:
            job.kill()
        job.wait()


def solver_of(folder):
    """The solver that works in this folder."""
    for entry in pathlib.Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and os.readlink(entry / "cwd") == str(folder) and os.readlink(entry / "exe").endswith("/solid_solver"):
                return int(entry.name)
        except OSError:
            continue
    raise RuntimeError("no solver")


scene("alone", [])
scene("under mpirun", [shutil.which("mpirun"), "--oversubscribe", "-n", "1"])
print(f"{len(failed)} of the checks failed" if failed else "all checks passed")
sys.exit(1 if failed else 0)
