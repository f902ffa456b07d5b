#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Years of the same hourly weather on Andasol's tank: the books close and no year's discharge differs from the one before it but by what
the soil below still takes up; the first year, which begins cold, is the neighbour that the same measure convicts.
usage: years.py BIN_FOLDER CONFIGS_FOLDER [YEARS]"""
import csv
import math
import pathlib
import subprocess
import sys
import tempfile

CELLS = 100
MOST_IMBALANCE = 1e-9  # of all heat that the flow carried
MOST_DRIFT = 1e-3      # of a year's discharge; the day that differs most is told beside it


def column(file, name):
    with open(file, newline="", encoding="utf-8") as rows:
        return [float(row[name]) for row in csv.DictReader(rows)]


def run(binaries, configs, years, folder):
    command = [binaries / "thermocline", configs / "thermocline-andasol/case.yaml"]
    for key, value in {"simulation.output.folder": folder, "simulation.end-time": f"{365 * years} day",
                       "simulation.output.interval": f"{365 * years} day", "participants.tank.bed.cells": CELLS,
                       "participants.tank.ambient.from": "01-01", "participants.tank.output.monitor-interval": "1 day",
                       "participants.tank.report.profile-day": "0 day"}.items():
        command += ["--set", f"{key}={value}"]
    result = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise SystemExit(result.stderr[-400:])
    return folder / "tank"


def discharge(out):
    """Heat taken out of the tank each day [MWh]."""
    field, excess, charged, taken = (column(out / "days.csv", name) for name in
                                     ("Q_SF [MWh/day]", "Q_excess/Q_SF [%]", "Q_C/Q_excess [%]", "Q_D/Q_C [%]"))
    days = [f * e * c * d / 1e6 for f, e, c, d in zip(field, excess, charged, taken)]
    return [0 if math.isnan(day) else day for day in days]


def differ(days, year):
    """Of a year from the one before: of its sum, and of the day that differs most, over the largest day."""
    before, now = days[365 * (year - 2):365 * (year - 1)], days[365 * (year - 1):365 * year]
    return abs(sum(now) / sum(before) - 1), max(abs(a - b) for a, b in zip(before, now)) / max(before)


def main():
    years = int(sys.argv[3]) if len(sys.argv) > 3 else 10
    with tempfile.TemporaryDirectory(prefix="couplet-years-") as folder:
        out = run(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), years, pathlib.Path(folder))
        days = discharge(out)
        moved = 2 * 3.6e9 * sum(days)  # what is taken out was brought in
        imbalance = max(map(abs, column(out / "tank.csv", "imbalance [J]"))) / moved  # the column sums up since the start
    assert len(days) == 365 * years, len(days)
    first, last = differ(days, 2), differ(days, years)
    print(f"{years} years: energy balance within {imbalance:.1e} of the heat moved; year {years} differs from the one before by {last[0]:.1e} of its "
          f"discharge, in a day by {last[1]:.1e} at most (year 2: {first[0]:.1e}, {first[1]:.1e})")
    sound = imbalance < MOST_IMBALANCE and last[0] < MOST_DRIFT < first[0]
    return 0 if sound else 1


if __name__ == "__main__":
    sys.exit(main())
