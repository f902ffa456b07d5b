# SPDX-License-Identifier: Apache-2.0
"""Patterns of units: texts that are a number with a unit convertible to a given one. Exact for units of one or two
symbols (12 kg is not a density). Longer products, brackets and negative powers are accepted if all symbols are
known."""
import itertools
import re

NUMBER = r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?"
PREFIX = "[GMkhdcmunµ]"
POWERS = range(1, 5)
BARE_NOT = ("K", "rad", "rad/s")  # as needs_unit() of common/base/units.hpp


def symbols(source):
    """Returns {name: (takes a prefix, dimension (kg, m, s, K, rad))} of common/base/units.cpp."""
    found = re.findall(r'\{"([^"]+)", (true|false), make\([^,]+, (-?\d+), (-?\d+), (-?\d+), (-?\d+), (-?\d+)', source)
    return {name: (prefixed == "true", tuple(map(int, dimension))) for name, prefixed, *dimension in found}


def dimension_of(unit, table):
    """Dimension of a unit of the keys, such as W/(m^2 K)."""
    text, total, sign = unit.replace("K difference", "K"), [0] * 5, 1
    for slash, name, power in re.findall(r"(/)?\s*\(?\s*([A-Za-z%]+|1)\)?(?:\^(\d+))?", text):
        sign = -1 if slash else sign
        if name != "1":
            for i, d in enumerate(table[name][1]):
                total[i] += sign * d * int(power or 1)
    return tuple(total)


def written(names, table):
    """Pattern of any of these symbols, with prefixes."""
    with_prefix = [re.escape(n) for n in names if table[n][0]]
    plain = [re.escape(n) for n in names if not table[n][0]]
    return "(" + "|".join([*([f"{PREFIX}?({'|'.join(with_prefix)})"] if with_prefix else []), *plain]) + ")"


def raised(pattern, power):
    marks = {1: r"(\^?1)?", 2: r"(\^?2|²)", 3: r"(\^?3|³)"}
    return pattern + marks.get(power, rf"\^?{power}")


def pattern_of(unit, table):
    """Regular expression for the unit that follows the number."""
    wanted, classes = dimension_of(unit, table), {}
    for name, (_, dimension) in table.items():
        if not (unit == "K difference" and name in ("degC", "degF")):
            classes.setdefault(dimension, []).append(name)
    written_as = {dimension: written(names, table) for dimension, names in classes.items()}
    found = []
    for (d, text), p in itertools.product(written_as.items(), POWERS):
        if tuple(p * x for x in d) == wanted:
            found.append(raised(text, p))
        if tuple(-p * x for x in d) == wanted:
            found.append(r"(1 *)?/ *" + raised(text, p))
    powers = [(d, text, p) for d, text in written_as.items() for p in (POWERS if any(d) else (1,))]
    for (d, left, p), (e, right, q) in itertools.product(powers, repeat=2):
        if tuple(p * x + q * y for x, y in zip(d, e)) == wanted:
            found.append(raised(left, p) + "( *[*·] *| +)" + raised(right, q))
        if tuple(p * x - q * y for x, y in zip(d, e)) == wanted:
            found.append(raised(left, p) + " */ *" + raised(right, q))
    any_symbol = written(table, table)
    power = r"(\^?-?[0-9]+|²|³)?"
    many = rf"[(1/ ]*{any_symbol}{power}([)/*· ]+[(]*{any_symbol}{power})" + "{2,}[) ]*"
    bracketed_or_negative = rf"(?=.*[(-])[(1/ ]*{any_symbol}{power}([)/*· ]+[(]*{any_symbol}{power})*[) ]*"
    return "(" + "|".join([*dict.fromkeys(found), many, bracketed_or_negative]) + ")"


def name_of(unit):
    """Name of a unit's definition in units.json."""
    return re.sub(r"[^A-Za-z0-9-]", "", unit.replace("/", "-per-").replace(" ", "-"))


def definitions(units, source):
    """Returns {name: schema of a text} for units.json."""
    table = symbols(source)
    return {
        name_of(unit): {"title": unit, "type": "string", "pattern": f"^ *{NUMBER} *{pattern_of(unit, table)} *$"}
        for unit in sorted(units)
    }
