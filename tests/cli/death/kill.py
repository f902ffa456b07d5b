# SPDX-License-Identifier: Apache-2.0
"""A participant killed in any phase: all processes end within 5 s, the exit code is not 0, one line names the culprit."""
import sys

from jobs import Suite, case_text, mpmd

phases = sys.argv[3].split(",")
suite = Suite(at_once=2)
case = {"case.yaml": case_text()}
command = mpmd("1 coupler case.yaml", "2 toy_piston case.yaml", "1 toy_spring case.yaml")

# phase: how often it has been entered when the process dies, and what the line says
said = {
    "roll-call": (1, "last heard of in roll-call"),
    "initialise": (1, "last heard of in initialise"),
    "begin_step": (2, "last heard of in begin_step at t = 0.1"),
    "solve": (4, "last heard of in solve at t = 0."),
    "waiting": (6, "last heard of in waiting at t = 0"),
    "accept": (3, "last heard of in accept at t = 0."),
    "save": (1, "last heard of in save at t = 1"),
    "finalise": (1, "last heard of in finalise at t = 1"),
}
for phase in phases:
    count, line = said[phase]
    for victim, rank in (("solid", 0), ("fluid", 1), ("coupler", 0)):
        if victim == "coupler":
            if phase == "waiting":  # the coupler waits inside the other phases
                continue
            count = 1 if phase in ("begin_step", "solve") else count
            line = line.split(" at t")[0]
        name = f"participant '{victim}' (" + ("" if phase == "roll-call" else f"rank {rank}, ")
        suite.scenario(f"{victim} rank {rank} killed in {phase}", command, case, None, [name, line, "was killed"],
                       fault=f"{victim}:{phase}:{count}:{rank}", not_lines=["; participant"])
suite.finish()
