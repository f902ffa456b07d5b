# SPDX-License-Identifier: Apache-2.0
"""Order, extrapolation and uncertainty of a series of refined runs, and its cost's growth.

Richardson's extrapolation with the observed order and the grid convergence index (GCI) with a factor of safety of 1.25 for
three sizes, after Roache, J. Fluids Eng. 116 (1994) 405, and Celik et al., J. Fluids Eng. 130 (2008) 078001 (their equation
for the order where the ratios of the sizes differ)."""
import dataclasses
import math

import numpy as np
from scipy.optimize import brentq

SAFETY = 1.25


@dataclasses.dataclass
class Limit:
    value: float        # extrapolated
    order: float        # observed
    constant: float     # value(n) = limit + constant n^-order
    gci: float          # uncertainty of the finest value, absolute

    def error(self, n):
        return abs(self.constant) * n**-self.order

    def size_for(self, error):
        return (abs(self.constant) / error) ** (1 / self.order)


def limit_of(sizes, values, lowest=0.2, highest=8):
    """The limit of the three finest; None where they do not approach one (changes that do not shrink, or alternate)."""
    if len(values) < 3:
        return None
    (n1, n2, n3), (v1, v2, v3) = sizes[-3:], values[-3:]
    first, second = v2 - v1, v3 - v2
    if second == 0 or first / second <= 0 or not all(map(math.isfinite, (first, second))):
        return None

    def mismatch(p):
        return (n1**-p - n2**-p) / (n2**-p - n3**-p) - first / second
    if mismatch(lowest) * mismatch(highest) > 0:
        return None
    order = brentq(mismatch, lowest, highest)
    constant = (v2 - v3) / (n2**-order - n3**-order)
    value = v3 - constant * n3**-order
    return Limit(value, order, constant, SAFETY * abs(value - v3))


def slope(x, y):
    """Exponent of a power law, least squares in the logarithms; None with fewer than two points."""
    good = [(a, b) for a, b in zip(x, y) if a > 0 and b > 0]
    if len(good) < 2 or len({a for a, _ in good}) < 2:
        return None
    return float(np.polyfit(*np.log(np.array(good)).T, 1)[0])


def pareto(points):
    """Of (cost, error) pairs those that no other beats in both, by cost."""
    best, front = math.inf, []
    for cost, error in sorted(points):
        if error < best:
            best = error
            front.append((cost, error))
    return front
