# SPDX-License-Identifier: Apache-2.0
"""For scripts/study: relative L2 errors of temperature and hoop stress over the wall against the closed form of plot.py."""
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1] / "client/python"), str(HERE)]
import couplet  # noqa: E402
from plot import exact  # noqa: E402


def errors(folder):
    series = couplet.find_series(folder)
    last, centres = len(series.times) - 1, series.centres()
    r = np.hypot(centres[:, 0], centres[:, 1])
    warm, _, hoop, _ = exact(r)
    found = {"temperature": (series.field(last, "cell-temperature") - 300, warm), "hoop": (series.field(last, "stress-yy"), hoop)}
    return {name: float(np.linalg.norm(ours - wanted) / np.linalg.norm(wanted)) for name, (ours, wanted) in found.items()}
