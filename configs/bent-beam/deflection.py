# SPDX-License-Identifier: Apache-2.0
"""Deflection of the tip along the load, across the beam, over the length of 2 m."""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "client/python"))
import couplet  # noqa: E402

LENGTH = 2.0  # [m]


def over_length(folder):
    tip = couplet.read_csv(pathlib.Path(folder) / "probes.csv")
    return math.hypot(tip["tip x [m]"][-1], tip["tip y [m]"][-1]) / LENGTH
