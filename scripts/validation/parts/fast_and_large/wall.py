# SPDX-License-Identifier: Apache-2.0
"""A large interface: two programs of benchmarks/exchange/sheet.cpp with VERTICES on each side, 4 ranks each, and a coupler of 4."""
import json
import re

VERTICES, RANKS, STEPS = 1_000_000, 4, 5
CASE = """simulation: {{end-time: {end}, time-step: 0.01, output: {{folder: out, interval: 0}}, checkpoint: {{interval: 0}}, accept: [error-estimate]}}
participants:
  fluid: {{program: sheet}}
  solid: {{program: sheet}}
coupling:
  scheme: explicit
  exchange: {{participants: [fluid, solid], order: serial}}
  mapping: {{type: projection}}
"""
SHARED_MEMORY = ("--mca", "pml", "ob1", "--mca", "btl", "self,vader")


def sheet(job):
    def make():
        program = job.scratch / "sheet"
        client = job.root / "client"
        job.done(["mpicxx", "-O2", "-std=c++17", "-DOMPI_SKIP_MPICXX", f"-I{client}", job.root / "benchmarks/exchange/sheet.cpp",
                  *client.glob("*.cpp"), "-o", program])
        return program
    return job.once(("sheet",), make)


def coupled(job, ranks):
    """What the programs print, and run.json of the coupler."""
    def make():
        folder = job.scratch / f"sheet-{ranks}"
        folder.mkdir()
        (folder / "case.yaml").write_text(CASE.format(end=STEPS * 0.01))
        sides = [word for name in ("fluid", "solid") for word in (":", "-n", ranks, sheet(job), name, VERTICES)]
        result = job.done(["mpirun", "--oversubscribe", "-n", ranks, job.build / "bin/coupler", "case.yaml", *sides], 3600, cwd=folder)
        return result.stdout, json.loads((folder / "out/coupler/run.json").read_text())
    return job.once(("sheet", ranks), make)


def maps(job):
    """Time from the start of the job to the first step, as the slower side sees it: surfaces sent, maps made, places judged. Processor time is that of the
    coupler until its end, which hangs less on what else the machine does."""
    text, run = coupled(job, RANKS)
    seconds = max(map(float, re.findall(r"first step after ([\d.]+)", text)))
    off = float(re.search(r"displacement off by (\S+) m", text)[1])
    return (f"{seconds:.1f} s until the first step, {run['processor']:.1f} s of processor time of the coupler's {RANKS} ranks with {STEPS} steps, on two cores; "
            f"a linear motion arrives to {off:.1g} m"), seconds <= 10 and off < 1e-9


def share(job):
    """By memory as the system counts it: the surfaces, what was copied of them, and the maps."""
    _, run = coupled(job, RANKS)
    fullest = run["memory-most"] / (run["memory-all"] / RANKS)
    return (f"{fullest:.2f} of the mean of {RANKS} ranks, {run['memory-all'] / 1000:.2f} GB over all, {run['memory-most'] / 1000:.2f} GB on the fullest; "
            "vertices and faces are cut evenly, what is near a cut is copied"), fullest <= 2


def beside_mpi(job):
    text, _ = coupled(job, RANKS)
    step = float(re.search(r"steps, ([\d.]+) s a step", text)[1])
    alone = job.done(["mpirun", "--oversubscribe", *SHARED_MEMORY, "-n", 2 * RANKS, sheet(job), "plain", VERTICES]).stdout
    plain = float(re.search(r"plain ([\d.]+) s", alone)[1])
    return f"{step:.3f} s for a step of two passes, least of {STEPS - 1}; MPI alone {plain:.3f} s there and back, least of 20: {step / plain:.1f} times", step <= 3 * plain
