# SPDX-License-Identifier: Apache-2.0
"""Measures of runs that the command starts: the same results, what it costs, how it ends, what it shows."""
import os
import resource
import time


def overhead(job):
    """Wall and processor time of couplet run less those of mpirun with the same line; the programs do nothing, the runs alternate. What the
    machine does besides lengthens both: the quickest of all runs counts."""
    couplet, folder, programs = job.root / "scripts/couplet", job.scratch / "overhead", job.scratch / "idle/bin"
    job.run([couplet, "new", folder], check=True)
    programs.mkdir(parents=True)
    for name in ("coupler", "fluid_solver", "solid_solver", "mesh_mover"):
        (programs / name).write_text("#!/bin/sh\nexit 0\n")
        (programs / name).chmod(0o755)
    command = [couplet, "run", folder, "--bin", programs]
    line = job.run([*command, "--print"], check=True).stdout
    wall, processor = {"couplet": [], "mpirun": []}, {"couplet": [], "mpirun": []}
    for _ in range(20):
        for name, words in (("couplet", command), ("mpirun", ["sh", "-c", "exec " + line])):
            start, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
            job.run(words, check=True)
            wall[name].append(time.monotonic() - start)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            processor[name].append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    seconds, used = (min(t["couplet"]) - min(t["mpirun"]) for t in (wall, processor))
    return f"{seconds:.2f} s, {used:.2f} s of the processor (mpirun {min(wall['mpirun']):.2f} s; load {os.getloadavg()[0]:.0f})", seconds < 0.2
