# SPDX-License-Identifier: Apache-2.0
"""Bars of jobs that are killed or stopped at any moment."""
from validation.job import Bar
from validation.parts.trust.runs import script

BARS = [
    Bar("100 kills and stops of the flap at start-up, meshing, steps and finish",
        "no process left after 5 s, the culprit named in 95 %",
        script("tests/cli/death/strikes.py", "{bin}", "{bin}/tests", "{root}/configs/perpendicular-flap", 100), long=True),
]
