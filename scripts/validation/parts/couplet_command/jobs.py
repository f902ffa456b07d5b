# SPDX-License-Identifier: Apache-2.0
"""Bars of runs that the command starts: the same results, what it costs, how it ends, what it shows."""
import os
import resource
import time

from validation.job import Bar
from validation.parts.trust.runs import script, tests


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


BARS = [
    Bar("couplet run and the line that it prints, typed by hand: a coupled flap", "the same results, bit for bit", tests("^command_by_hand$")),
    Bar("two jobs side by side, each on two ranks", "no rank bound to the other's cores, the same results", tests("^command_side_by_side$")),
    Bar("overhead of couplet run", "< 0.2 s", overhead),
    Bar("stop, SIGINT, SIGTERM, then resume", "exit code 3, then to the undisturbed results, bit for bit", tests("^command_stop$")),
    Bar("the launcher killed, terminated three times, hung up; a program killed", "no process left", tests("^command_kill$")),
    Bar("100 strikes on the flap through couplet run", "no process left after 5 s, results bit for bit",
        script("tests/cli/signals/strikes.py", "{bin}", "{root}/configs/perpendicular-flap", 100, "--couplet"), long=True),
    Bar("bad cases and commands", "exit code 2, what is wrong and what to do, no page of the launcher", tests("^command_wrong$")),
    Bar("terminal of 80 x 24: flap, fluid, solid, tank", "start <= 12 lines, one status line, end <= 20 lines", tests("^command_terminal_command$"), but="a pseudo-terminal of the test, whose screen it keeps, in place of tmux"),
    Bar("terminal of 80 x 24: solid, fluid, tank, plate started by themselves; solid and flap by mpirun; in a file, marked by mpirun, with --verbose", "the same; lines as they were in files, marked or with --verbose",
        tests("^command_terminal_program$")),
    Bar("watch --web during a run, in a headless browser", "values change, no error, nothing beyond loopback, a wrong token refused", tests("^command_watch_web$")),
    Bar("couplet run --slurm, the README's sbatch and srun lines on a Slurm of one node; scancel, then resume", "the same results, bit for bit",
        tests("^command_slurm_long$"), long=True),
    Bar("check, explain, new, gallery, doctor, plot, one participant alone", "as documented", tests("^command_tell$")),
    Bar("import couplet: starts a run, reads probes, fields, findings, budget", "as documented", tests("^command_python$")),
]
