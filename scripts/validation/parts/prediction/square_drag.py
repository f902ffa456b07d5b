# SPDX-License-Identifier: Apache-2.0
"""Drag of the square at the end [N per metre of depth]."""
import csv


def total(folder):
    with open(folder / "forces.csv", newline="") as file:
        last = list(csv.DictReader(file))[-1]
    return float(last["square pressure x [N]"]) + float(last["square viscous x [N]"])
