# SPDX-License-Identifier: Apache-2.0
"""Estimated error of a run without the true solution, from the run itself and coarser ones, for comparison with the
true error.

The first estimate is the change from the next coarser run of the series over r^p - 1, with the ratio r of their sizes
and the order p of the schemes (2, or `orders` of the quantity for a series with that word in its name). With two
coarser runs a second estimate uses their observed order (from 1/2 to 3), and the geometric mean of both counts. A fixed
order underestimates on meshes that are too coarse, an observed one if changes happen to be alike. With one coarser run
no order is observed, and coarse meshes fall short of p, so the mean uses one order less instead. Other series reveal
constant errors, such as that of the time step: an error is at least the distance to a run that is no finer and has a
smaller estimate, minus that estimate (triangle inequality). That run needs as many coarser ones, or three, because a
single change may be small by chance."""
import math

from couplet.study import fits, table

ORDER = 2
ENOUGH = 3  # coarser runs for a reliable estimate
LOWEST, HIGHEST = (
    0.5,
    3,
)  # accepted observed orders: even cells may exceed the order of their schemes. Chosen on the committed studies:
# with a highest of 2 they have 191 of 240 runs within a factor of 2, with 3 or 4 195; with a lowest of 1 the same
CLEAR = 4  # multiple of its own uncertainty that a true error must have if the reference is the study's own best value


def order_of(name, orders=None):
    """Order of the schemes of a series."""
    return next((float(p) for word, p in (orders or {}).items() if word in name.split(", ")), ORDER)


def of_series(sizes, values, i, order):
    """Estimate for run i from the one or two next coarser ones."""
    ratio, change = sizes[i] / sizes[i - 1], abs(values[i] - values[i - 1])
    plain = change / (ratio**order - 1)
    if i < 2:
        return math.sqrt(plain * change / (ratio ** max(order - 1, min(order, 1)) - 1))
    before = values[i - 1] - values[i - 2]
    if (values[i] - values[i - 1]) * before <= 0:  # oscillating: uses the larger change
        return max(plain, abs(before) / (ratio**order - 1))
    limit = fits.limit_of(sizes[i - 2 : i + 1], values[i - 2 : i + 1], 0.1)
    shown = limit.order if limit else (LOWEST if 2 * change >= abs(before) else order)
    return math.sqrt(plain * change / (ratio ** min(max(shown, LOWEST), max(order, HIGHEST)) - 1))


def guesses(series, orders=None):
    """Returns {(name, i): estimated error} of {name: (sizes, values)} with ascending sizes. The coarsest run of each
    series has none."""
    own = {
        (name, i): of_series(*series[name], i, order_of(name, orders))
        for name in series
        for i in range(1, len(series[name][0]))
    }
    found = {}
    for (name, i), guess in own.items():
        size, value = series[name][0][i], series[name][1][i]
        others = [
            (g, series[n][1][j])
            for (n, j), g in own.items()
            if n != name and series[n][0][j] <= size and j >= min(ENOUGH, i)
        ]
        best = min(others, default=None)
        found[name, i] = max(guess, abs(value - best[1]) - best[0]) if best and best[0] < guess else guess
    return found


def uncertainty(rows, quantity):
    """Relative uncertainty of the reference if it is the study's own best value or has a stated accuracy; else 0."""
    if quantity.is_error or isinstance(quantity.reference, (int, float)):
        return float(quantity.given.get("good-to", 0))
    limits = [
        (max(r.point.size for r in some), limit.gci / (quantity.size(limit.value, some[-1]) or 1))
        for some, limit in ((table.series_of(rows)[s], limit) for s, limit in table.limits_of(rows, quantity).items())
        if limit
    ]
    if quantity.reference == "finest" or not limits:
        good = [r for r in rows if r.good]
        if not good:  # nothing to compare; the table of all runs states the reason
            return math.inf
        finest = max(r.point.size for r in good)
        others = [
            r.errors[quantity.name] for r in good if r.point.size == finest and r.errors.get(quantity.name, 0) > 0
        ]
        return min(others, default=math.inf)
    return min(limits, key=lambda pair: (-pair[0], pair[1]))[1]


def of(rows, quantity, clear=CLEAR):
    """Returns [(estimated, true, name of the run)] of runs with coarser ones. The distance from an exact field has the
    true value 0. If the reference is the study's own best value, only runs whose distance clearly exceeds its
    uncertainty are included."""
    if not quantity.is_error and quantity.reference is None:
        return []
    runs = table.series_of(rows)
    series = {
        name: ([r.point.size for r in some], [r.values[quantity.name] for r in some]) for name, some in runs.items()
    }
    least, found = clear * uncertainty(rows, quantity) if clear else 0, []
    for (name, i), guess in guesses(series, quantity.given.get("orders")).items():
        row = runs[name][i]
        true = row.errors.get(quantity.name, 0)
        if not true > least or not guess > 0:
            continue
        size = quantity.reference if isinstance(quantity.reference, (int, float)) else series[name][1][-1]
        found.append((guess if quantity.is_error else guess / (quantity.size(size, row) or 1), true, row.point.name))
    return found


def inside(found):
    """Number of estimates within a factor of 2."""
    return sum(0.5 <= e / t <= 2 for e, t, _ in found)
