# SPDX-License-Identifier: Apache-2.0
"""Finds the cheapest setting for a requested error, predicted from few cheap runs, and runs it.

For each series (combination of all axes except the refinement) up to three of the smallest sizes are run. A fit of its
values over the sizes (fits.py) gives the size that meets the target with an error bound, and seconds(n) = a + b n^q its
cost. The series with the lowest predicted cost continues with larger sizes until a run meets the target. The target is
met only where a second witness confirms the extrapolated error (Series.doubt); otherwise one more size is run. Series
without a fit continue if that costs less than the best prediction. A reason is reported for each rejected series."""
import json
import math
import re

from couplet import files
from couplet.runs import expect
from couplet.study import table
from couplet.study.series import ENOUGH, GROWTH, ROUNDS, Prediction, Refusal, Series

NEAR = 1.5  # maximum ratio of the final size to the largest one tried
LEAP = 3.0  # ... the same if an intermediate run is too expensive
AT_ONCE = 1.15  # ratio up to which no intermediate run is made
SHORT = 1.0  # [s]; shorter final runs may be preceded by many runs
BEFORE = 3.0  # maximum ratio of the time before the final run to its own, if that exceeds SHORT ...
RESERVE = 2.0  # ... of which pilots and intermediate runs may take so much; the rest is for a failed final run
# a series continues if it may be cheaper than this fraction of the best prediction and has a cheaper larger run
TRY = 0.7
TOO_GOOD = 0.4  # of the target: a smaller error is no answer if a smaller size would do ...
TOO_MUCH = 1.4  # ... nor a run that takes so much longer than that
FREE = 10.0  # [s] to spend in any case before a search without prediction ends


def target_of(text):
    number = re.fullmatch(r"\s*([0-9.eE+-]+)\s*(%?)\s*", text)
    expect(number, f"--for-error {text}: expected a number, or a percentage such as 1%.")
    value = float(number.group(1)) / (100 if number.group(2) else 1)
    expect(0 < value < math.inf, f"--for-error {text}: expected a number above 0.")
    return value


class Search:
    def __init__(self, study, quantity, target, say):
        self.study, self.quantity, self.target, self.say = study, quantity, target, say
        self.refining = study.axes.refining
        self.every, self.rounds = [], 0

    # -- state
    def spent(self):
        return sum(s.spent() for s in self.every)

    def predictions(self):
        """Returns [(series, Prediction)] sorted by cost."""
        found = [(s, p) for s in self.every if s.rows and isinstance(p := s.predict(self.target), Prediction)]
        return sorted(found, key=lambda pair: pair[1].seconds)

    def affords(self, seconds, final):
        """Returns true if a run before the final one may take so long."""
        return self.spent() + seconds <= max(RESERVE * final, BEFORE * SHORT)

    def following(self, series):
        return self.refining.round(GROWTH * series.sizes()[-1], up=True)

    # -- the first runs
    def pilots(self):
        """Runs the three smallest sizes of each series. Expensive third runs are skipped unless the best prediction
        allows them."""
        found = {}
        for point in self.study.axes.points():
            labels = {k: v for k, v in point.labels.items() if k != self.refining.name}
            found.setdefault(tuple(labels.items()), Series(self.study, self.quantity, labels))
        self.every, sizes = list(found.values()), sorted(self.refining.sizes.values())[:3]
        for series in self.every:
            for size in sizes[:2]:
                if not series.failed:
                    self.run(series, size)
        for series in sorted((s for s in self.every if not s.failed), key=lambda s: s.cost(s.rows[-1])):
            best = next(iter(self.predictions()), None)
            if len(sizes) > 2 and (best is None or self.affords(series.seconds(sizes[2]), best[1].seconds)):
                self.run(series, sizes[2])
            elif len(sizes) > 2:
                series.short = (
                    f"size {sizes[2]:g} was not run, because it would take {series.seconds(sizes[2]):.2g} s: "
                    f"{best[0].name} should suffice in {best[1].seconds:.2g} s ({self.spent():.2g} s are spent)"
                )

    def run(self, series, size):
        row = series.add(size, self.say)
        if not row.good:
            self.say(f"{series.name}: not continued, {series.failed}")
        return row

    # -- larger ones
    def candidates(self, best, chosen):
        """Returns [(seconds, series)] that may still turn out cheaper: without prediction, or with an uncertain one
        from few runs."""
        found = []
        for i, series in enumerate(self.every):
            if series is chosen or series.failed or not series.rows or len(series.rows) >= ROUNDS:
                continue
            guess, seconds = series.predict(self.target), series.seconds(self.following(series))
            if best is None and isinstance(guess, Refusal) and guess.hopeful and seconds <= max(FREE, self.spent()):
                found.append((seconds, i, series))
            elif best is not None and seconds < TRY * best.seconds and self.affords(seconds, best.seconds):
                found += (
                    [(seconds, i, series)]
                    if getattr(guess, "hopeful", False) or getattr(guess, "cheap", math.inf) < TRY * best.seconds
                    else []
                )
        return [(seconds, series) for seconds, _, series in sorted(found, key=lambda f: f[:2])]

    def step(self):
        """Makes one more run. Returns true at the end, with (series, row, prediction) in `found`."""
        series, best = next(iter(self.predictions()), (None, None))
        others = self.candidates(best, series)
        if others:
            seconds, other = others[0]
            guess = other.predict(self.target)
            why = (
                guess.reason
                if isinstance(guess, Refusal)
                else f"size {guess.size:g} should suffice in {guess.seconds:.2g} s, at best {guess.cheap:.2g} s"
            )
            self.say(f"{other.name}: {why}; a larger size may show more, in about {seconds:.2g} s")
            self.run(other, self.following(other))
            return False
        if series is None:
            return True
        there = next((r for r in series.rows if r.point.size >= best.size and series.meets(r, self.target)), None)
        if there:
            return self.settle(series, best, there)
        amount = amounts(self.quantity)
        self.say(
            f"{series.name}: size {best.size:g} should leave an error of {amount(best.error)} (at most"
            f" {amount(best.bound)}) and take {best.seconds:.3g} s"
        )
        size = self.next_size(series, best)
        row = self.run(series, size)
        reached = [
            r for r in series.rows if series.meets(r, self.target)
        ]  # a run may have been too little to show that the ones before it suffice
        if size == best.size and row in reached and reached[0] is row and not self.smaller(series, row):
            self.found = series, row, best
            return True
        series.misses += size == best.size and row.good and row not in reached
        return False

    def next_size(self, series, best):
        """Predicted size, or an intermediate one that improves the prediction."""
        largest = series.sizes()[-1]
        if best.size <= NEAR * largest:
            return best.size
        between = self.refining.round(
            min(best.size / NEAR, (2 if best.bound < 2 * best.error else GROWTH) * largest), up=True
        )
        costly = (
            best.size <= LEAP * largest
            and best.seconds > SHORT
            and not self.affords(series.seconds(between), best.seconds)
        )
        if between <= largest or between * AT_ONCE >= best.size or costly:
            return best.size
        return between

    def smaller(self, series, row):
        """Prediction of a smaller size if the row is much better or more expensive than requested and one more run is
        affordable."""
        if series.failed:
            return None
        found, left = series.predict(self.target), series.left(row)
        if (
            not isinstance(found, Prediction)
            or found.size >= row.point.size
            or any(r.point.size == found.size for r in series.rows)
        ):
            return None
        much = left[0] < TOO_GOOD * self.target or series.cost(row) > TOO_MUCH * found.seconds
        return found if much and (found.seconds <= SHORT or self.spent() <= BEFORE * found.seconds) else None

    def settle(self, series, best, row):
        """Accepts an existing run that meets the target, unless a smaller size would do."""
        less = self.smaller(series, row)
        if less:
            self.say(
                f"{series.name}: size {row.point.size:g} is better than asked; size {less.size:g} should suffice in"
                f" {less.seconds:.3g} s"
            )
            made = self.run(series, less.size)
            if made.good and series.meets(made, self.target) and not self.smaller(series, made):
                self.found = series, made, less
                return True
            return False
        error, bound = series.left(row)
        seconds = series.cost(row)
        self.found = series, row, Prediction(row.point.size, error, bound, seconds, seconds, seconds)
        return True

    def go(self):
        self.found, self.doubt = (None, None, None), ""
        self.pilots()
        expect(
            any(s.rows for s in self.every),
            "no series could be run: " + "; ".join(f"{s.name}: {s.failed}" for s in self.every),
        )
        for _ in range(ROUNDS + 3 * len(self.every)):
            if self.step():
                break
        self.confirm()
        return self.found

    def confirm(self):
        """Refines once more if nothing but the extrapolation says that the run meets the target."""
        series, row, best = self.found
        self.doubt = series.doubt(row) if row is not None else ""
        if not self.doubt or series.failed:
            return
        size = self.following(series)
        self.say(
            f"{series.name}: size {row.point.size:g} probably meets the target, but {self.doubt}; size {size:g} is run"
            f" as a check, in about {series.seconds(size):.2g} s"
        )
        made = self.run(series, size)
        for one in (row, made) if made.good else ():
            self.doubt = series.doubt(one) if one is made or not series.agree(row, made) else ""
            if series.meets(one, self.target) and not self.doubt:
                self.found = series, one, best
                return
        self.doubt = self.doubt or "its error was too large with one more size"


def others(search, chosen, row):
    """Reasons why the other series were rejected."""
    lines, reference = [], chosen.cost(row) if row is not None else None
    for series in search.every:
        if series is chosen:
            continue
        found = series.predict(search.target) if series.rows else Refusal(series.failed, False)
        if isinstance(found, Prediction):
            most = f"{found.costly:.2g}" if found.costly < math.inf else "far more"
            why = f"size {found.size:g} should suffice in {found.seconds:.2g} s ({found.cheap:.2g} to {most} s)"
            if reference is not None and found.seconds < reference:
                why += ", no clear gain"
        else:
            why = found.reason
        lines.append({"series": series.name, "reason": why, "sizes": series.sizes()})
    return lines


def seen_from_others(search, chosen, row):
    """Lower bound of a run's error from other series: its distance from a more certain limit minus the bound of
    that."""
    least, who = 0.0, ""
    for series in search.every:
        if series is chosen or series.known or not series.rows:
            continue
        fit, _ = series.fit()
        if fit is None:
            continue
        bound = series.left(series.rows[-1])[1]
        gap = abs(row.values[search.quantity.name] / fit.scale - fit.limit) - bound
        if gap > least:
            least, who = gap, series.name
    return least, who


def amounts(quantity):
    """Returns a function that writes an error of a quantity: absolute, or in per cent."""
    return (lambda error: f"{error:.3g}") if quantity.given.get("absolute") else (lambda error: f"{100 * error:.3g} %")


def said(search, series, row, predicted):
    """Result as numbers and as lines."""
    target, quantity = search.target, search.quantity
    rest = others(search, series, row)
    lines = [f"  {o['series']}: not chosen: {o['reason']}" for o in rest]
    if row is None:
        return {
            "met": False,
            "target": target,
            "quantity": quantity.name,
            "others": rest,
            "before": search.spent(),
            "lines": [
                (
                    f"No setting was found for an error of {amounts(quantity)(target)}, after"
                    f" {sum(len(s.rows) for s in search.every)} runs:"
                ),
                *lines,
            ],
        }
    if series.known:
        table.set_errors([row], [quantity])
    true, (error, bound) = row.errors.get(quantity.name), series.left(row) or (
        predicted.error,
        predicted.bound,
    )  # a run more may have left no fit
    elsewhere, who = (0.0, "") if true is not None else seen_from_others(search, series, row)
    reached = true if true is not None else max(error, elsewhere)
    seconds, spent = series.cost(row), search.spent()
    settings = ", ".join(f"{k}={v}" for k, v in row.point.changes.items())
    amount = amounts(quantity)
    how = "against the reference" if true is not None else f"by extrapolation, at most {amount(max(bound, elsewhere))}"
    first = [
        (
            f"Cheapest run for an error of {amount(target)} of {quantity.name}: {series.name}, size"
            f" {row.point.size:g} ({settings})"
        ),
        f"error: {amount(reached)} {how} (predicted {amount(predicted.error)})"
        + (f" (compared with {who})" if elsewhere > error else ""),
        *([f"not confirmed: {search.doubt}"] if search.doubt else []),
        f"time: {seconds:.3g} s (predicted {predicted.seconds:.3g} s); all runs together took {spent:.3g} s",
    ]
    return {
        "met": reached <= ENOUGH * target and not search.doubt,
        "doubt": search.doubt,
        "target": target,
        "quantity": quantity.name,
        "series": series.name,
        "size": row.point.size,
        "value": row.values[quantity.name],
        "predicted error": predicted.error,
        "predicted seconds": predicted.seconds,
        "error": reached,
        "bound": bound,
        "estimate": error,
        "seconds": seconds,
        "before": spent - seconds,
        "others": rest,
        "lines": first + lines,
    }


def for_error(study, text, name, say):
    target = target_of(text)
    expect(study.axes.refining, f"{study.case.file}: --for-error needs an axis with 'sizes'.")
    names = [q.name for q in study.quantities]
    quantity = next((q for q in study.quantities if q.name == (name or names[0])), None)
    expect(quantity, f"--quantity {name}: there is no such quantity; the quantities are: {', '.join(names)}.")
    search = Search(study, quantity, target, say)
    result = said(search, *search.go())
    file = study.out / f"for-error-{quantity.name.replace(' ', '-')}-{text.strip().replace('%', 'pc')}.json"
    files.write(study.out, file.name, json.dumps(result, indent=1, default=lambda v: v.item()))
    for line in result["lines"]:
        say(line)
    return 0 if result["met"] else 1
