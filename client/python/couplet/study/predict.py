# SPDX-License-Identifier: Apache-2.0
"""The cheapest setting for an error that is asked for, predicted from few cheap runs, then run.

Of each series (combination of all axes but the refinement) the smallest sizes are run; value(n) = limit + C n^-p gives the size
that meets the target (for quantities that are errors themselves: error(n) = C n^-p), seconds(n) = a + b n^q its cost. The
series of the least predicted cost goes on with larger sizes until the answer is near enough to be trusted."""
import json
import math
import re

import numpy as np

from couplet.runs import expect
from couplet.study import table
from couplet.study.convergence import Limit, limit_of

AIM = 0.75      # of the target: the prediction may be off both ways
NEAR = 1.6      # the final size over the largest that was tried, at most, before it is run ...
NEAR_CHEAP = 1.3  # ... where it takes less than CHEAP: a run more costs nothing, and start-up hides the work of small runs
TOO_GOOD = 0.4  # of the target: a run that is there and leaves less is no answer where a smaller size would do
GROWTH = 1.4    # of the sizes tried
DOWN = 2        # a size below all that were tried is at most so much smaller: errors of coarse runs follow no power
APART = 1.25    # ratio of two sizes that an order is read from, at least
PATIENCE = 9    # runs of one series
BUDGET = 1.3    # seconds spent before the final run over its own, where that takes longer than CHEAP
CHEAP = 10.0    # [s]


def target_of(text):
    number = re.fullmatch(r"\s*([0-9.eE+-]+)\s*(%?)\s*", text)
    expect(number, f"--for-error {text}: expected a number, or per cent such as 1%.")
    value = float(number.group(1)) / (100 if number.group(2) else 1)
    expect(0 < value < math.inf, f"--for-error {text}: expected a number above 0.")
    return value


def telling(seconds):
    """Which runs tell of larger ones: not those that cost more than a larger one, with another solver or on a busy machine."""
    return [i for i, t in enumerate(seconds) if all(t <= 1.05 * later for later in seconds[i + 1:])]


def power_cost(sizes, seconds):
    """(a, b, q) of a + b n^q, start-up and work, neither negative, least squares of the relative misfit; the latest runs say most."""
    keep = telling(seconds)
    n, t = np.array(sizes, float)[keep], np.array(seconds, float)[keep]
    best = None
    for q in np.arange(0.5, 5.01, 0.05):
        basis = np.column_stack([np.ones_like(n), (n / n[-1])**q]) / t[:, None]
        weight = np.sqrt(n / n[-1])[:, None]
        ab = np.linalg.lstsq(basis * weight, weight[:, 0], rcond=None)[0]
        if ab[0] < 0:  # no start-up to be seen
            ab = np.array([0, 1 / basis[:, 1].mean()])
        if len(n) < 2 or ab[1] <= 0:
            continue
        misfit = float((((basis @ ab - 1) * weight[:, 0]) ** 2).sum()) + 1e-3 * (q - 3) ** 2  # undecided: as a solver in space
        if best is None or misfit < best[0]:
            best = (misfit, ab[0], ab[1] / n[-1]**q, q)
    return best[1:] if best else (float(t[-1]), 0.0, 1.0)


def apart(rows):
    """Of runs by size the largest and those that are far enough below each other to show an order: between sizes that nearly agree
    the values' noise would decide."""
    chosen = rows[-1:]
    for row in reversed(rows[:-1]):
        if row.point.size * APART <= chosen[0].point.size:
            chosen.insert(0, row)
    return chosen


class Series:
    """One curve: the runs of growing size of one combination."""

    def __init__(self, study, quantity, labels):
        self.study, self.quantity, self.labels, self.rows = study, quantity, labels, []
        self.coarse = 0  # the largest size that was seen to leave too much
        self.name = ", ".join(v for k, v in labels.items() if k != study.axes.refining.name) or "the case"

    def sizes(self):
        return [r.point.size for r in self.rows]

    def add(self, size, say):
        label = f"{size:g}"
        point = self.study.axes.point({**self.labels, self.study.axes.refining.name: label}, size)
        row, = self.study.run([point], 1, False, say)
        if row.good:
            self.rows = sorted([*self.rows, row], key=lambda r: r.point.size)
        return row

    def model(self):
        """Limit by which errors fall; None while there is none. Relative errors have a limit of size 1."""
        rows = apart(self.rows)
        sizes, values = [r.point.size for r in rows], [r.values[self.quantity.name] for r in rows]
        if not self.quantity.is_error:
            found = limit_of(sizes, values)
            if found is None:
                return None
            scale = 1 if self.quantity.given.get("absolute") else abs(found.value)
            return Limit(found.value, found.order, found.constant / scale, found.gci / scale) if scale else None
        (n1, n2), (e1, e2) = sizes[-2:], values[-2:]
        if not 0 < abs(e2) < abs(e1):
            return None
        order = math.log(abs(e1 / e2)) / math.log(n2 / n1)
        return Limit(0.0, order, abs(e2) * n2**order, 0.0)

    def left(self, row):
        """Error of a run: its distance from the limit of the finest ones (of those it is the model's); None without a model."""
        value, model = row.values[self.quantity.name], self.model()
        if self.quantity.is_error or model is None:
            return abs(value) if self.quantity.is_error else None
        return abs(value - model.value) / (1 if self.quantity.given.get("absolute") else abs(model.value))

    def scatter(self):
        """What noise may make of the limit, over its size: by how much the larger half of the sizes turn back against the way that all values
        go, times what an extrapolation over APART makes of it."""
        model, rows = self.model(), [r for r in self.rows if 2 * r.point.size >= self.rows[-1].point.size]
        if self.quantity.is_error or model is None or len(rows) < 3:
            return 0.0
        values = [r.values[self.quantity.name] for r in rows]
        way = math.copysign(1, self.rows[-1].values[self.quantity.name] - self.rows[0].values[self.quantity.name])
        back = max(way * (a - b) for i, a in enumerate(values) for b in values[i:])
        scale = 1 if self.quantity.given.get("absolute") else abs(model.value)
        return back * (1 + 1 / (APART**min(max(model.order, 1), 2) - 1)) / scale

    def seconds(self, size):
        a, b, q = power_cost(self.sizes(), [getattr(r.record, self.study.clock) for r in self.rows])
        nearest = min(self.rows, key=lambda r: abs(math.log(r.point.size / size)))
        # through the nearest run: its misfit is that of this one, too
        scale = getattr(nearest.record, self.study.clock) / (a + b * nearest.point.size**q)
        return scale * (a + b * size**q)

    def spent(self):
        return sum(getattr(r.record, self.study.clock) for r in self.rows)

    def predict(self, target):
        """(size, error, seconds) that meets the target; None while there is no model."""
        model = self.model()
        if model is None:
            return None
        size = self.size_between(max(model.size_for(AIM * target), self.least(target)))
        return size, model.error(size), self.seconds(size)

    def least(self, target):
        """The smallest size that may be tried: below all that were run only where the smallest of them is far better than asked."""
        smallest = self.rows[0]
        return smallest.point.size / (DOWN if self.left(smallest) < TOO_GOOD * target else 1)

    def size_between(self, size):
        """A size that may be run; above those that were seen to leave too much, half-way to the next run."""
        rounded = self.study.axes.refining.round
        if size > self.coarse or not self.coarse:
            return rounded(size, up=True)
        above = next((n for n in self.sizes() if n > self.coarse), GROWTH * self.coarse)
        between = rounded(math.sqrt(self.coarse * above), up=True)
        return min(between, above) if between > self.coarse else above


def started(study, quantity, say):
    """All series with the three smallest sizes each."""
    refining, found = study.axes.refining, {}
    for point in study.axes.points():
        labels = {k: v for k, v in point.labels.items() if k != refining.name}
        found.setdefault(tuple(labels.items()), Series(study, quantity, labels))
    for series in found.values():
        for size in sorted(refining.sizes.values())[:3]:
            row = series.add(size, say)
            if not row.good:
                say(f"{series.name}: left out, as its run of size {size:g} failed: {row.reason}")
                break
    return [s for s in found.values() if len(s.rows) >= 3]


def for_error(study, text, name, say):
    target = target_of(text)
    expect(study.axes.refining, f"{study.case.file}: --for-error needs an axis with 'sizes'.")
    names = [q.name for q in study.quantities]
    quantity = next((q for q in study.quantities if q.name == (name or names[0])), None)
    expect(quantity, f"--quantity {name}: there is no such quantity; there are: {', '.join(names)}.")
    every = started(study, quantity, say)
    expect(every, "no series could be run on its three smallest sizes.")
    best, final, predicted = approach(every, target, say)
    result = said(study, quantity, best, every, target, final, predicted)
    (study.out / f"for-error-{quantity.name.replace(' ', '-')}-{text.strip().replace('%', 'pc')}.json").write_text(json.dumps(result, indent=1, default=lambda v: v.item()))
    for line in result["lines"]:
        say(line)
    return 0 if result["met"] else 1


def cheapest(every, target):
    """The series of the least predicted seconds, with its prediction; (first series, None) while none has a model."""
    priced = [(p[2], i, p) for i, s in enumerate(every) if (p := s.predict(target))]
    return (every[min(priced)[1]], min(priced)[2]) if priced else (every[0], None)


def known(series, row):
    """Of a run that is there: (size, error, seconds)."""
    return row.point.size, series.left(row), getattr(row.record, series.study.clock)


def fitting(series, predicted, target, say):
    """A run of the very size between those that are there, where the next larger one would be far better than asked; None where
    it would not, or the run fails."""
    there = next(r for r in series.rows if r.point.size >= predicted[0])
    if there.point.size == predicted[0] or series.left(there) >= TOO_GOOD * target:
        return None
    say(f"{series.name}: size {there.point.size:g} would be better than asked; size {predicted[0]:g} should do in {predicted[2]:.3g} s")
    row = series.add(predicted[0], say)
    return row if row.good else None


def approach(every, target, say):
    """Larger and larger runs of whichever series looks cheapest, until one meets the target; (series, row or None, what was
    predicted for it)."""
    for _ in range(PATIENCE + 2 * len(every)):
        series, predicted = cheapest(every, target)
        largest, refining = series.sizes()[-1], series.study.axes.refining
        if predicted and predicted[0] <= largest:  # a run that is there meets it
            row = fitting(series, predicted, target, say)
            if row and series.left(row) is None:  # it has shown that there is no limit to go by
                return series, row, predicted
            if row and series.left(row) > 1.1 * target:
                say(f"it leaves {series.left(row):.2g}, more than asked: back")
                series.coarse = max(series.coarse, row.point.size)
                continue
            if row and series.left(row) < TOO_GOOD * target and series.predict(target)[0] < row.point.size:
                continue
            if row:
                return series, row, predicted if row.point.size == predicted[0] else known(series, row)
            row = next(r for r in series.rows if r.point.size >= predicted[0])
            return series, row, known(series, row)
        following = refining.round(GROWTH * largest, up=True)
        spent = sum(s.spent() for s in every)
        dear = predicted and predicted[2] > CHEAP and spent + series.seconds(following) > BUDGET * predicted[2]
        near = NEAR if predicted and predicted[2] > CHEAP else NEAR_CHEAP
        last = predicted and (predicted[0] <= near * largest or following >= predicted[0] or dear)
        if predicted:
            say(f"{series.name}: size {predicted[0]:g} should leave an error of {predicted[1]:.2g} and take {predicted[2]:.3g} s")
        row = series.add(predicted[0] if last else following, say)
        if not row.good:
            say(f"the run failed, its series is left out: {row.reason}")
            every = [s for s in every if s is not series]
            if not every:
                return series, None, predicted
            continue
        if last:
            after = series.model()
            if after and after.error(row.point.size) < TOO_GOOD * target and series.predict(target)[0] < row.point.size:
                continue  # what it has shown says that a smaller size does
            if after is None or after.error(row.point.size) <= 1.1 * target:
                return series, row, predicted
            say(f"it leaves {after.error(row.point.size):.2g}, more than predicted: on")
    return series, None, predicted


def said(study, quantity, best, every, target, final, predicted):
    """The result as numbers and as lines."""
    spent = sum(s.spent() for s in every)
    if final is None:
        return {"met": False, "target": target, "lines": [f"No setting was found for an error of {target:.3g}: after {len(best.rows)} runs the values "
                                                          "do not approach a limit, or a run failed. A finer start may help."]}
    table.set_errors([final], [quantity]) if quantity.is_error or isinstance(quantity.reference, (int, float)) else None
    true, model = final.errors.get(quantity.name), best.model()
    seconds = getattr(final.record, study.clock)
    estimate = best.left(final) if model else None
    noise = best.scatter() if true is None else 0
    reached = true if true is not None else estimate if estimate is None else max(estimate, noise)
    settings = ", ".join(f"{k}={v}" for k, v in final.point.changes.items())
    if reached is None:  # the last run has shown that there is no limit yet
        return {"met": False, "target": target, "lines": [f"No setting was found for an error of {target:.3g}: with the last run, {best.name}, size {final.point.size:g}, which "
                                                          "should have met it, the values approach no limit any more. A finer start may help."]}
    lines = [f"Cheapest for {quantity.name} to {target:.3g}: {best.name}, size {final.point.size:g} ({settings})",
             f"error: {reached:.3g} {'against the reference' if true is not None else 'by extrapolation'} (predicted {predicted[1]:.3g}"
             + (f", estimated afterwards {estimate:.3g})" if estimate is not None else ")")
             + ("; by as much the values of nearby sizes scatter, which an extrapolation cannot see through" if estimate is not None and noise > estimate else ""),
             f"time: {seconds:.3g} s (predicted {predicted[2]:.3g} s); the runs before it took {spent - seconds:.3g} s"]
    return {"met": reached <= 1.1 * target, "target": target, "quantity": quantity.name, "series": best.name,
            "size": final.point.size, "predicted error": predicted[1], "predicted seconds": predicted[2], "error": reached, "estimate": estimate,
            "seconds": seconds, "before": spent - seconds, "lines": lines}
