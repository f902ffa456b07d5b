# SPDX-License-Identifier: Apache-2.0
"""For scripts/couplet study: relative L2 errors of temperature and hoop stress over the wall against the closed form."""
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1] / "client/python"), str(HERE)]
import couplet  # noqa: E402

A, B, HOT, E, NU, ALPHA = 1.0, 1.5, 100.0, 200e9, 0.3, 12e-6


def exact(r):
    """Temperature above the outside [K], radial, hoop and axial stress [Pa]; Timoshenko and Goodier, Theory of Elasticity,
    article 151, ends held."""
    size = np.log(B / A)
    c, g = E * ALPHA * HOT / (2 * (1 - NU) * size), A**2 / (B**2 - A**2) * size
    warm = HOT * np.log(B / r) / size
    radial, hoop = (c * (k - np.log(B / r) - g * (1 - s * B**2 / r**2)) for k, s in ((0, 1), (1, -1)))
    return warm, radial, hoop, NU * (radial + hoop) - E * ALPHA * warm


def errors(folder):
    series = couplet.find_series(folder)
    last, centres = len(series.times) - 1, series.centres()
    r = np.hypot(centres[:, 0], centres[:, 1])
    warm, _, hoop, _ = exact(r)
    found = {"temperature": (series.field(last, "cell-temperature") - 300, warm), "hoop": (series.field(last, "stress-yy"), hoop)}
    return {name: float(np.linalg.norm(ours - wanted) / np.linalg.norm(wanted)) for name, (ours, wanted) in found.items()}
