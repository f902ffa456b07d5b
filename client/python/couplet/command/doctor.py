# SPDX-License-Identifier: Apache-2.0
"""Checks whether this machine can run coupled cases: programs and their versions, MPI, Python packages, gmsh, cores,
memory, and a coupled self-test of two seconds. The exit code is 0 if cases can be run, and 1 otherwise. Each line
that fails (NO), or that lacks what only some cases need (--), states how to fix it."""
import importlib.util
import os
import pathlib
import platform
import re
import shutil
import subprocess
import tempfile
import time

from couplet import places
from couplet.runs.case import OURS

PACKAGES = {
    "yaml": ("python3-yaml", True),
    "numpy": ("python3-numpy", True),
    "h5py": ("python3-h5py", False),
    "matplotlib": ("python3-matplotlib", False),
    "scipy": ("python3-scipy", False),
    "mpi4py": ("python3-mpi4py", False),
}


def declare(parser):
    parser.add_argument("--quick", action="store_true", help="skips the self-test")


MARKS = {True: "ok ", False: "NO ", None: "-- "}
SOMETIMES = {"mesh_tool": "partitioned or converted meshes", "relay": "couplet run --separate"}  # programs and what needs them


def first_line(*command):
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=30)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return ((done.stdout or done.stderr).strip().splitlines() or [""])[0] if done.returncode == 0 else None


def programs(bin_):
    for name in OURS:
        said = first_line(bin_ / name, "--version")
        yield name, said or f"not in {bin_}" + (
            "" if (bin_ / name).exists() else ": scripts/build, or COUPLET_BIN=FOLDER/bin"
        ), said is not None

    for name, purpose in SOMETIMES.items():
        if not (bin_ / name).exists():
            yield name, f"missing, but needed for {purpose}: {get(name)}", None


def get(*targets):
    """What provides targets of the build that are missing."""
    if (places.build() / "CMakeCache.txt").exists():
        return f"scripts/build release {' '.join(targets)}"
    return "install a package or prefix that was made after scripts/build, which builds everything"


def libraries():
    """What own programs in C++ and those of preCICE are linked with."""
    kept = {"couplet_client": ("client/libcouplet_client.a", "lib/libcouplet_client.a")}
    kept["precice_couplet"] = ("precice/lib/libprecice.so", "lib/couplet/precice/lib/libprecice.so")
    missing = [target for target, files in kept.items() if not any((places.build() / file).exists() for file in files)]
    yield "libraries", (
        f"missing, but needed by your own C++ programs and those on preCICE's interface: {get(*missing)}"
        if missing
        else "all there"
    ), (None if missing else True)


def surroundings():
    said = first_line("mpirun", "--version")
    yield "MPI", said or "there is no mpirun: apt install openmpi-bin", said is not None
    yield "Python", platform.python_version(), True
    missing = [
        (package, needed) for module, (package, needed) in PACKAGES.items() if importlib.util.find_spec(module) is None
    ]
    yield "packages", f"missing: apt install {' '.join(p for p, _ in missing)}" if missing else "all there", (
        False if any(needed for _, needed in missing) else None if missing else True
    )
    said = first_line("gmsh", "--version")
    yield "gmsh", said or "missing, but needed for meshes from .geo (apt install gmsh)", True if said else None
    cores = len(os.sched_getaffinity(0))
    yield "cores", f"{cores}, load {os.getloadavg()[0]:.1f}", True
    memory = re.findall(r"^(MemTotal|MemAvailable):\s+(\d+)", pathlib.Path("/proc/meminfo").read_text(), flags=re.M)
    yield "memory", ", ".join(
        f"{int(kb) / 2**20:.1f} GB {'in all' if name == 'MemTotal' else 'free'}" for name, kb in memory
    ), True
    free = shutil.disk_usage(os.getcwd()).free / 2**30
    yield "disk", f"{free:.1f} GB free here", free > 0.5
    yield "shared memory", f"{shutil.disk_usage('/dev/shm').free / 2**20:.0f} MB free in /dev/shm", shutil.disk_usage(
        "/dev/shm"
    ).free > 32 * 2**20


def self_test():
    """Runs two steps of the coupled flap on a coarse mesh in a temporary folder."""
    from couplet.runs.gallery import copy, find
    from couplet.runs.job import run

    start = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="couplet-doctor-") as scratch:
        try:
            case = copy(find("perpendicular-flap"), pathlib.Path(scratch) / "flap", {"simulation.end-time": "0.02 s"})
            results = run(case)
            tip = results.probes("solid")
            moved = next(values[-1] for head, values in tip.items() if "x [m]" in head)
        except Exception as error:  # any exception is reported as the result
            return f"failed: {error}", False
    return (
        f"fluid, solid, mover and coupler: the flap's tip moved by {moved:.3g} m in {time.monotonic() - start:.1f} s",
        moved > 0,
    )


def run(arguments):
    found = [*programs(places.build() / "bin"), *libraries(), *surroundings()]
    good = all(fine is not False for _, _, fine in found)
    for name, text, fine in found:
        print(f"{MARKS[fine]} {name:14} {text}")
    if not arguments.quick and good:
        text, good = self_test()
        print(f"{'ok ' if good else 'NO '} {'self-test':14} {text}")
    print(
        "This machine can run coupled cases."
        if good
        else "This machine cannot run coupled cases yet: see the lines with NO."
    )
    return 0 if good else 1
