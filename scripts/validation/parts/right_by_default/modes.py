# SPDX-License-Identifier: Apache-2.0
"""Free vibrations by factors."""
import csv
import re

FORK = "tuning-fork"


def frequencies(run):
    with open(run.folder / "solid" / "modes.csv", encoding="utf-8") as file:
        return [float(row[1]) for row in list(csv.reader(file))[1:]]


def seconds(job):
    run = job.alone(FORK)
    found = float(re.search(r"^begin_step\s+([\d.]+)", run.log, re.MULTILINE).group(1))
    return f"{found:.2f} s", found <= 2.3


def ranks(job):
    one, *others = [frequencies(job.alone(FORK, ranks=n)) for n in (1, 2, 3)]
    worst = max(abs(a / b - 1) for other in others for a, b in zip(other, one))
    return f"{worst:.1e}", worst < 1e-8
