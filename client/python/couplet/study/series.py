# SPDX-License-Identifier: Apache-2.0
"""One curve of --for-error: runs of growing size of one combination, their errors, and predicted errors and costs."""
import dataclasses
import math

import numpy as np

from couplet.study import estimates, fits

AIM, AIM_BOUND = 0.9, 1.2  # of the target: error and bound that determine a size
ENOUGH, SURE = 1.1, 1.35  # of the target: error and bound of an accepted run
DOWN = 2  # maximum reduction below all sizes that were run, since errors of coarse runs follow no power law
FARTHEST = 64  # maximum ratio of a predicted size to the largest that was run
GROWTH = 1.4  # ratio of the tried sizes
NOISE = 0.5  # of the target: maximum standard deviation of values from their fit
STRIDE = 1.25  # factor of the size after two predictions with too large errors
FEW = 4  # number of runs up to which the order may be that of coarse runs
# Largest distance of the observed order from the formal one, and ratio of extrapolated and estimated error, that
# confirm a run.
ORDER_OFF, OWN_OFF = 0.5, 2
ROUNDS = 12  # maximum number of runs of one series


@dataclasses.dataclass
class Prediction:
    """Size that meets a target."""

    size: float
    error: float  # expected
    bound: float
    seconds: float
    cheap: float  # seconds of the size whose expected error is the target, by the formal order if that is less, and ...
    costly: float  # ... of the size with a third of that error


@dataclasses.dataclass
class Refusal:
    """Reason why a series has no prediction. `hopeful` if more runs may give one."""

    reason: str
    hopeful: bool = True


def telling(seconds):
    """Flags runs that predict larger ones. Excludes those that cost more than a larger run (another solver or a busy
    machine)."""
    return [i for i, t in enumerate(seconds) if all(t <= 1.05 * later for later in seconds[i + 1 :])]


def power_cost(sizes, seconds):
    """Returns (a, b, q) of a + b n^q (startup and work), nonnegative, by least squares of the relative misfit, weighted
    to the latest runs."""
    keep = telling(seconds)
    n, t = np.array(sizes, float)[keep], np.array(seconds, float)[keep]
    best = None
    for q in np.arange(0.5, 5.01, 0.05):
        basis = np.column_stack([np.ones_like(n), (n / n[-1]) ** q]) / t[:, None]
        weight = np.sqrt(n / n[-1])[:, None]
        ab = np.linalg.lstsq(basis * weight, weight[:, 0], rcond=None)[0]
        if ab[0] < 0:  # no startup is visible
            ab = np.array([0, 1 / basis[:, 1].mean()])
        if len(n) < 2 or ab[1] <= 0:
            continue
        misfit = (
            float((((basis @ ab - 1) * weight[:, 0]) ** 2).sum()) + 1e-3 * (q - 3) ** 2
        )  # favors the cost of a solver in 3-D if undecided
        if best is None or misfit < best[0]:
            best = (misfit, ab[0], ab[1] / n[-1] ** q, q)
    return best[1:] if best else (float(t[-1]), 0.0, 1.0)


class Series:
    def __init__(self, study, quantity, labels):
        self.study, self.quantity, self.labels, self.rows = study, quantity, labels, []
        self.name = ", ".join(v for k, v in labels.items() if k != study.axes.refining.name) or "the case"
        self.formal = estimates.order_of(self.name, quantity.given.get("orders"))
        self.failed = ""  # reason to stop running it
        self.short = ""  # reason why its third size was skipped
        self.fitted = {}  # by the number of runs
        self.misses = 0  # runs of a predicted size with too large errors

    # -- runs
    def sizes(self):
        return [r.point.size for r in self.rows]

    def add(self, size, say):
        point = self.study.axes.point({**self.labels, self.study.axes.refining.name: f"{size:g}"}, size)
        (row,) = self.study.run([point], 1, False, say)
        if row.good:
            self.rows = sorted([*self.rows, row], key=lambda r: r.point.size)
        else:
            self.failed = f"its run of size {size:g} failed: {row.reason}"
        return row

    def cost(self, row):
        return getattr(row.record, self.study.clock)

    def spent(self):
        return sum(self.cost(r) for r in self.rows)

    def seconds(self, size):
        if len(self.rows) < 2:
            return self.cost(self.rows[-1]) * max(1, size / self.rows[-1].point.size)
        a, b, q = power_cost(self.sizes(), [self.cost(r) for r in self.rows])
        nearest = min(self.rows, key=lambda r: abs(math.log(r.point.size / size)))
        # passes through the nearest run, whose misfit also applies to this one
        return self.cost(nearest) / (a + b * nearest.point.size**q) * (a + b * size**q)

    # -- errors
    @property
    def known(self):
        """Returns true if errors are known without extrapolation."""
        return self.quantity.is_error or isinstance(self.quantity.reference, (int, float))

    def values(self):
        """Errors if they are known, else values."""
        return [self.exact(r) if self.known else r.values[self.quantity.name] for r in self.rows]

    def exact(self, row):
        value, reference = row.values[self.quantity.name], self.quantity.reference
        if self.quantity.is_error:
            return value
        return (value - reference) / (self.quantity.size(reference, row) or 1)

    def fit(self):
        if len(self.rows) not in self.fitted:
            self.fitted = {len(self.rows): self.fit_of_all()}
        return self.fitted[len(self.rows)]

    def fit_of_all(self):
        """Returns (Fit, "") or (None, reason), of relative errors if the quantity has them."""
        if self.known:
            return fits.of_errors(self.sizes(), self.values(), self.formal)
        found, reason = fits.of_values(self.sizes(), self.values(), self.formal)
        if found is None or self.quantity.given.get("absolute"):
            return found, reason
        scale = self.quantity.size(found.limit, self.rows[-1])
        if scale <= found.deviation:
            return (
                None,
                (
                    "its limit is close to 0, so relative errors are meaningless (`absolute: true` asks for the"
                    " difference itself)"
                ),
            )
        return (
            dataclasses.replace(
                found,
                limit=found.limit / scale,
                terms=[(c / scale, p) for c, p in found.terms],
                deviation=found.deviation / scale,
                scale=scale,
                seen=[(n, e / scale) for n, e in found.seen],
            ),
            "",
        )

    def left(self, row):
        """Returns (error, bound) of a run. None without a fit."""
        if self.known:
            index = self.rows.index(row)
            return (fits.settled(self.sizes(), self.values(), self.formal)[index],) * 2
        fit, _ = self.fit()
        if fit is None:
            return None
        return fit.error(row.point.size), fit.bound(row.point.size)

    def meets(self, row, target):
        """Returns true if a run meets the target. Three runs may show the formal order by chance, so an estimated error
        needs a fourth."""
        if not self.known and len(self.rows) < fits.LEAST and not self.short:
            return False
        left = self.left(row)
        return (
            left is not None
            and left[0] <= ENOUGH * target
            and left[1] <= SURE * target
            and self.scatter() <= NOISE * target
        )

    def doubt(self, row):
        """Reason why nothing confirms the extrapolated error of a run: neither the order of the last three sizes nor
        the run's own estimate. Empty if one of them does, or if the error is known."""
        left = self.left(row)
        if left is None:
            return self.fit()[1]
        error = left[0]
        if self.known or error == 0:
            return ""
        last = fits.apart(np.array(self.sizes(), float))[-3:]
        limit = fits.limit_of([self.sizes()[i] for i in last], [self.values()[i] for i in last])
        if limit and abs(limit.order - self.formal) <= ORDER_OFF:
            return ""
        own = 0 if self.quantity.given.get("absolute") else row.own
        if own and 1 / OWN_OFF <= error / own <= OWN_OFF:
            return ""
        shown = (
            f"the last three sizes show order {limit.order:.2g} instead of {self.formal:g}"
            if limit
            else "the last three sizes show no order"
        )
        return (
            f"{shown}, and the run itself estimates {own:.2g} instead of {error:.2g}"
            if own
            else f"{shown}, and the run has no estimate of its own"
        )

    def agree(self, row, finer):
        """Returns true if the difference of a run from a finer one confirms its extrapolated error."""
        name = self.quantity.name
        apart = abs(row.values[name] - finer.values[name]) / (self.quantity.size(finer.values[name], finer) or 1)
        left = self.left(row)
        return left is not None and apart > 0 and 1 / OWN_OFF <= left[0] / apart <= OWN_OFF

    def scatter(self):
        return 0.0 if self.known or (fit := self.fit()[0]) is None else fit.deviation

    # -- what a target needs
    def predict(self, target):
        """Returns a Prediction or Refusal."""
        if self.failed:
            there = next((r for r in self.rows if self.meets(r, target)), None)
            return (
                Prediction(there.point.size, *self.left(there), *[self.cost(there)] * 3)
                if there
                else Refusal(self.failed, False)
            )
        fit, reason = self.fit()
        if fit is None:
            return Refusal(self.short if self.short and len(self.rows) < 3 else reason)
        largest, timeout = self.sizes()[-1], float(self.study.section.get("timeout", 3600))
        wanted = fit.size_for(target, lambda n: max(fit.error(n) * fit.factor / AIM, fit.bound(n) / AIM_BOUND))
        if wanted is None or self.scatter() > NOISE * target:
            return Refusal(
                "its values scatter: the error's bound does not fall below"
                f" {max(fit.bound(1e12), self.scatter() / NOISE):.2g}"
            )
        if wanted > FARTHEST * largest:
            return Refusal(
                f"it would need a size of over {FARTHEST} times the largest that was run, {largest:g}: too far for a"
                " prediction"
            )
        size = self.size_between(max(wanted, self.rows[0].point.size / DOWN), target)
        seconds = self.seconds(size)
        if seconds > timeout:
            return Refusal(
                f"size {size:g} would take about {seconds:.2g} s, longer than a run may take ({timeout:g} s, `timeout`)"
            )
        ends = fit.size_for(target, fit.error), fit.size_for(target, lambda n: fits.POOR * fit.error(n) + fit.deviation)
        cheap, costly = (self.seconds(n) if n and n <= FARTHEST * largest else math.inf for n in ends)
        return Prediction(
            size,
            fit.error(size),
            fit.bound(size),
            seconds,
            min(cheap, seconds, self.at_best(target, fit.scale)),
            max(costly, seconds),
        )

    def at_best(self, target, scale):
        """Seconds if the two finest of few runs followed the formal order, since coarse runs may show a lower one."""
        if self.known or len(self.rows) > FEW:
            return math.inf
        (n1, n2), (v1, v2) = self.sizes()[-2:], self.values()[-2:]
        constant = abs(v2 - v1) / scale / abs(n1**-self.formal - n2**-self.formal)
        return self.seconds(max((constant / target) ** (1 / self.formal), self.rows[0].point.size))

    def size_between(self, wanted, target):
        """Permitted size: that of a run that meets the target, or one above all that do not."""
        rounded, above = self.study.axes.refining.round, [r for r in self.rows if r.point.size >= wanted - 1e-9]
        refused = max((r.point.size for r in self.rows if not self.meets(r, target)), default=0)
        size = rounded(wanted, up=True)
        if size > refused:
            return size if self.misses < 2 or above else max(size, rounded(STRIDE * refused, up=True))
        better = next((r.point.size for r in above if r.point.size > refused), math.inf)
        size = max(
            rounded(refused * (1 + 1e-3), up=True), rounded(min(refused * 1.1, math.sqrt(refused * better)), up=True)
        )
        return min(size, better)
