# SPDX-License-Identifier: Apache-2.0
"""Bars of quantities as contracts: temperatures and their differences, ranges of all keys, the mistakes of a user."""
import re

from validation.job import Bar
from validation.parts.trust.runs import gtests, script

RUN = "tests/mistakes/run.py"


def mistakes(*names, least):
    """A bar of some mistakes of tests/mistakes by their names, or of all."""
    def measure(job):
        result = job.run(["/usr/bin/python3", job.root / RUN, job.build / "bin", *names])
        good = re.findall(r"^ok +(\w+) ", result.stdout, re.M)
        bad = re.findall(r"^FAILED +(\w+) +(.*)$", result.stdout, re.M)
        kinds = ", ".join(f"{good.count(kind)} {kind}" for kind in ("refused", "flagged", "right") if kind in good)
        lost = f"; another outcome: {', '.join(name for _, name in bad[:4])}" if bad else ""
        return f"{len(good)} of {len(good) + len(bad)} as in the table: {kinds}{lost}", result.returncode == 0 and len(good) >= least
    return measure


BARS = [
    Bar("scene: -300 degC as a solid's temperature", "refused", mistakes("below absolute zero", least=1)),
    Bar("scene: a bare 20 as a solid's temperature", "refused", mistakes("Celsius without a unit", least=1)),
    Bar("scene: flow.restart: 10 degC where a difference is meant", "refused", mistakes("a temperature for a difference", least=1)),
    Bar("scene: an explicit step far beyond its limit in a duct of oil", "refused",
        mistakes("a step far beyond the explicit limit", least=1)),
    Bar("the mistakes of a user: refused, flagged or right, with the message", "at least 30, each as in the table", mistakes(least=30)),
    Bar("keys with a unit, of all programs: a range or a written reason", "all", script("tests/mistakes/keys.py", "{bin}")),
    Bar("cases of configs/: none refused or flagged by the ranges (--check of each participant)", "0",
        script("tests/mistakes/shipped.py", "{bin}", "{root}/configs")),
    Bar("the contract fires and does not fire: bare numbers, differences, absolute zero, ranges, pairs, files read again", "claims hold",
        gtests("unit_config", "Quantities")),
]
