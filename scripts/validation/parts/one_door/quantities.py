# SPDX-License-Identifier: Apache-2.0
"""Measures of quantities as contracts: temperatures and their differences, ranges of all keys, the mistakes of a user."""
import re

RUN = "tests/mistakes/run.py"


def mistakes(job, *names, least=1):
    """Some mistakes of tests/mistakes by their names, or all."""
    result = job.run(["/usr/bin/python3", job.root / RUN, job.build / "bin", *names])
    good = re.findall(r"^ok +(\w+) ", result.stdout, re.M)
    bad = re.findall(r"^FAILED +(\w+) +(.*)$", result.stdout, re.M)
    kinds = ", ".join(f"{good.count(kind)} {kind}" for kind in ("refused", "flagged", "right") if kind in good)
    lost = f"; another outcome: {', '.join(name for _, name in bad[:4])}" if bad else ""
    return f"{len(good)} of {len(good) + len(bad)} as in the table: {kinds}{lost}", result.returncode == 0 and len(good) >= least
