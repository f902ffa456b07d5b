# SPDX-License-Identifier: Apache-2.0
"""How a statement is broken: signs, factors, dropped terms, ranges off by one, owner and neighbour exchanged, < for <=."""
import re

from cpp_text import CONSTANT

# How often a rule is asked for, beside the others.
WEIGHTS = {"sign": 3.0, "factor": 3.0, "dropped term": 3.0, "off by one": 0.6, "swapped sides": 3.0, "comparison": 0.3}
_LITERAL = re.compile(r"(?<![\w.\"])(?<!e-)(?:\d+\.\d*|\d+\.|\d+(?= \* [a-zA-Z(])|(?<=/ )\d+(?![\w.]))(?:e[+-]?\d+)?(?![\w.])")
_BINARY = re.compile(r"(?<=[\w)\]]) ([+-]) (?=[\w(*])")
_SWAPPED = {"owner": "neighbour", "neighbour": "owner"}


def _in_brackets(text, place):
    """Whether a place is within [...], where numbers are places themselves."""
    depth = 0
    for c in text[:place]:
        depth += (c == "[") - (c == "]")
    return depth > 0


def _term_end(text, place):
    """Where the term that begins there ends: at an operator of a sum or below, a comma or the end of its bracket."""
    depth = 0
    for k in range(place, len(text)):
        c = text[k]
        if c in "([{":
            depth += 1
        elif c in ")]}":
            if depth == 0:
                return k
            depth -= 1
        elif depth == 0 and (c in ",;?" or re.match(r" (?:[+\-:<>]|<=|>=|==|!=|&&|\|\|) ", text[k:k + 4])):
            return k
    return len(text)


def _signs(s):
    if s.counts or re.match(r"\s*for\b", s.text):
        return
    for m in _BINARY.finditer(s.text):
        if not _in_brackets(s.text, m.start()):
            yield m.start(1), m.end(1), "-" if m[1] == "+" else "+"
    for m in re.finditer(r"(?<=[\w)\]]) ([+-])= (?!\d;)", s.text):
        yield m.start(1), m.end(1), "-" if m[1] == "+" else "+"
    for m in re.finditer(r"(?:(?<= = )|(?<=return )|(?<=\()|(?<=, ))-(?=[a-zA-Z(])", s.text):
        if not _in_brackets(s.text, m.start()):
            yield m.start(), m.end(), ""


def _factors(s):
    if s.counts:
        return
    for m in _LITERAL.finditer(s.text):
        value = abs(float(m[0]))
        if 1e-5 < value < 1e5 and not _in_brackets(s.text, m.start()):
            for by in ("2", "0.9"):
                yield m.start(), m.end(), f"({m[0]} * {by})"
    m = re.search(r"[+-]= (?!\d+;)([^;=]+);$", s.text)
    if m and not re.search(r"\bfor\b|\?", s.text):
        for by in ("2", "0.9"):
            yield m.start(1), m.end(1), f"{by} * ({m[1]})"
    m = re.search(r"\breturn ([^;{}?=<>!]* [*/] [^;{}?=<>!]*);$", s.text)
    if m:
        for by in ("2", "0.9"):
            yield m.start(1), m.end(1), f"{by} * ({m[1]})"


def _dropped(s):
    if s.counts or re.match(r"\s*for\b", s.text):
        return
    for m in _BINARY.finditer(s.text):
        end = _term_end(s.text, m.end())
        if not _in_brackets(s.text, m.start()) and s.text[m.end():end].strip() not in ("", "1"):
            yield m.start(), end, ""
    m = re.search(r"(?:^|[)\s])([\w.\->()\[\]:& +*]+? [+-]= [^;=]+);$", s.text)
    if m and not re.search(r"\bfor\b|\bif\b", s.text) and not re.search(r"[+-]= \d;", s.text):
        first = len(s.text) - len(s.text.lstrip())
        yield first, len(s.text) - 1, ""


def _off_by_one(s):
    m = re.search(r"\bfor \((?:Index|std::size_t|int) (\w+) = (0|mesh_?\.n_interior|k_\.mesh\.n_interior); \1 < ([^;]+); \+\+\1\)", s.text)
    if m:
        yield m.start(2), m.end(2), "1" if m[2] == "0" else m[2] + " + 1"
        yield m.start(3), m.end(3), f"{m[3]} - 1"


def _swapped(s):
    if re.match(r"\s*for\b", s.text):
        return
    for m in re.finditer(r"\b(owner|neighbour)(?=\[)", s.text):
        yield m.start(), m.end(), _SWAPPED[m[1]]


def _comparisons(s):
    if re.search(r"\bfor\b", s.text):
        return
    for m in re.finditer(r"(?<=[\w)\]]) (<=|<|>=|>) (?=[\w(-])", s.text):
        yield m.start(1), m.end(1), {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}[m[1]]


_RULES = {"sign": _signs, "factor": _factors, "dropped term": _dropped, "off by one": _off_by_one, "swapped sides": _swapped,
          "comparison": _comparisons}


def broken(statement):
    """(rule, begin, end, what stands there then) of every way to break a statement, places in the file."""
    for rule, ways in _RULES.items():
        if statement.function == 0 and rule != "factor":
            continue
        for begin, end, new in ways(statement):
            if not (statement.function == 0 and not CONSTANT.search(statement.text)):
                yield rule, statement.begin + begin, statement.begin + end, new
