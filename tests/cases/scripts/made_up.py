# SPDX-License-Identifier: Apache-2.0
"""A study whose runs cost nothing: their values and costs are functions of the settings."""
import pathlib
import sys
import types

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "client/python"))
from couplet.study import axes, quantities  # noqa: E402


class MadeUp:
    """value(settings), None where the run fails; seconds(settings); own(settings): the run's estimate. Settings: n (text) and method."""

    def __init__(self, value, seconds, given, names=("good", "dear"), sizes=(4, 6, 8), multiple=2, own=lambda settings: 0.0, ranges=()):
        self.own, self.ranges = own, dict(ranges)
        self.value, self.cost, self.clock, self.made, self.section = value, seconds, "cpu", [], {}
        case = types.SimpleNamespace(file=pathlib.Path("case.yaml"), absolute=lambda key, participant: key)
        self.case, self.participant = case, "solid"
        self.axes = axes.Axes(case, {"axes": {"mesh": {"sizes": list(sizes), "multiple": multiple, "set": {"n": "<=n>" if multiple == 0 else "<n>"}},
                                              "method": {"key": "method", "values": list(names)}}}, "solid")
        self.quantities = [quantities.Quantity("u", given, pathlib.Path("."), "solid")]

    def run(self, points, jobs=1, again=False, say=print):
        self.made += [p.name for p in points]
        rows = []
        for p in points:
            value = self.value(p.changes)
            rows.append(types.SimpleNamespace(point=p, good=value is not None, reason="" if value is not None else "it failed", errors={}, ranges=self.ranges, own=self.own(p.changes),
                                              record=types.SimpleNamespace(cpu=self.cost(p.changes)), values={"u": value}, series=""))
        return rows
