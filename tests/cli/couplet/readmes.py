# SPDX-License-Identifier: Apache-2.0
"""Runs every command of the READMEs of configs/ in order, in a copy of the cases with an empty HOME. Each must succeed. A run that takes longer than
SECONDS and has made a step is stopped by SIGTERM, after which it ends with exit code 3 and a checkpoint (or 0 if the last step was done). A study is
stopped by SIGINT, after which it ends at once. Commands that read the results of a stopped run may fail with exit code 1 or 2.
Usage: readmes.py BIN [I/N | CASE ...] [--seconds SECONDS]"""
import argparse
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import time

from scene import ROOT
from checks import check, end  # noqa: E402
from couplet.runs.folder import session  # noqa: E402

parser = argparse.ArgumentParser()
parser.add_argument("bin", type=pathlib.Path)
parser.add_argument("which", nargs="*")
parser.add_argument("--seconds", type=float, default=40)
options = parser.parse_args()
PROGRAMS = {f.name for f in options.bin.iterdir() if f.is_file()}
SETTING = re.compile(r"(\w+=\S+;?\s*)+")


def commands(readme):
    """[(settings of variables before it, command)], continued lines joined."""
    found = []
    for block in re.findall(r"^```sh\n(.*?)^```", readme, flags=re.M | re.S):
        settings = ""
        for line in block.replace("\\\n", " ").splitlines():
            if SETTING.fullmatch(line):
                settings += line + "\n"
            elif line.strip() and not line.startswith("#"):
                found.append((settings, re.sub(r"\s+#.*| {2,}", " ", line).strip()))
    return found


def in_copy(root):
    """{process: command line} of programs that work on the copy of the cases, in whatever session."""
    found = {}
    for file in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            words = file.read_bytes().decode(errors="replace").replace("\0", " ")
            if f"{root}/build/bin/" in words and (file.parent / "stat").read_text().rpartition(")")[2].split()[0] != "Z":
                found[int(file.parent.name)] = words[:120]
        except OSError:
            continue
    return found


def at_work(root):
    """Solvers that work on the copy of the cases, without their launchers."""
    found = []
    for pid in in_copy(root):
        try:
            found += [pid] if pathlib.Path(os.readlink(f"/proc/{pid}/exe")).name in PROGRAMS else []
        except OSError:
            continue
    return found


def may_stop(command, root, said):
    """Returns true for a study, and for a run that has made a step. Scripts that draw pictures come to their end."""
    return command.startswith("couplet study") or at_work(root) and re.search(r"\] t ?= ?[\d.e+-]+(/| s)", said.read_text(errors="replace")) is not None


def run(settings, command, root, home):
    """(exit code, words, how it was stopped: "", "SIGTERM" or "SIGINT")."""
    env = {"HOME": str(home), "PATH": f"{root / 'scripts'}:/usr/bin:/bin", "LANG": "C.UTF-8", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1",
           "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1", "MPLBACKEND": "agg"}
    with open(home / "said", "w+") as said:
        job = subprocess.Popen(["bash", "-c", f"{settings}{command}"], stdin=subprocess.DEVNULL, stdout=said, stderr=said, env=env, cwd=root, start_new_session=True)
        how, limit = "", time.monotonic() + options.seconds
        while job.poll() is None and (time.monotonic() < limit or not may_stop(command, root, home / "said")):
            time.sleep(0.1)
        if job.poll() is None:
            ours = at_work(root)
            how = "SIGINT" if command.startswith("couplet study") else "SIGTERM"
            if how == "SIGINT":
                os.killpg(job.pid, signal.SIGINT)  # as a terminal does
            for pid in ours if how == "SIGTERM" else ():
                os.kill(pid, signal.SIGTERM)
            try:
                job.wait(900)
            except subprocess.TimeoutExpired:
                how += ", to no effect"
        left = in_copy(root)
        for pid in session(job.pid):
            os.kill(pid, signal.SIGKILL)
        said.seek(0)
        return job.wait(), said.read() + (f"\nleft behind: {left}" if left else ""), how


def readme(name, root, home):
    found, stopped = commands((root / "configs" / name / "README.md").read_text()), False
    check(f"{name}: has a command", found)
    for settings, command in found:
        start = time.monotonic()
        code, said, how = run(settings, command, root, home)
        good = code in {"": (0,), "SIGTERM": (0, 3), "SIGINT": (130,)}.get(how, ()) and "Traceback" not in said or stopped and not how and code in (1, 2)
        stopped = stopped or bool(how)
        good = good and "left behind" not in said
        check(f"{name}: {command}", good, f"{time.monotonic() - start:.0f} s, exit code {code}{', after ' + how if how else ''}" + ("" if good else "\n" + said[-2500:]))


with tempfile.TemporaryDirectory(prefix="couplet-readmes-") as scratch:
    root, home = pathlib.Path(scratch) / "couplet", pathlib.Path(scratch) / "home"
    home.mkdir()
    for part in ("configs", "client", "scripts"):
        shutil.copytree(ROOT / part, root / part, symlinks=True, ignore=shutil.ignore_patterns("out", "out-*", "*.cache.msh", "*.log", "__pycache__"))
    shutil.copy(ROOT / "CMakeLists.txt", root)
    (root / "docs").symlink_to(ROOT / "docs")
    (root / "build").mkdir()
    (root / "build/bin").symlink_to(options.bin.absolute())
    names = sorted(f.parent.name for f in (root / "configs").glob("*/case.yaml"))
    for word in options.which[:1] if "/" in "".join(options.which) else []:
        shard, of = map(int, word.split("/"))
        names, options.which = names[shard - 1::of], []
    for name in options.which or names:
        readme(name, root, home)
end()
