# SPDX-License-Identifier: Apache-2.0
"""Error of a run as it can be known without the truth, from it and the next coarser ones, beside the true one."""
from couplet_study import table
from couplet_study.convergence import limit_of

ORDER = 2  # of the schemes, where three runs say nothing


def of(rows, quantity):
    """[(estimated, true, name of the run)] of the runs that have coarser ones, for quantities with a reference of their own (a
    number): with three runs by the observed order, with two by the schemes' second order."""
    if quantity.is_error or not isinstance(quantity.reference, (int, float)):
        return []
    found, scale = [], 1 if quantity.given.get("absolute") else abs(quantity.reference)
    for some in table.series_of(rows).values():
        sizes, values = [r.point.size for r in some], [r.values[quantity.name] for r in some]
        for i in range(1, len(some)):
            limit = limit_of(sizes[max(0, i - 2):i + 1], values[max(0, i - 2):i + 1])
            guess = abs(values[i] - limit.value) if limit else abs(values[i] - values[i - 1]) / ((sizes[i] / sizes[i - 1])**ORDER - 1)
            true = some[i].errors.get(quantity.name, 0)
            if guess > 0 and true > 0:
                found.append((guess / scale, true, some[i].point.name))
    return found
