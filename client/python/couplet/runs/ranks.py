# SPDX-License-Identifier: Apache-2.0
"""Division of a number of ranks among the participants, by the work measured in an earlier run, or by cells."""
import os
import re
import subprocess

from couplet.runs.case import COUPLER, OURS, expect

MOST_PER_CORE = 16
MOST = 1_000_000
ELSEWHERE = ("OMPI_MCA_orte_default_hostfile", "SLURM_JOB_ID", "PBS_NODEFILE", "LSB_HOSTS", "PE_HOSTFILE")


def measured(case, folder):
    """Returns {participant: processor seconds of work} of the run in this folder. Empty if one is missing."""
    from couplet.runs.results import Results

    results = Results(folder)
    found = {
        name: float(results.report(name).get("processor-working", 0))
        for name in case.participants
        if (folder / name / "run.json").exists()
    }
    return found if len(found) == len(case.participants) else {}


def cells(case):
    """Returns {participant: cells of its mesh}, from --explain of the programs. A program without a mesh of its own
    counts as zero."""
    found = {}
    for name in case.participants:
        if case.program(name).name not in OURS:
            continue
        said = subprocess.run(
            [case.program(name), case.file, "--explain", "--participant", name], capture_output=True, text=True
        ).stdout
        number = re.search(r"^mesh: +(\d+) cells", said, flags=re.M)
        found[name] = float(number[1]) if number else 0.0
    return found


def side_by_side(case):
    """Returns true if the participants work concurrently, not one after another."""
    coupling = case.data.get("coupling") or {}
    return "parallel" in (coupling.get("order"), (coupling.get("exchange") or {}).get("order"))


def shares(work, total, together=False):
    """Whole numbers of at least 1 that sum to `total`. They minimize the sum of work / ranks for sequential
    participants, and the maximum for those that work `together`."""
    ranks = dict.fromkeys(work, 1)
    for _ in range(total - len(work)):
        best = max(ranks, key=lambda name: work[name] / (ranks[name] if together else ranks[name] * (ranks[name] + 1)))
        ranks[best] += 1
    return ranks


def fit(case, ranks, alone=None):
    """Rejects more processes than this machine can run."""
    names = [alone] if alone else [*case.participants, *([COUPLER] if case.coupled else [])]
    fit_total(sum(int(ranks.get(name, 1)) for name in names))


def fit_total(total):
    """Checks the total, since each process polls for messages. Skipped if a queue or a file names the machines."""
    if any(os.environ.get(name) for name in ELSEWHERE):
        return
    cores = len(os.sched_getaffinity(0))
    expect(
        total <= MOST_PER_CORE * cores,
        (
            f"{total} processes on {cores} cores would make almost no progress, because each one polls for messages;"
            f" use at most {MOST_PER_CORE * cores} on this machine. On several machines use --slurm, or name their file"
            " in OMPI_MCA_orte_default_hostfile"
        ),
    )


def divide(case, total):
    """Returns {participant: ranks}. The coupler has one rank, which counts."""
    from couplet.runs.job import output_of

    expect(total <= MOST, f"-n {total}: at most {MOST} processes")
    names = [n for n in case.participants if not case.guest(n)]
    free = total - (len(case.participants) - len(names)) - (1 if case.coupled else 0)
    expect(
        free >= len(names),
        f"-n {total}: '{case.file}' needs at least {total - free + len(names)} ranks"
        + (f", one of them for the {COUPLER}" if case.coupled else ""),
    )
    work = measured(case, output_of(case, ())) or cells(case)
    return shares({name: work.get(name, 0.0) for name in names}, free, side_by_side(case))
