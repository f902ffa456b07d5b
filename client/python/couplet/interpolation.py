# SPDX-License-Identifier: Apache-2.0
"""Interpolation between values along a line, and its extrema."""
import numpy as np


def lagrange(nodes, at):
    """Weights of the values at `nodes` in the interpolating polynomial at `at`."""
    return np.array([np.prod([(at - b) / (a - b) for b in nodes if b != a]) for a in nodes])


def extremum(place, values, sign):
    """Extremum of the quartic through the five points around the largest sign * value."""
    i = int(np.clip(np.argmax(sign * values), 2, len(values) - 3))
    fine = np.linspace(place[i - 1], place[i + 1], 401)
    nodes = place[i - 2 : i + 3]
    return sign * max(sign * float(lagrange(nodes, x) @ values[i - 2 : i + 3]) for x in fine)
