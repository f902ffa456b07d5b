#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What scripts/couplet study computes from its runs, on made-up programs whose error and cost are known: limits and orders, the Pareto
front, and which part of an error dominates (study_prediction.py: --for-error)."""
import pathlib
import sys
import types

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "client/python"))
from couplet.runs import Wrong  # noqa: E402
from couplet.study import axes, fits, quantities  # noqa: E402

# -- limits, orders, fronts
sizes = [8, 12, 20]
limit = fits.limit_of(sizes, [1 + 3 * n**-1.7 for n in sizes])
assert abs(limit.value - 1) < 1e-9 and abs(limit.order - 1.7) < 1e-9 and abs(limit.gci - 1.25 * 3 * 20**-1.7) < 1e-9
assert fits.limit_of(sizes, [1, 2, 1.5]) is None, "values that alternate have no limit"
assert fits.limit_of(sizes, [1, 1.1, 1.4]) is None, "changes that grow have no limit"
assert fits.limit_of(sizes[:2], [1, 2]) is None and fits.limit_of(sizes, [1, 1, 1]) is None
assert abs(fits.slope([1, 2, 4], [3, 12, 48]) - 2) < 1e-12 and fits.slope([1], [1]) is None
assert fits.pareto([(3, 1), (1, 2), (2, 3), (4, 0.5)]) == [(1, 2), (3, 1), (4, 0.5)]

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
assert np.allclose(axes.evaluate("-sin(pi*x)*exp(-t)^2 + where(x > 0.5, 1, 0)", places, quantities.FUNCTIONS),
                   -np.sin(np.pi * places["x"]) * np.exp(-4.0) + (places["x"] > 0.5))
for text in ("().__class__.__base__.__subclasses__()", "sin.__globals__", "[c for c in ().__class__.__mro__]", "__import__('os').system('x')",
             "(lambda: 1)()", "x[0]", "'a'*9", "sin(x, out=x)", "sin(*[x])", "f'{x}'", "x if x else t", "(y := 1)", "9^9^9^9^9", "True", "1j", "x;t",
             "exec('1')", "x.tofile('pwned')", "open", "where(x > 0, 1, 0).tofile", "1 < x < 2", "x" * 3000, "-" * 1500 + "1", "", "{}"):
    try:
        axes.evaluate(text, places, quantities.FUNCTIONS)
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

# -- the range of temperatures, of the table or else of the last field; none for other units
heated = {"time [s]": np.array([0.0, 1.0]), "a temperature [K]": np.array([293.0, 303.0]), "b temperature [K]": np.array([293.0, 333.0]), "a x [m]": np.array([0.0, 9.0])}
steady = {**heated, "a temperature [K]": np.array([303.0]), "b temperature [K]": np.array([303.0])}
field = types.SimpleNamespace(times=[0.0], field=lambda i, name: np.array([300.0, 350.0]))
for given, columns, wanted in (({"probe": "a temperature [K]"}, heated, 40), ({"probe": "a temperature [K]"}, steady, 50), ({"probe": "a x [m]"}, heated, 0),
                               ({"probe": "a temperature [K]", "is": "error"}, heated, 0)):
    results = types.SimpleNamespace(table=lambda who, file, columns=columns: columns, fields=lambda who: field)
    assert quantities.Quantity("u", given, pathlib.Path("."), "solid").range(results) == wanted, (given, wanted)

# -- one number of a series
t = np.linspace(0, 10, 2001)
y = 2 * np.cos(2 * np.pi * (t - 0.3) / 1.7) + 1
assert abs(quantities.reduced(t, y, "period") - 1.7) < 1e-4 and abs(quantities.reduced(t, y, "maximum") - 3) < 1e-6
assert abs(quantities.reduced(t, y, "amplitude") - 2) < 1e-3 and abs(quantities.reduced(t, t, "mean") - 5) < 1e-9
assert quantities.reduced(t, t, "2.5 s") == 2.5 and quantities.reduced(t, t, "last") == 10 and quantities.reduced(t, t, "first") == 0
print("ok")
