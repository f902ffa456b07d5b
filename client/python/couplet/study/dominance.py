# SPDX-License-Identifier: Apache-2.0
"""What the error of a setting is made of: mesh, step, linear and coupling tolerance, one after the other.

sources:
  mesh: {size: 16, set: {mesh-parameters: "{n: <n>}"}}   # compared with half the size; order: 2
  step: {key: simulation.time-step, value: 0.1}          # compared with twice the step; order: 2
  linear tolerance: {key: pressure-tolerance, value: 1.0e-5, tolerance: true}     # compared with a hundredth of the tolerance
The part of mesh or step is the change from the coarser run over 2^order - 1 (Richardson), both with tight tolerances, so that what
a solver leaves is not taken for it; the part of a tolerance is what tightening it changes."""
import dataclasses
import math

from couplet.runs import expect
from couplet.study.axes import Point, filled

KEYS = {"size", "set", "key", "value", "tolerance", "order", "factor"}
NOTHING = 0.1  # of the largest part: what is less buys nothing


@dataclasses.dataclass
class Source:
    name: str
    changes: object  # (factor) -> {key: value}; 1 as it is, above 1 coarser, below 1 finer
    tolerance: bool
    ratio: float     # coarser by this, or the tolerance tighter by this
    order: float


def source_of(name, given, where):
    where = f"{where}: study.sources.{name}"
    expect(isinstance(given, dict) and not set(given) - KEYS, f"{where}: expected a mapping of {', '.join(sorted(KEYS))}.")
    if "size" in given:
        expect(isinstance(given.get("set"), dict), f"{where}: 'size' needs 'set', keys with <expressions in n>.")
        return Source(name, lambda f: {k: filled(str(t), max(1, given["size"] / f)) for k, t in given["set"].items()}, False,
                      given.get("factor", 2), given.get("order", 2))
    expect("key" in given and isinstance(given.get("value"), (int, float)), f"{where}: expected {{key: ..., value: number}}.")
    tolerance = bool(given.get("tolerance"))
    return Source(name, lambda f: {given["key"]: given["value"] * f}, tolerance, given.get("factor", 100 if tolerance else 2), given.get("order", 2))


class Dominance:
    """Parts of the error of one quantity at the setting that the sources name."""

    def __init__(self, study, section):
        expect(isinstance(section, dict) and section, f"{study.case.file}: study.sources: expected sources of error by name.")
        self.study, self.sources = study, [source_of(n, g, study.case.file) for n, g in section.items()]

    def point(self, **factors):
        """`factors`: by source; 1 where none is given."""
        changes, named = dict(self.study.axes.common), {}
        for source in self.sources:
            factor = factors.get(source.name, 1)
            changes.update({self.study.case.absolute(k, self.study.participant): v for k, v in source.changes(factor).items()})
            if factor != 1:
                named[source.name] = f"{source.name.replace(' ', '_')}-x{factor:g}"
        return Point(named or {"setting": "as-it-is"}, changes, {}, 0)

    def parts(self, quantity, say):
        """({source: estimated error}, value): the errors as those of the quantity, over its size."""
        tight = {s.name: 1 / s.ratio for s in self.sources if s.tolerance}
        points = [self.point(), self.point(**tight)] + [
            self.point(**({s.name: tight[s.name]} if s.tolerance else {**tight, s.name: s.ratio})) for s in self.sources]
        first = {point.name: point for point in points}  # one source with a tolerance: two points are the same
        rows = dict(zip(first, self.study.run(list(first.values()), 1, False, say)))
        for row in (rows[points[0].name], rows[points[1].name]):
            expect(row.good, f"the run {row.point.name} failed: {row.reason}")
        value, exact = (rows[p.name].values[quantity.name] for p in points[:2])
        scale, found = 1 if quantity.is_error or quantity.given.get("absolute") or value == 0 else abs(value), {}
        for source, point in zip(self.sources, points[2:]):
            row = rows[point.name]
            if not row.good:
                found[source.name] = math.inf
            elif source.tolerance:
                found[source.name] = abs(row.values[quantity.name] - value) / scale
            else:
                found[source.name] = abs(row.values[quantity.name] - exact) / (source.ratio**source.order - 1) / scale
        return found, value


def sentences(parts):
    """What to do about it."""
    worst = max(parts, key=parts.get)
    total = sum(parts.values())
    lines = [f"estimated error {total:.2g}: " + ", ".join(f"{name} {value:.2g}" for name, value in sorted(parts.items(), key=lambda p: -p[1]))]
    if math.isinf(total):
        lines.append("a run beside it failed: its part is unknown and counts as the largest")
    idle = [name for name, value in parts.items() if value < NOTHING * parts[worst]]
    lines.append(f"the {worst} dominates" + (f": improving {' or '.join(idle)} would not help" if idle else ""))
    return lines
