# SPDX-License-Identifier: Apache-2.0
"""Waits in a circle, processes without a sign of life, and long work that gives signs: who is named, when, and who is not.
Usage: silence.py BIN TOYS"""
import os
import time

from jobs import Suite, case_text, mpmd

suite = Suite()
command = mpmd("1 coupler case.yaml", "1 toy_piston case.yaml", "2 toy_spring case.yaml")
slower = int(os.environ.get("COUPLET_SLOWER", "1"))


def case(timeout=None):
    text = case_text()
    return {"case.yaml": text if timeout is None else text.replace("output: {folder: out}", f"output: {{folder: out}}\n  hang-timeout: {timeout}")}


def scenario(name, fault, timeout, code, lines, seconds=None, **more):
    """`seconds`: so long the job may take in all."""
    start = time.monotonic()
    suite.scenario(name, command, case(timeout), code, lines, fault=fault, **more)
    took = time.monotonic() - start
    if seconds and took > seconds * slower:
        print(f"not ok  {name}: {took:.1f} s, allowed are {seconds} s")
        suite.failed.append(name + " in time")


circle = ["deadlock: all programs of the job wait for each other:", "'coupler' waits for 'fluid' to answer solve",
          "'fluid' waits for a message that is never sent", "'solid' waits for the next command"]
for timeout in (None, "0 s", "1 h"):
    scenario(f"a wait in a circle, hang-timeout {timeout or 'by default'}", "fluid:solve:4:0:wait", timeout, 1, circle, seconds=15,
             within=10.0, not_lines=["was killed"])
scenario("a wait in a circle before the first step", "fluid:initialise:2:0:wait", None, 1, [circle[0]], seconds=15, within=10.0)
scenario("no sign of life: named", "solid:solve:4:0:hang", "3 s", 1, ["participant 'solid' (rank ", "hangs; last heard of in solve"],
         not_lines=["participant 'fluid'", "participant 'coupler'"])
scenario("stopped: named", "solid:solve:4:1:stop", "1 s", 1, ["participant 'solid' (rank 1, ", "is stopped (as by SIGSTOP)"])
scenario("seven seconds of work with signs of life: no hang, no circle", "fluid:solve:4:0:work", "3 s", 0, ["t=1/1 s  step 10"],
         not_lines=["hangs", "wait for each other"])
suite.finish()
