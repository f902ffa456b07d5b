#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What --for-error makes of series that are made up: fits of known order, with noise, with a change of sign, on meshes that are too
coarse, that oscillate, and without a limit; the setting it finds beside the cheapest one, and what it reports of the others."""
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "client/python"))
from couplet.runs import Wrong  # noqa: E402
from couplet.study import fits, predict, series  # noqa: E402
from made_up import MadeUp  # noqa: E402

SIZES = np.array([8, 12, 16, 24, 32])


def close(a, b, share=1e-3):
    return abs(a - b) <= share * abs(b)


# -- known order: found, with its limit; the bound lies above the error and not far
for order in (0.6, 1.0, 1.5, 1.9):
    fit, _ = fits.of_values(SIZES, 2 + 3 * SIZES**-order)
    assert close(fit.order, order) and close(fit.limit, 2, 1e-4) and fit.deviation < 1e-6 and close(fit.bound(32), 1.25 * 3 * 32**-order, 1e-2), (order, fit)
    assert close(fit.bound(fit.size_for(1e-3)), 1e-3, 1e-4)
assert fits.of_values(SIZES, 2 + 3 / SIZES**2, formal=1)[0].order <= 1.1, "the formal order is the highest"
fit, _ = fits.of_values(SIZES, 2 + 3 * SIZES**-2.6)
assert fit.order == 2.1 and fit.safety == fits.SAFETY and 3 * 32**-2.6 < fit.bound(32), "better than formal: the formal order counts, which overestimates"
fit, _ = fits.of_values(SIZES, 2 + 3 * SIZES**-0.3)
assert fit.safety == fits.POOR, "an order below the borders is doubtful"

# -- a noise floor: sizes that no mesh can have are not asked for
noise = 1e-3 * np.array([1, -1, 1, -1, 1])
fit, _ = fits.of_values(SIZES, 2 + 3 * SIZES**-2.0 + noise)
assert 0.3e-3 < fit.deviation < 3e-3 and abs(fit.limit - 2) < 3e-3, fit
assert fit.size_for(2e-4) is None and fit.size_for(2e-2) is not None, "noise of 1e-3 bounds what can be reached"
truth = [abs(3 * 32**-2.0 + noise[-1])]
assert fit.bound(32) > truth[0]

# -- a change of sign: terms of first and second order against each other, a limit all the same
def crossing(n):
    return 2 + 1.0 / n - 12.0 / n**2
fit, reason = fits.of_values(SIZES, crossing(SIZES))
assert fit and len(fit.terms) == 2 and close(fit.limit, 2, 1e-6) and close(fit.error(64), abs(crossing(64) - 2)), (fit, reason)
assert fit.error(12) >= 1 / 12 - 12 / 144 + 0.02, "at 12 the curve crosses its limit: larger sizes leave more, which is what counts"

# -- coarse meshes that follow no order: not used where the others do
coarse = np.array([4, 6, 8, 12, 16, 24, 32])
values = 2 + 3 * coarse**-2.0
values[0] += 0.5
fit, _ = fits.of_values(coarse, values)
assert fit.runs == 6 and close(fit.limit, 2, 1e-4), fit
assert fits.of_values(coarse, 2 + 3 * coarse**-2.0)[0].runs == 7, "else all are used"

# -- oscillation that settles has a limit, doubtful; oscillation that does not, and values that move apart, are named
swing = np.array([1, -1, 1, -1, 1])
fit, _ = fits.of_values(SIZES, 2 + 30 * swing * SIZES**-2.0)
assert fit and fit.bound(32) > 30 * 32**-2.0, fit
for values, words in ((2 + 0.1 * swing * SIZES / 8, "alternate"), (2 + 0.1 * np.log(SIZES), "diverge"), (2 + 0.001 * SIZES, "diverge")):
    fit, reason = fits.of_values(SIZES, values)
    assert fit is None and words in reason, (reason, values)
assert fits.of_values([4, 8], [1, 2])[0] is None and "three" in fits.of_values([4, 8], [1, 2])[1]
assert fits.of_values(SIZES, np.full(5, 3.0))[0].bound(32) == 0, "values that agree leave nothing"

# -- known errors: a power law; one that changes its sign is not exact there
fit, _ = fits.of_errors(SIZES, 3 * SIZES**-1.5)
assert close(fit.order, 1.5) and close(fit.error(64), 3 * 64**-1.5)
assert fits.of_errors([8, 16], [0.1, 0.11])[0] is None and "does not decrease" in fits.of_errors([8, 16], [0.1, 0.11])[1]
lucky = [0.3, 0.2, 0.1, -0.001]
assert fits.settled([4, 6, 8, 12], lucky, 2)[-1] == 0.1 * (8 / 12)**2 and fits.settled([4, 6, 8, 12], [0.3, 0.001, -0.05, -0.02], 2)[1] == 0.05

# -- costs
a, b, q = series.power_cost([4, 8, 16, 32], [0.1 + 1e-4 * n**3 for n in (4, 8, 16, 32)])
assert abs(a - 0.1) < 0.02 and abs((a + b * 64**q) / (0.1 + 1e-4 * 64**3) - 1) < 0.05, (a, b, q)
a, b, q = series.power_cost([4, 8, 12], [0.1 + 2e-5 * 4**3, 0.5, 0.1 + 2e-5 * 12**3])  # 8 by another solver
assert 0.8 < (a + b * 20**q) / (0.1 + 2e-5 * 20**3) < 1.25, "a small run that costs more than a larger one does not spoil the cost"

# -- sizes that nearly agree do not decide the order
near = np.array([25, 50, 95, 100])
fit, _ = fits.of_values(near, 1 + near**-2.0 + np.array([0, 0, 2e-5, 0]))
assert 0.5e-4 < fit.error(100) < 2e-4 and fit.order > 1.7, fit


def asked(study, target):
    search = predict.Search(study, study.quantities[0], target, lambda line: None)
    found = search.go()
    return predict.said(search, *found)


def cheapest(study, error, target, step, largest=4000):
    """By trying all: the least seconds of any setting that leaves no more."""
    return min(study.cost(s) for name in ("good", "dear") for n in range(step, largest, step) for s in [{"n": n, "method": name}] if error(s) <= target)


# -- the setting: reached, near the cheapest, time and cost of the runs before as wanted; a limit not known, known, and errors as such
def wrong(s):
    n, order, size = float(s["n"]), *((2, 1.5) if s["method"] == "good" else (1.5, 6))
    return size * n**-order * (1 + 0.5 / n)  # not yet asymptotic on the smallest


def seconds(s):
    return 0.1 + 1e-3 * float(s["n"])**3


for given, value in (({}, lambda s: 2.0 * (1 + wrong(s))), ({"reference": 2.0}, lambda s: 2.0 * (1 + wrong(s))), ({"is": "error"}, wrong)):
    for target in (0.02, 0.004, 0.001):
        study = MadeUp(value, seconds, given)
        said = asked(study, target)
        true = wrong({"n": said["size"], "method": said["series"]})
        assert said["series"] == "good" and said["met"] and 0.3 <= true / target <= 1.1, (given, target, said, true)
        assert 0.7 <= said["seconds"] / said["predicted seconds"] <= 1.3, said
        assert said["seconds"] <= 1.5 * cheapest(study, wrong, target, 2) + 1e-9, (given, target, said, said["seconds"], cheapest(study, wrong, target, 2))
        assert said["before"] <= 3 * said["seconds"] or said["seconds"] <= 1, said
        other, = said["others"]
        assert other["series"] == "dear" and other["sizes"] and other["reason"], other

# -- a temperature: a per cent is one of its range, not of the kelvin that it has above absolute zero
said = asked(MadeUp(lambda s: 300 + 10 * (1 + wrong(s)), seconds, {"probe": "x temperature [K]"}, ranges={"u": 10.0}), 0.004)
true = wrong({"n": said["size"], "method": said["series"]})
assert said["met"] and 0.3 <= true / 0.004 <= 1.1, (said, true)

# -- a run that is far better than asked is no answer where a smaller size would do, nor is a smaller one that leaves too much
for sizes, target, least, most in (((5, 40, 80), 3e-3, 17, 30), ((40, 80, 160), 5e-2, 4, 9)):
    said = asked(MadeUp(lambda s: 1 + float(s["n"])**-2, lambda s: 0.1 + 2e-5 * float(s["n"])**3, {}, names=("good",), sizes=sizes, multiple=1), target)
    assert least <= said["size"] <= most and 0.3 < said["size"]**-2 / target < 1.1 and 0.7 < said["seconds"] / said["predicted seconds"] < 1.3, said
said = asked(MadeUp(lambda s: 1 + float(s["n"])**-2 + 0.1 * (float(s["n"]) < 20), lambda s: 0.1 + 2e-5 * float(s["n"])**3, {}, names=("good",),
                    sizes=(40, 80, 160), multiple=1), 1e-2)
assert said["met"] and 20 <= said["size"] <= 40, said

# -- three pilots may show an order by chance, and a fourth run confirms it; the coarsest of them that suffices is the answer then, not the fourth
thickness = {100: 10.28631, 200: 9.977768, 400: 9.957801, 440: 9.957}  # of a tank's front, whose limit is 9.948
said = asked(MadeUp(lambda s: float(np.interp(float(s["n"]), [*thickness], [*thickness.values()])), lambda s: 0.1 + 8e-4 * float(s["n"]), {}, names=("good",),
                    sizes=(100, 200, 400), multiple=10), 0.06)
assert said["met"] and said["size"] == 100, said

# -- the best series changes its sign: it is taken all the same (a tank's limiter beside upwind advection)
def tank(s):
    n = float(s["n"])
    return 2 + (12.0 / n if s["method"] == "dear" else 0.004 * np.cos(n) * (8 / n))
study = MadeUp(tank, lambda s: 0.1 + 1e-4 * float(s["n"])**2, {}, own=lambda s: 0.02 / float(s["n"]))
said = asked(study, 0.02)
assert said["series"] == "good" and said["met"] and abs(tank({"n": said["size"], "method": "good"}) - 2) / 2 <= 0.02, said
assert said["seconds"] < 0.2 < seconds({"n": 100})

# -- a series that fails, and one without a limit: named, with their reasons; the other is taken
for value, word in ((lambda s: None if s["method"] == "good" else 1 + 3 * float(s["n"])**-2, "it failed"),
                    (lambda s: 2 + 0.01 * float(s["n"]) if s["method"] == "good" else 1 + 3 * float(s["n"])**-2, "diverge")):
    said = asked(MadeUp(value, lambda s: 0.1 + 1e-3 * float(s["n"]), {}), 0.01)
    assert said["series"] == "dear" and said["met"] and said["others"][0]["series"] == "good" and word in said["others"][0]["reason"], said
    assert any("good: not chosen" in line and word in line for line in said["lines"]), said["lines"]
try:
    asked(MadeUp(lambda s: None, lambda s: 1.0, {}), 0.01)
    raise AssertionError("no run succeeded and nothing was said")
except Wrong as error:
    assert "good: its run of size 4 failed" in str(error)

# -- no answer: values without a limit, values that scatter by the target; all series are named, the search ends
for value in (lambda s: 2 + np.sin(0.7 * float(s["n"])**2), lambda s: -1 - 3 * float(s["n"])**-2 + 1e-3 * (round(float(s["n"])) % 3)):
    study = MadeUp(value, lambda s: 1.0, {})
    said = asked(study, 1e-3)
    assert not said["met"] and len(study.made) < 60, said
assert asked(MadeUp(lambda s: -1 - 3 * float(s["n"])**-2, lambda s: 1.0, {}), 1e-3)["met"], "without the scatter there is one"

# -- never an absurd size: a run is refused that would take longer than the study allows, with the size and the time
study = MadeUp(lambda s: 2 + float(s["n"])**-0.5, seconds, {})
said = asked(study, 1e-5)
assert not said["met"] and all("too far" in o["reason"] or "longer than a run may" in o["reason"] for o in said["others"]), said
assert max(float(name.split("-")[1]) for name in study.made) <= 64 * 8 and sum(seconds({"n": name.split("-")[1]}) for name in study.made) < 100, study.made
study = MadeUp(lambda s: 2 + float(s["n"])**-0.5, lambda s: 1.0, {})  # not even where it costs nothing
said = asked(study, 1e-5)
assert not said["met"] and all("too far" in o["reason"] for o in said["others"]) and max(float(name.split("-")[1]) for name in study.made) <= 1000, (said, study.made)

# -- an extrapolated error needs a witness: the order of the schemes in the last three runs, or the run's own estimate
for own, met in ((0, False), (5, False), (1.5, True)):
    study = MadeUp(lambda s: 1 + float(s["n"])**-1.2, lambda s: 0.1 + 1e-4 * float(s["n"])**2, {}, names=("good",), own=lambda s: own * float(s["n"])**-1.2)
    said = asked(study, 0.01)
    assert said["met"] == met and bool(said["doubt"]) != met, (own, said)
    assert met or any("not confirmed" in line and "order 1.2 instead of 2" in line for line in said["lines"]), said["lines"]
    runs = [float(name.split("-")[1]) for name in study.made]
    assert met == (max(runs) == said["size"]), "without a witness one more size is run"
print("ok")
