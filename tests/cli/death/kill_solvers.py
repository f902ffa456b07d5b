# SPDX-License-Identifier: Apache-2.0
"""A real solver killed in each phase of a coupled step: all processes end within 5 s of its death, the exit code is not 0,
one line names the culprit. Usage: kill_solvers.py BIN TOYS CASE_FOLDER"""
import pathlib
import shutil
import sys

from jobs import Suite, mpmd

source = pathlib.Path(sys.argv[3])


def prepare(folder):
    for file in [*source.glob("*.yaml"), *source.glob("*.geo")]:
        shutil.copy(file, folder)


sets = "--set simulation.end-time=0.04 --set simulation.checkpoint.interval=0.02"
suite = Suite()
command = mpmd(*(f"{n} {program} case.yaml {sets}" for n, program in
                 ((1, "coupler"), (2, "fluid_solver"), (1, "solid_solver"), (1, "mesh_mover"))))
for victim, rank, phase, count in (("fluid", 1, "initialise", 1), ("mover", 0, "begin_step", 2), ("fluid", 0, "solve", 4),
                                   ("solid", 0, "solve", 3), ("mover", 0, "waiting", 5), ("solid", 0, "accept", 2),
                                   ("fluid", 1, "save", 1), ("solid", 0, "finalise", 1)):
    suite.scenario(f"{victim} rank {rank} killed in {phase}", command, {}, None,
                   [f"participant '{victim}' (rank {rank}, ", "was killed", f"last heard of in {phase}"],
                   fault=f"{victim}:{phase}:{count}:{rank}", not_lines=["; participant"], prepare=prepare)
suite.finish()
