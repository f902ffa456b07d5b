# SPDX-License-Identifier: Apache-2.0
"""Turns this process into the program of the case to which its rank belongs, so that any launcher starts a coupled
case as one application: `mpirun -n 5 couplet-exec case.yaml -n fluid=2`, or `srun --mpi=pmix --ntasks=5 couplet-exec
case.yaml -n fluid=2`. The coupler has the first ranks, and the participants follow in the order of the case, each
with one rank unless -n gives it more."""
import json
import os
import sys
import time

RANK_AND_SIZE = (
    ("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"),
    ("PMI_RANK", "PMI_SIZE"),
    ("SLURM_PROCID", "SLURM_NTASKS"),
    ("PMIX_RANK", ""),
)
PATIENCE = 5.0  # [s]


def declare(parser):
    from couplet.command.run import declare_job

    declare_job(parser, "ranks of participants: fluid=4,solid=2")


def place():
    """Rank of this process and number of all, as the launcher tells them. A process without a launcher is alone; a
    number may be unknown (None)."""
    for rank, size in RANK_AND_SIZE:
        if rank in os.environ:
            return int(os.environ[rank]), int(os.environ[size]) if size in os.environ else None
    return 0, 1


def start(rank, parts):
    """Replaces this process by the program of its rank. `parts` is [(number of ranks, words)]."""
    for number, (ranks, words) in enumerate(parts):
        if rank < ranks:
            os.environ["COUPLET_PART"] = str(number)  # tells two programs of one participant apart (docs/protocol.md)
            try:
                os.execvp(words[0], words)
            except OSError as error:
                print(f"couplet-exec: {words[0]}: {error.strerror}", file=sys.__stderr__, flush=True)
                os._exit(2)
        rank -= ranks


def parts_of(arguments, size):
    from couplet.command.run import job_of
    from couplet.runs.case import COUPLER, expect
    from couplet.runs.job import surroundings

    expect(
        not any(words.isdigit() for words in arguments.ranks),
        (
            f"-n {' '.join(arguments.ranks)}: name the participants, such as -n fluid=4,solid=2; couplet run CASE -n N"
            " --print divides N ranks among them"
        ),
    )
    job = job_of(arguments)
    if len(job.parts) == 1 and not job.ranks and size:
        return [(size, job.parts[0][1])]
    total, names = sum(n for n, _ in job.parts), (
        [COUPLER, *job.case.participants]
        if len(job.parts) > 1
        else [arguments.participant or next(iter(job.case.participants))]
    )
    expect(
        size in (None, total),
        (
            f"{arguments.case} needs {total} processes"
            f" ({', '.join(f'{name} {n}' for name, (n, _) in zip(names, job.parts))}), but"
            f" {size} {'was' if size == 1 else 'were'} started. Start {total} (mpirun -n {total} couplet-exec ..., srun"
            f" --ntasks={total} couplet-exec ...), or give the participants other ranks with -n NAME=N."
        ),
    )
    os.environ.update(surroundings())
    return job.parts


def run(arguments):
    rank, size = place()
    start(rank, parts_of(arguments, size))


def main():
    """The command couplet-exec. It returns only after an error, which rank 0 reports for all."""
    rank = place()[0]
    if plan := os.environ.pop("COUPLET_PLAN", None):  # couplet run has read the case
        start(rank, json.loads(plan))
    from couplet.command import dispatch

    if rank > 0:
        sys.stderr = open(os.devnull, "w")
    try:
        return dispatch("exec", sys.argv[1:])
    finally:
        if rank > 0:
            time.sleep(PATIENCE)  # the launcher ends the others after the first that fails
