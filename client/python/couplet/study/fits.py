# SPDX-License-Identifier: Apache-2.0
"""Fits of a series of refined runs, with an error bound that grows for a poor fit. Order, extrapolation and uncertainty
of three runs.

Richardson's extrapolation with the observed order and the grid convergence index (GCI) with a factor of safety of 1.25
for three sizes, after Roache, J. Fluids Eng. 116 (1994) 405, and Celik et al., J. Fluids Eng. 130 (2008) 078001 (their
equation for the order where the ratios of the sizes differ).

Least squares over the runs after Eca and Hoekstra, J. Comput. Phys. 262 (2014) 104 (doi 10.1016/j.jcp.2014.01.006),
here in h = 1/n: value(n) = limit + c n^-p with 0.5 <= p <= the formal order + 0.1, with equal weights or weights n. If
the order is at its lower limit or the values turn, also limit + c1 n^-1 + c2 n^-2. The fit with the smallest standard
deviation counts. The error bound is F e(n) + s with F = 1.25, or 3 if the order is below its limit or values turn, or 2
if it is too high by more than 1 (the formal order then overestimates). If the standard deviation s is not below the
mean change between neighboring runs, it is 3 s / change (e(n) + s). The error e(n) is at least the run's own distance
from the limit, which includes |value - fit| of the paper."""
import dataclasses
import math

import numpy as np
from scipy.optimize import brentq, minimize_scalar

LOWEST, ABOVE = 0.5, 0.1  # orders: the lowest, and the margin above the formal one
SAFETY, STEEP, POOR = 1.25, 2.0, 3.0
DROP = 0.4  # relative standard deviation of the other runs below which a coarsest run is omitted ...
LEAST = 4  # ... if so many remain, and at least half of all
APART = 1.25  # minimum ratio of two sizes to show a change
CLEARLY = 0.5  # relative standard deviation below which two terms indicate an order at its lower limit
KNOWN_LOWEST = 0.25  # minimum order of known errors
TIE = 1e-9  # relative; smaller changes are round-off


@dataclasses.dataclass
class Fit:
    limit: float
    terms: list  # [(c, p)]: value(n) = limit + sum of c n^-p
    deviation: float  # standard deviation of the values from the fit; 0 if they determine it exactly
    safety: float  # F
    poor: float  # s / mean change if that is 1 or more, else 0
    runs: int  # number of runs used, the largest ones
    factor: float = 1.0  # factor of the error, from the scatter of known errors
    scale: float = 1.0  # by which limit, terms and deviation were divided
    seen: tuple = ()  # [(size, distance of the run from the limit)], decreasing with size

    def at(self, n):
        return self.limit + sum(c * n**-p for c, p in self.terms)

    def error(self, n):
        """Largest distance from the limit at this size and above, since a curve that crosses its limit is not exact
        there. Up to the largest run it is that of the runs, interpolated by powers, because coarse ones follow no
        order."""
        if self.seen and n < self.seen[-1][0]:
            x, y = np.log(np.array(self.seen)).T
            slope = min((y[1] - y[0]) / (x[1] - x[0]), 0.0)
            at = math.log(n)
            return math.exp(y[0] + slope * (at - x[0]) if at < x[0] else float(np.interp(at, x, y)))
        found = abs(self.at(n) - self.limit)
        if len(self.terms) == 2:
            (a, p), (b, q) = self.terms
            if a * b < 0:
                turn = (-b * q / (a * p)) ** (1 / (q - p))
                found = max(found, abs(self.at(turn) - self.limit)) if n < turn else found
        return found

    def passed(self, n, values):
        """Adds the distances of all runs from its limit, each at least that of the next larger run."""
        away = np.abs(values - self.limit)
        least = max(self.error(n[-1]), TIE * np.abs(values).max())
        return dataclasses.replace(self, seen=[(float(a), max(float(away[i:].max()), least)) for i, a in enumerate(n)])

    def bound(self, n):
        """Bound that the error does not exceed in 19 of 20 cases."""
        if self.poor:
            return POOR * self.poor * (self.error(n) + self.deviation)
        return self.safety * self.factor * self.error(n) + self.deviation

    @property
    def order(self):
        return self.terms[0][1]

    def size_for(self, target, of=None, largest=1e12):
        """Smallest size whose bound, or the result of `of`, is at most `target`. None if there is none up to `largest`,
        for example if the values scatter more."""
        of = of or self.bound
        if of(largest) > target:
            return None
        low, high = -20.0, math.log(largest)
        while high - low > 1e-7:
            middle = 0.5 * (low + high)
            low, high = (low, middle) if of(math.exp(middle)) <= target else (middle, high)
        return math.exp(high)


def solved(n, values, weights, orders):
    """Returns (limit, constants, standard deviation) of the least-squares fit with these orders."""
    scale = n[-1]  # the finest: columns of magnitude 1
    basis = np.column_stack([np.ones_like(n), *((n / scale) ** -p for p in orders)])
    root = np.sqrt(weights)
    found = np.linalg.lstsq(basis * root[:, None], values * root, rcond=None)[0]
    return (
        found[0],
        [float(c * scale**p) for c, p in zip(found[1:], orders)],
        float((weights * (basis @ found - values) ** 2).sum()),
    )


def deviation_of(squares, count, unknowns):
    return math.sqrt(count * squares / (count - unknowns)) if count > unknowns else 0.0


def one_term(n, values, weights, formal):
    """Returns (deviation, limit, terms, limit reached by the order: -1, 0, 1)."""

    def squares(p):
        return solved(n, values, weights, (p,))[2]

    highest = formal + ABOVE
    grid = np.linspace(LOWEST, highest, 31)
    best = int(np.argmin([squares(p) for p in grid]))
    order = minimize_scalar(
        squares,
        (grid[max(best - 1, 0)], grid[min(best + 1, 30)]),
        method="bounded",
        bounds=(grid[max(best - 1, 0)], grid[min(best + 1, 30)]),
        options={"xatol": 1e-8},
    ).x
    order = min((order, LOWEST, highest), key=squares)
    border = -1 if order < LOWEST + 1e-6 else 1 if order > highest - 1e-6 else 0
    limit, constants, left = solved(n, values, weights, (order,))
    return deviation_of(left, len(n), 2 if border else 3), limit, [(constants[0], float(order))], border


def two_terms(n, values, weights):
    limit, constants, left = solved(n, values, weights, (1, 2))
    return deviation_of(left, len(n), 3), limit, list(zip(constants, (1.0, 2.0))), 0


def apart(n):
    """Largest size and those with sufficient ratios to it, because noise would dominate between similar sizes."""
    chosen = [len(n) - 1]
    for i in range(len(n) - 2, -1, -1):
        if n[i] * APART <= n[chosen[-1]]:
            chosen.append(i)
    return chosen[::-1]


def turns(n, values):
    changes = np.diff(values[apart(n)])
    return bool(np.any(changes[1:] * changes[:-1] < 0))


def beyond(n, values, order):
    """Returns true if all changes decrease faster than this order, as for meshes that are too coarse."""
    n, values = n[apart(n)], values[apart(n)]
    changes, expected = np.abs(np.diff(values)), np.abs(np.diff(n ** -float(order)))
    return len(n) > 2 and bool(np.all(changes[1:] * expected[:-1] < changes[:-1] * expected[1:]))


def fit_runs(n, values, formal):
    """Fit of all these runs with normalized weights."""
    alike, weighted = np.full(len(n), 1 / len(n)), n / n.sum()
    best = min((one_term(n, values, w, formal) for w in (alike, weighted)), key=lambda f: f[0])
    if len(n) >= LEAST and formal > 1 and (turns(n, values) or best[-1] < 0):
        two = min((two_terms(n, values, w) for w in (alike, weighted)), key=lambda f: f[0])
        best = two if two[0] < best[0] * (1 if turns(n, values) else CLEARLY) else best
    deviation, limit, terms, border = best
    if border > 0 and beyond(
        n, values, formal + 1
    ):  # for faster decreasing changes the formal order through the two finest overestimates the error
        constant = (values[-2] - values[-1]) / (n[-2] ** -formal - n[-1] ** -formal)
        deviation, limit, terms = 0.0, values[-1] - constant * n[-1] ** -formal, [(float(constant), formal)]
    change = (values.max() - values.min()) / (len(n) - 1)
    poor = deviation / change if deviation >= change > 0 else 0.0
    doubtful = border < 0 or turns(n, values) or len(terms) > 1
    safety = POOR if doubtful else STEEP if border > 0 and beyond(n, values, formal + 1) else SAFETY
    return Fit(float(limit), terms, deviation, safety, poor, len(n))


def diverges(n, values):
    """Reason why three or more runs show no limit. Empty if they may have one."""
    n, values = n[apart(n)], values[apart(n)]
    if len(n) < 3:
        return "its sizes are too close to each other to show an order"
    changes, steps = np.diff(values), np.diff(np.log(n))
    if turns(n[-3:], values[-3:]):
        if len(values) < LEAST:
            return ""  # one more run may show more
        half = len(changes) // 2
        early, late = np.abs(changes[:half]).max(), np.abs(changes[half:]).max()
        return (
            f"its values alternate and do not settle (changes of {early:.2g}, then {late:.2g})" if late > early else ""
        )
    if changes[-2] * changes[-1] > 0 and abs(changes[-1] / steps[-1]) >= abs(changes[-2] / steps[-2]):
        return f"its values diverge with the size (changes of {abs(changes[-2]):.2g}, then {abs(changes[-1]):.2g})"
    return ""


def of_values(sizes, values, formal=2.0):
    """Returns (Fit, "") of a series with unknown limit, or (None, reason)."""
    n, values = np.array(sizes, float), np.array(values, float)
    if len(n) < 3:
        return None, f"{len(n)} run{'s' if len(n) != 1 else ''} show no order; three are needed"
    if np.ptp(values) <= TIE * np.abs(values).max():  # equal values show no change
        return Fit(float(values[-1]), [(0.0, formal)], float(np.ptp(values)), SAFETY, 0.0, len(n)), ""
    reason = diverges(n, values)
    if reason:
        return None, reason
    best = fit_runs(n, values, formal)
    unclear = best.safety > SAFETY or beyond(n, values, formal)
    for first in range(1, len(n) // 2 + 1):  # omits runs that are too coarse for their order
        least = (
            3 if unclear and beyond(n[first:], values[first:], formal) else LEAST
        )  # three runs suffice for such fast changes
        if len(n) - first < least or best.deviation <= TIE * np.ptp(values) or diverges(n[first:], values[first:]):
            continue
        fewer = fit_runs(n[first:], values[first:], formal)
        if fewer.deviation < DROP * best.deviation:
            best = fewer
    return best.passed(n, values), ""


def settled(sizes, errors, formal):
    """Sizes of known errors without those that are small by chance near a change of sign: each error is at least a
    later one, or the error before the change reduced by the formal order."""
    found = [abs(e) for e in errors]
    for i in range(1, len(found)):
        if errors[i] * errors[i - 1] < 0:
            found[i] = max(found[i], found[i - 1] * (sizes[i - 1] / sizes[i]) ** formal)
    return [max(found[i:]) for i in range(len(found))]


def of_errors(sizes, errors, formal=2.0):
    """Returns (Fit, "") of a series with known (signed or unsigned) errors, or (None, reason): a power law of the
    finest three or four runs."""
    if len(sizes) < 2:
        return None, "one run shows no order; two are needed"
    if not any(errors):
        return Fit(0.0, [(0.0, formal)], 0.0, 1.0, 0.0, len(sizes)), ""
    n, e = np.array(sizes, float)[-LEAST:], np.array(settled(sizes, errors, formal))[-LEAST:]
    e = np.maximum(e, 1e-16 * e.max())
    for first in range(max(1, len(n) - 2)):
        x, y, w = np.log(n[first:] / n[-1]), np.log(e[first:]), n[first:] / n[first:].sum()
        (minus, level), count = np.polyfit(x, y, 1, w=np.sqrt(w)), len(n) - first
        scatter = math.sqrt(count * float((w * (level + minus * x - y) ** 2).sum()) / (count - 2)) if count > 2 else 0.0
        if scatter < 0.1:
            break
    order = min(-float(minus), formal + 1)
    if order < KNOWN_LOWEST:
        return None, f"its error does not decrease with size ({e[-2]:.2g}, then {e[-1]:.2g})"
    level = max(level, math.log(e[-1]))  # at least through the finest
    return (
        Fit(0.0, [(math.exp(level) * float(n[-1]) ** order, order)], 0.0, 1.0, 0.0, count, math.exp(min(scatter, 1.0))),
        "",
    )


# -- three runs
# ----------------------------------------------------------------------------------------------------------
@dataclasses.dataclass
class Limit:
    value: float  # extrapolated
    order: float  # observed
    gci: float  # uncertainty of the finest value, absolute


def limit_of(sizes, values, lowest=0.2, highest=8):
    """Limit of the three finest runs. None if changes do not decrease, or alternate."""
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
    value = v3 - (v2 - v3) / (n2**-order - n3**-order) * n3**-order
    return Limit(value, order, SAFETY * abs(value - v3))


def slope(x, y):
    """Exponent of a power law by least squares of logarithms. None with fewer than two points."""
    good = [(a, b) for a, b in zip(x, y) if a > 0 and b > 0]
    if len(good) < 2 or len({a for a, _ in good}) < 2:
        return None
    return float(np.polyfit(*np.log(np.array(good)).T, 1)[0])


def pareto(points):
    """Returns (cost, error) pairs that no other pair beats in both, sorted by cost."""
    best, front = math.inf, []
    for cost, error in sorted(points):
        if error < best:
            best = error
            front.append((cost, error))
    return front
