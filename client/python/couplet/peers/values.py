# SPDX-License-Identifier: Apache-2.0
"""Values of a case for another program: units, expressions, and keys without a counterpart."""
import re

import numpy as np

from couplet.runs.case import Wrong
from couplet.study.axes import evaluate

BASE = {"g": 1e-3, "m": 1, "l": 1e-3, "s": 1, "N": 1, "Pa": 1, "bar": 1e5, "J": 1, "W": 1, "Wh": 3600, "K": 1, "Hz": 1}
WHOLE = {"kg": 1, "t": 1e3, "min": 60, "h": 3600, "day": 86400, "rad": 1, "deg": np.pi / 180, "%": 0.01, "1": 1}
# Keys of a participant that any program has, or that say how it is solved and written.
EVERYWHERE = set("program mesh mesh-scale mesh-parameters dimension boundaries probes output".split())
PREFIX = {"G": 1e9, "M": 1e6, "k": 1e3, "h": 1e2, "d": 1e-1, "c": 1e-2, "m": 1e-3, "u": 1e-6, "µ": 1e-6, "n": 1e-9}
QUANTITY = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(\D.*)?")
FUNCTIONS = {
    name: getattr(np, name) for name in "sin cos tan sinh cosh tanh exp log log10 log2 sqrt abs sign rint".split()
}
FUNCTIONS |= {
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "atan2": np.arctan2,
    "ln": np.log,
    "min": lambda *a: np.minimum.reduce(np.broadcast_arrays(*a)),
    "max": lambda *a: np.maximum.reduce(np.broadcast_arrays(*a)),
}


class Refused(Wrong):
    """Raised for a case that the other program cannot run. The message names the key."""


def refuse(where, why):
    raise Refused(f"{where}: {why}")


def unit_factor(text):
    """Factor of this unit to SI ("kg/m^3", "1/(m K)"), or None if it is unknown."""
    factor, sign, group = 1.0, 1, None
    for mark, word, power in re.findall(
        r"([()/])|([A-Za-zµ%]+|1)(?:\^?(-?\d+))?", text.replace("²", "2").replace("³", "3")
    ):
        if mark:
            sign, group = {"/": (-1, group), "(": (sign, sign), ")": (1, None)}[mark]
            continue
        size = WHOLE.get(word) or BASE.get(word) or PREFIX.get(word[0], np.nan) * BASE.get(word[1:], np.nan)
        factor *= size ** ((group or sign) * int(power or 1))
        sign = 1
    return factor if np.isfinite(factor) else None


def number(value, where):
    """Converts a number, optionally with a unit, to SI."""
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return float(value)
    match = QUANTITY.fullmatch(str(value).strip())
    factor = unit_factor(match[2] or "1") if match else None
    if factor is None:
        refuse(where, f"'{value}' is not a number with a unit")
    return float(match[1]) * factor


def field(value, where, points, time):
    """Evaluates a number or an expression of x, y, z, t at `points` (n, 3), as an array (n)."""
    try:
        return np.full(len(points), number(value, where))
    except Refused:
        pass
    if not isinstance(value, str):
        refuse(where, "only numbers and expressions can be exported, no tables")
    names = {"x": points[:, 0], "y": points[:, 1], "z": points[:, 2], "t": float(time), "pi": np.pi, "_e": np.e}
    try:
        return np.broadcast_to(np.asarray(evaluate(value, names, FUNCTIONS), float), len(points)).copy()
    except (ValueError, TypeError) as error:
        refuse(where, f"this expression cannot be exported: {error}")


def vector(value, where, points, time, dimension):
    """Evaluates a vector (n, 3). Missing components are 0."""
    if not isinstance(value, list) or len(value) != dimension:
        refuse(where, f"expected {dimension} components")
    found = np.zeros((len(points), 3))
    for axis, component in enumerate(value):
        found[:, axis] = field(component, f"{where}[{axis}]", points, time)
    return found


def depends_on_time(value):
    """Returns true if an expression, or one of a list, contains t."""
    return (
        any(map(depends_on_time, value))
        if isinstance(value, list)
        else isinstance(value, str) and re.search(r"(?<![\w.])t(?!\w)", value) is not None
    )


def only(section, where, known, program):
    """Rejects the first unknown key of a mapping by its name."""
    for key, value in (section or {}).items():
        if key not in known and value not in (None, [], {}, False):
            refuse(f"{where}.{key}", f"has no counterpart in {program}")


def settled(data):
    """Rejects a case whose effects the program chooses."""
    if data["simulation"].get("effects", "as-given") != "as-given":
        refuse(
            "simulation.effects",
            (
                f"'{data['simulation']['effects']}' lets the program choose what is solved; export the case with the"
                " effects that it chose"
            ),
        )
