#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What scripts/study computes from its runs, on made-up programs whose error and cost are known: limits and orders, the Pareto
front, the setting that --for-error finds, and which part of an error dominates."""
import pathlib
import sys
import types

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "client/python"))
from couplet.runs import Wrong  # noqa: E402
from couplet.study import axes, convergence, dominance, expressions, predict, quantities  # noqa: E402

# -- limits, orders, fronts
sizes = [8, 12, 20]
limit = convergence.limit_of(sizes, [1 + 3 * n**-1.7 for n in sizes])
assert abs(limit.value - 1) < 1e-9 and abs(limit.order - 1.7) < 1e-9 and abs(limit.gci - 1.25 * 3 * 20**-1.7) < 1e-9
assert abs(limit.size_for(limit.error(31)) - 31) < 1e-9
assert convergence.limit_of(sizes, [1, 2, 1.5]) is None, "values that alternate have no limit"
assert convergence.limit_of(sizes, [1, 1.1, 1.4]) is None, "changes that grow have no limit"
assert convergence.limit_of(sizes[:2], [1, 2]) is None and convergence.limit_of(sizes, [1, 1, 1]) is None
assert abs(convergence.slope([1, 2, 4], [3, 12, 48]) - 2) < 1e-12 and convergence.slope([1], [1]) is None
assert convergence.pareto([(3, 1), (1, 2), (2, 3), (4, 0.5)]) == [(1, 2), (3, 1), (4, 0.5)]
a, b, q = predict.power_cost([4, 8, 16, 32], [0.1 + 1e-4 * n**3 for n in (4, 8, 16, 32)])
assert abs(a - 0.1) < 0.02 and abs((a + b * 64**q) / (0.1 + 1e-4 * 64**3) - 1) < 0.05, (a, b, q)

# -- sizes in settings: arithmetic and nothing else
assert axes.filled("{a: <n>, b: <3*n/2>, dt: <=1.6/n>}", 5) == "{a: 5, b: 8, dt: 0.32}"
for text in ("<m>", "<__import__('os')>", "<n.real>", "<n/0>", "<9^9^9^9>", "<" + "(" * 900 + "n" + ")" * 900 + ">"):
    try:
        axes.filled(text, 5)
    except Wrong:
        continue
    raise AssertionError(f"{text} was taken for arithmetic")

# -- an exact field: an expression of the place and the time, and no way from there to the rest of Python
places = {"x": np.linspace(0, 1, 5), "t": 2.0, "pi": np.pi}
assert np.allclose(expressions.evaluate("-sin(pi*x)*exp(-t)^2 + where(x > 0.5, 1, 0)", places, quantities.FUNCTIONS),
                   -np.sin(np.pi * places["x"]) * np.exp(-4.0) + (places["x"] > 0.5))
for text in ("().__class__.__base__.__subclasses__()", "sin.__globals__", "[c for c in ().__class__.__mro__]", "__import__('os').system('x')",
             "(lambda: 1)()", "x[0]", "'a'*9", "sin(x, out=x)", "sin(*[x])", "f'{x}'", "x if x else t", "(y := 1)", "9^9^9^9^9", "True", "1j", "x;t",
             "exec('1')", "x.tofile('pwned')", "open", "where(x > 0, 1, 0).tofile", "1 < x < 2", "x" * 3000, "-" * 1500 + "1", "", "{}"):
    try:
        expressions.evaluate(text, places, quantities.FUNCTIONS)
    except ValueError:
        continue
    raise AssertionError(f"{text} was taken for an expression")
for given, part in (({"field": "u", "exact": ["sin(x)", "x.tofile('pwned')"]}, "exact: 'x.tofile"), ({"python": "../other.py: f"}, "not in the folder"),
                    ({"python": "/tmp/other.py: f"}, "not in the folder")):
    try:
        quantities.quantities_of(types.SimpleNamespace(file=pathlib.Path("case.yaml")), {"quantities": {"q": given}}, "solid")
    except Wrong as error:
        assert part in str(error), error
        continue
    raise AssertionError(f"{given} was accepted")
axis = axes.axis_of("mesh", {"sizes": [8, 4], "multiple": 4, "set": {"k": "<n>"}}, "file")
assert list(axis.sizes.values()) == [4, 8] and axis.round(9, up=True) == 12 and axis.round(8 + 1e-12, up=True) == 8

# -- one number of a series
t = np.linspace(0, 10, 2001)
y = 2 * np.cos(2 * np.pi * (t - 0.3) / 1.7) + 1
assert abs(quantities.reduced(t, y, "period") - 1.7) < 1e-4 and abs(quantities.reduced(t, y, "maximum") - 3) < 1e-6
assert abs(quantities.reduced(t, y, "amplitude") - 2) < 1e-3 and abs(quantities.reduced(t, t, "mean") - 5) < 1e-9
assert quantities.reduced(t, t, "2.5 s") == 2.5 and quantities.reduced(t, t, "last") == 10 and quantities.reduced(t, t, "first") == 0


# -- a program whose value and cost are known
class Fake:
    """value(settings), seconds(settings): a study without runs."""

    def __init__(self, value, seconds, given, names=("good", "dear")):
        self.value, self.cost, self.clock, self.made = value, seconds, "cpu", []
        case = types.SimpleNamespace(file=pathlib.Path("case.yaml"), absolute=lambda key, participant: key)
        self.case, self.participant = case, "solid"
        self.axes = axes.Axes(case, {"axes": {"mesh": {"sizes": [4, 6, 8], "multiple": 2, "set": {"n": "<n>"}},
                                              "method": {"key": "method", "values": list(names)}}}, "solid")
        self.quantities = [quantities.Quantity("u", given, pathlib.Path("."), "solid")]

    def run(self, points, jobs=1, again=False, say=print):
        self.made += [p.name for p in points]
        rows = []
        for p in points:
            record = types.SimpleNamespace(cpu=self.cost(p.changes))
            value = self.value(p.changes)
            rows.append(types.SimpleNamespace(point=p, good=value is not None, reason="it failed", record=record, errors={},
                                              values={"u": value}, series=""))
        return rows


def asked(study, target):
    every = predict.started(study, study.quantities[0], lambda line: None)
    best, row, predicted = predict.approach(every, target, lambda line: None)
    return best, row, predicted, predict.said(study, study.quantities[0], best, every, target, row, predicted)


for given, reference in (({"reference": 2.0}, 2.0), ({"is": "error"}, None)):
    for target in (0.02, 0.004, 0.001):
        def value(s):
            n, order, size = float(s["n"]), *((2, 1.5) if s["method"] == "good" else (2, 6))
            wrong = size * n**-order * (1 + 0.5 / n)  # not yet asymptotic on the smallest
            return wrong if reference is None else reference * (1 + wrong)
        study = Fake(value, lambda s: 0.1 + 1e-3 * float(s["n"])**3, given)
        best, row, predicted, said = asked(study, target)
        assert best.name == "good", "the other needs twice the size"
        assert said["met"] and 0.3 <= said["error"] / target <= 1.1, said
        assert 0.7 <= said["seconds"] / said["predicted seconds"] <= 1.3, said
        assert said["before"] <= 1.5 * said["seconds"] or said["seconds"] <= 10, said
study = Fake(lambda s: None if s["method"] == "good" else 1 + 3 * float(s["n"])**-2, lambda s: 1.0, {"reference": 1.0})
assert asked(study, 0.01)[0].name == "dear", "a series whose runs fail is left out"
study = Fake(lambda s: float(s["n"]) % 4, lambda s: 1.0, {})
assert not asked(study, 0.01)[3]["met"], "values without a limit are not called an answer"
for scatter in (0, 1e-3):  # from size to size, as of a probe that sees one cell after the other
    said = asked(Fake(lambda s: -1 - 3 * float(s["n"])**-2 + scatter * (round(float(s["n"])) % 3), lambda s: 1.0, {}), 1e-3)[3]
    assert said["met"] == (scatter == 0), "an extrapolation from values that scatter by the target is no answer"

# -- what dominates: value = 1 + mesh + step + what the solver leaves, in turn the largest
for worst in ("mesh", "step", "solver"):
    part = {name: (1e-2 if name == worst else 1e-4) for name in ("mesh", "step", "solver")}
    true = dict(part)

    def value(s):
        return 1 + part["mesh"] * (16 / float(s["n"]))**2 + part["step"] * (s["dt"] / 0.1)**2 - part["solver"] * s["tol"] / 1e-5
    study = Fake(value, lambda s: 1.0, {})
    study.axes.common = {}
    found, _ = dominance.Dominance(study, {"mesh": {"size": 16, "set": {"n": "<n>"}}, "step": {"key": "dt", "value": 0.1},
                                           "solver": {"key": "tol", "value": 1e-5, "tolerance": True}}).parts(study.quantities[0], print)
    assert max(found, key=found.get) == worst and all(0.5 < found[k] / true[k] < 2 for k in true), (worst, found)
    lines = dominance.sentences(found)
    assert f"the {worst} dominates" in lines[1] and "would buy nothing" in lines[1], lines
print("ok")
