# SPDX-License-Identifier: Apache-2.0
"""Bars of runs that the command starts: the same results, what it costs, how it ends, what it shows."""
import statistics
import time

from validation.job import Bar
from validation.parts.trust.runs import script, tests


def overhead(job):
    """Wall time of couplet run less that of mpirun with the same line, of a coupled job of two steps; the runs alternate."""
    couplet, folder = job.root / "scripts/couplet", job.scratch / "overhead"
    job.run([couplet, "new", folder, "--set", "simulation.end-time=0.02"], check=True)
    command = [couplet, "run", folder, "--bin", job.build / "bin", "-q"]
    line = job.run([*command, "--print"], check=True).stdout
    seconds = {"couplet": [], "mpirun": []}
    for _ in range(10):
        for name, words in (("couplet", command), ("mpirun", ["sh", "-c", line])):
            start = time.monotonic()
            job.run(words, check=True)
            seconds[name].append(time.monotonic() - start)
    least = min(seconds["couplet"][1:]) - min(seconds["mpirun"][1:])  # the first one makes the mesh
    middle = statistics.median(seconds["couplet"][1:]) - statistics.median(seconds["mpirun"][1:])
    return f"{least:.2f} s by the quickest of nine runs each, {middle:.2f} s by the medians (mpirun {min(seconds['mpirun']):.2f} s)", least < 0.2


BARS = [
    Bar("couplet run and the line that it prints, typed by hand: a coupled flap", "the same results, bit for bit", tests("^command_by_hand$")),
    Bar("overhead of couplet run", "< 0.2 s", overhead),
    Bar("stop, SIGINT, SIGTERM, then resume", "exit code 3, then to the undisturbed results, bit for bit", tests("^command_stop$")),
    Bar("the launcher killed, terminated three times, hung up; a program killed", "no process left", tests("^command_kill$")),
    Bar("100 strikes on the flap through couplet run", "no process left after 5 s, results bit for bit",
        script("tests/cli/signals/strikes.py", "{bin}", "{root}/configs/perpendicular-flap", 100, "--couplet"), long=True),
    Bar("bad cases and commands", "exit code 2, what is wrong and what to do, no page of the launcher", tests("^command_wrong$")),
    Bar("terminal of 80 x 24: flap, fluid, solid, tank", "start <= 12 lines, one status line, end <= 20 lines", tests("^command_terminal$")),
    Bar("watch --web during a run, in a headless browser", "values change, no error, nothing beyond loopback, a wrong token refused", tests("^command_watch_web$")),
    Bar("couplet run --slurm, the README's sbatch and srun lines on a Slurm of one node; scancel, then resume", "the same results, bit for bit",
        tests("^command_slurm_long$"), long=True),
    Bar("check, explain, new, gallery, doctor, plot, one participant alone", "as told", tests("^command_tell$")),
    Bar("import couplet: starts a run, reads probes, fields, findings, budget", "as told", tests("^command_python$")),
]
