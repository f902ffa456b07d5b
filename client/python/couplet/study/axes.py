# SPDX-License-Identifier: Apache-2.0
"""Runs of a study: every combination of the values of its axes.

axes:
  mesh:                                   # sizes: any number can be made, also one that the list does not hold
    sizes: [4, 8, 16]
    set: {mesh-parameters: "{nr: <n>, nt: <3*n/2>, nz: <3*n/4>}"}     # <...> is arithmetic on n, rounded to whole
                                                                      numbers
    multiple: 4                           # sizes that --for-error makes are multiples of it; 0: any number (1)
  gradient: {key: solution-method.face-gradient, values: [thesis, symmetric]}
  step: {key: simulation.time-step, values: [0.1 s, 0.05 s]}
  scheme: {values: {explicit: {coupling.scheme: explicit}, implicit: {coupling.scheme: implicit}}}   # sets of keys by
                                                                                                     name
  ranks: {ranks: fluid, values: [1, 2]}"""
import ast
import dataclasses
import itertools
import math
import operator
import re

from couplet.runs import expect


def arithmetic(text, n):
    """Value of an expression in n with numbers, + - * / ** and brackets."""
    try:
        return evaluate(text, {"n": n})
    except ValueError as error:
        expect(False, f"study: '<{text}>' is not arithmetic in n. {error}")


def filled(template, n):
    """Replaces every <expression in n> by a number, which is rounded to a whole one unless the expression is <=...>."""

    def number(match):
        exact, text = match.group(1), match.group(2)
        value = arithmetic(text, n)
        return f"{value:.12g}" if exact else str(max(1, round(value)))

    return re.sub(r"<(=?)([^<>]+)>", number, template)


@dataclasses.dataclass
class Axis:
    name: str
    values: dict  # label: {key: value}, keys as in the file
    sizes: dict  # label: n; empty if the axis is not a refinement
    template: dict  # {key: text with <...>} of a refinement
    ranks: dict  # label: {participant: number}
    multiple: float = 1

    def round(self, n, up=False):
        """Closest permitted size."""
        if self.multiple == 0:
            return float(f"{n:.3g}")
        return self.multiple * max(1, math.ceil(n / self.multiple - 1e-9) if up else round(n / self.multiple))

    def at(self, n):
        """Returns the settings for the size n, which need not be one of the listed sizes."""
        return {key: filled(str(text), n) for key, text in self.template.items()}


def label_of(value):
    return re.sub(r"[^A-Za-z0-9.+-]+", "_", str(value)).strip("_") or "0"


def axis_of(name, given, where):
    where = f"{where}: study.axes.{name}"
    expect(isinstance(given, dict), f"{where}: expected a mapping.")
    unknown = set(given) - {"key", "values", "sizes", "set", "ranks", "multiple"}
    expect(
        not unknown,
        (
            f"{where}: unknown key '{next(iter(unknown), '')}'; valid keys are key, values, sizes, set, multiple and"
            " ranks."
        ),
    )
    if "sizes" in given:
        expect(
            isinstance(given["sizes"], list)
            and isinstance(given.get("set"), dict)
            and all(isinstance(n, (int, float)) and n > 0 for n in given["sizes"]),
            f"{where}: a refinement needs 'sizes', a list of numbers, and 'set', keys with <expressions in n>.",
        )
        axis = Axis(name, {}, {}, given["set"], {}, given.get("multiple", 1))
        for n in sorted(given["sizes"]):
            axis.values[label_of(n)], axis.sizes[label_of(n)] = axis.at(n), n
        return axis
    values = given.get("values")
    if "ranks" in given:
        expect(
            isinstance(values, list) and all(isinstance(v, int) and v > 0 for v in values),
            f"{where}: values: expected whole numbers.",
        )
        return Axis(name, {str(v): {} for v in values}, {}, {}, {str(v): {given["ranks"]: v} for v in values})
    if isinstance(values, dict):
        if "key" in given:
            return Axis(name, {label_of(k): {given["key"]: v} for k, v in values.items()}, {}, {}, {})
        expect(
            all(isinstance(v, dict) or v is None for v in values.values()),
            f"{where}: values: each name must map to keys and their values, such as {{fine: {{mesh.n: 40}}}}.",
        )
        return Axis(name, {label_of(k): dict(v or {}) for k, v in values.items()}, {}, {}, {})
    expect(
        isinstance(values, list) and values and "key" in given,
        (
            f"{where}: expected {{key: ..., values: [...]}}, {{values: {{name: {{key: value}}}}}} or {{sizes: [...],"
            " set: {...}}."
        ),
    )
    return Axis(name, {label_of(v): {given["key"]: v} for v in values}, {}, {}, {})


@dataclasses.dataclass
class Point:
    """One combination: {axis: label}, its settings by full keys, ranks, and the size of its refinement."""

    labels: dict
    changes: dict
    ranks: dict
    size: float

    @property
    def name(self):
        return "-".join(self.labels.values()) or "run"


class Axes:
    def __init__(self, case, section, participant):
        self.case, self.participant = case, participant
        given = section.get("axes")
        expect(isinstance(given, dict) and given, f"{case.file}: study.axes: expected axes by name.")
        self.all = [axis_of(name, content, case.file) for name, content in given.items()]
        refining = [axis for axis in self.all if axis.sizes]
        expect(
            len(refining) <= 1,
            f"{case.file}: study.axes: one axis may have 'sizes'; it may set mesh and step together.",
        )
        self.refining = refining[0] if refining else None
        self.common = {case.absolute(k, participant): v for k, v in (section.get("set") or {}).items()}
        self.refuse_covered()
        self.leave_out = section.get("leave-out") or []
        expect(
            all(isinstance(rule, dict) and set(rule) <= {a.name for a in self.all} for rule in self.leave_out),
            f"{case.file}: study.leave-out: expected a list of {{axis: value or [values]}}.",
        )

    def refuse_covered(self):
        """Rejects a mapping of a later axis that would remove a key set by an earlier one."""
        for first, later in itertools.combinations(self.all, 2):
            for key in {k for found in first.values.values() for k in found}:
                for above in {k for found in later.values.values() for k in found}:
                    expect(
                        not key.startswith(above + "."),
                        (
                            f"{self.case.file}: study.axes: '{above}' of '{later.name}' would replace '{key}' of "
                            f"'{first.name}': name '{later.name}' first, or give its keys one by one."
                        ),
                    )

    def left_out(self, labels):
        def fits(rule):
            return all(
                labels[a] in [label_of(v) for v in (values if isinstance(values, list) else [values])]
                for a, values in rule.items()
            )

        return any(fits(rule) for rule in self.leave_out)

    def point(self, labels, size=None):
        """`size` is that of the refinement if it is not in the list."""
        changes, ranks = dict(self.common), {}
        for axis in self.all:
            found = axis.at(size) if axis is self.refining and size is not None else axis.values[labels[axis.name]]
            changes.update({self.case.absolute(k, self.participant): v for k, v in found.items()})
            ranks.update(axis.ranks.get(labels[axis.name], {}))
        if size is None and self.refining:
            size = self.refining.sizes[labels[self.refining.name]]
        return Point(labels, changes, ranks, size if size is not None else 0)

    def points(self):
        combinations = itertools.product(*(axis.values for axis in self.all))
        every = [dict(zip((a.name for a in self.all), c)) for c in combinations]
        return [self.point(labels) for labels in every if not self.left_out(labels)]

    def series_of(self, point):
        """All labels except that of the refinement, which identify a curve."""
        return ", ".join(v for k, v in point.labels.items() if not self.refining or k != self.refining.name) or "all"


LONGEST = 2000  # characters
BINARY = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
UNARY = {ast.USub: operator.neg, ast.UAdd: operator.pos}
COMPARE = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}


def evaluate(text, names, functions=()):
    """Value of an expression of `names` ({name: number or array}) and `functions` ({name: callable}). Raises ValueError
    with the reason for anything else. Numbers are floats, so powers cannot grow without bound."""
    text = str(text)
    if len(text) > LONGEST:
        raise ValueError(f"an expression of more than {LONGEST} characters")
    functions = dict(functions)

    def value(node):
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            return float(node.value)
        if isinstance(node, ast.Name) and node.id in names:
            return names[node.id]
        if isinstance(node, ast.UnaryOp) and type(node.op) in UNARY:
            return UNARY[type(node.op)](value(node.operand))
        if isinstance(node, ast.BinOp) and type(node.op) in BINARY:
            return BINARY[type(node.op)](value(node.left), value(node.right))
        if isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in COMPARE:
            return COMPARE[type(node.ops[0])](value(node.left), value(node.comparators[0]))
        if (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Name)
            and node.func.id in functions
            and not node.keywords
        ):
            if any(isinstance(a, ast.Starred) for a in node.args):
                raise ValueError("'*' before an argument")
            return functions[node.func.id](*map(value, node.args))
        raise ValueError(
            f"'{ast.unparse(node)[:60]}' is not allowed here; use numbers, + - * / ^, comparisons and"
            f" {', '.join([*names, *functions])}"
        )

    try:
        return value(ast.parse(text.strip().replace("^", "**"), mode="eval").body)
    except SyntaxError:
        raise ValueError(f"'{text[:60]}' is neither a name nor an expression") from None
    except (TypeError, ArithmeticError, RecursionError, MemoryError) as error:
        raise ValueError(f"{type(error).__name__}: {error}") from error
