# SPDX-License-Identifier: Apache-2.0
"""A job as a batch job of Slurm, which starts `couplet run` on its first node."""
import shlex
import shutil
import subprocess

from couplet import places
from couplet.runs.case import expect, mapping_of


def script(job, options):
    ranks = sum(int(job.command[i + 1]) for i, word in enumerate(job.command) if word == "-n") or 1
    words = [places.command(), "run", job.case.file.absolute(), "--bin", job.case.build / "bin"]
    words += ["-n", ",".join(f"{name}={n}" for name, n in job.ranks.items())] if job.ranks else []
    words += ["--participant", job.alone] if job.alone else []
    words += [w for s in job.sets for w in ("--set", s)] + job.flags + [w for name, line in job.played_by.items() for w in ("--with", f"{name}={shlex.join(line)}")]
    # Before its time is over the job is asked to end: it saves, and couplet resume goes on.
    head = {"--job-name": mapping_of(job.case.data.get("simulation")).get("name", job.case.file.stem), "--ntasks": ranks, "--signal": "B:TERM@60"}
    head = [f"{name}={value}" for name, value in head.items() if name not in {option.split("=")[0] for option in options}]
    return "\n".join(["#!/bin/bash", *(f"#SBATCH {shlex.quote(word)}" for word in (*head, *options)), "exec " + shlex.join(map(str, words)), ""])


def hand_over(job, options, only_show):
    text = script(job, options)
    if only_show:
        print(text, end="")
        return 0
    expect(shutil.which("sbatch"), "there is no sbatch on this machine; couplet run --slurm --print shows the script")
    return subprocess.run(["sbatch"], input=text, text=True).returncode
