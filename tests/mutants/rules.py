# SPDX-License-Identifier: Apache-2.0
"""How a statement is broken: signs, factors, dropped terms, ranges off by one, owner and neighbour exchanged, < for <=.
A way to break it is a begin, an end and what stands there then, and the edits that let ON choose between both (none where no expression can)."""
import re

from cpp_text import CONSTANT

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


def _times(begin, end, broken, sound=1):
    """Edits that multiply what stands there by one of two factors."""
    return [(begin, begin, f"(ON ? {broken} : {sound}) * ("), (end, end, ")")]


def _signs(s):
    if s.counts or re.match(r"\s*for\b", s.text):
        return
    for m in _BINARY.finditer(s.text):
        if not _in_brackets(s.text, m.start()):
            yield m.start(1), m.end(1), "-" if m[1] == "+" else "+", _times(m.end(), _term_end(s.text, m.end()), -1)
    for m in re.finditer(r"(?<=[\w)\]]) ([+-])= (?!\d;)", s.text):
        yield m.start(1), m.end(1), "-" if m[1] == "+" else "+", _times(m.end(), s.text.find(";", m.end()), -1)
    for m in re.finditer(r"(?:(?<= = )|(?<=return )|(?<=\()|(?<=, ))-(?=[a-zA-Z(])", s.text):
        if not _in_brackets(s.text, m.start()):
            yield m.start(), m.end(), "", [(m.start(), m.end(), "(ON ? 1 : -1) * ")]


def _factors(s):
    if s.counts:
        return
    for m in _LITERAL.finditer(s.text):
        value = abs(float(m[0]))
        if 1e-5 < value < 1e5 and not _in_brackets(s.text, m.start()):
            for by in ("2", "0.9"):
                whole = by != "2" and m[0].isdigit()  # a choice of two types would change the sound one, too
                yield m.start(), m.end(), f"({m[0]} * {by})", None if whole else [(m.start(), m.end(), f"(ON ? {m[0]} * {by} : {m[0]})")]
    m = re.search(r"[+-]= (?!\d+;)([^;=]+);$", s.text)
    if m and not re.search(r"\bfor\b|\?", s.text):
        for by in ("2", "0.9"):
            yield m.start(1), m.end(1), f"{by} * ({m[1]})", _times(*m.span(1), by, "1.0")
    m = re.search(r"\breturn ([^;{}?=<>!]* [*/] [^;{}?=<>!]*);$", s.text)
    if m:
        for by in ("2", "0.9"):
            yield m.start(1), m.end(1), f"{by} * ({m[1]})", _times(*m.span(1), by, "1.0")


def _dropped(s):
    if s.counts or re.match(r"\s*for\b", s.text):
        return
    for m in _BINARY.finditer(s.text):
        end = _term_end(s.text, m.end())
        if not _in_brackets(s.text, m.start()) and s.text[m.end():end].strip() not in ("", "1"):
            yield m.start(), end, "", _times(m.end(), end, 0)
    m = re.search(r"(?:^|[)\s])([\w.\->()\[\]:& +*]+? [+-]= [^;=]+);$", s.text)
    if m and not re.search(r"\bfor\b|\bif\b", s.text) and not re.search(r"[+-]= \d;", s.text):
        first = len(s.text) - len(s.text.lstrip())
        guarded = re.match(r"\s*(?:else )?", s.text).end()
        yield first, len(s.text) - 1, "", [(guarded, guarded, "if (!ON) ")]


def _off_by_one(s):
    m = re.search(r"\bfor \((?:Index|std::size_t|int) (\w+) = (0|mesh_?\.n_interior|k_\.mesh\.n_interior); \1 < ([^;]+); \+\+\1\)", s.text)
    if m:
        yield m.start(2), m.end(2), "1" if m[2] == "0" else m[2] + " + 1", [(m.end(2), m.end(2), " + (ON ? 1 : 0)")]
        yield m.start(3), m.end(3), f"{m[3]} - 1", [(m.end(3), m.end(3), " - (ON ? 1 : 0)")]


def _swapped(s):
    if re.match(r"\s*for\b", s.text):
        return
    for m in re.finditer(r"\b(owner|neighbour)(?=\[)", s.text):
        path = re.search(r"(?:\w+(?:\.|->))*$", s.text[:m.start()])
        yield m.start(), m.end(), _SWAPPED[m[1]], [(path.start(), m.end(), f"(ON ? {path[0]}{_SWAPPED[m[1]]} : {path[0]}{m[1]})")]


def _operand(text, place, step):
    """Where the operand of a comparison ends, on the way from its operator."""
    depth = 0
    opens, closes = ("([{", ")]}") if step > 0 else (")]}", "([{")
    for k in range(place, len(text) if step > 0 else -1, step):
        c = text[k]
        if c in closes and depth == 0:
            return k if step > 0 else k + 1
        depth += (c in opens) - (c in closes)
        if depth == 0 and (c in ",;?" or text[k:k + 2] in ("&&", "||") or re.match(r"\s[=:]\s|return\s", text[k:k + 7])):
            return k if step > 0 else k + (7 if c == "r" else 3 if c.isspace() else 2 if c in "&|" else 1)
    return len(text) if step > 0 else 0


def _comparisons(s):
    if re.search(r"\bfor\b", s.text):
        return
    for m in re.finditer(r"(?<=[\w)\]]) (<=|<|>=|>) (?=[\w(-])", s.text):
        new = {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}[m[1]]
        begin, end = _operand(s.text, m.start() - 1, -1), _operand(s.text, m.end(), 1)
        left, right = s.raw[begin:m.start()], s.raw[m.end():end]
        yield m.start(1), m.end(1), new, [(begin, end, f"(ON ? {left} {new} {right} : {left} {m[1]} {right})")]


_RULES = {"sign": _signs, "factor": _factors, "dropped term": _dropped, "off by one": _off_by_one, "swapped sides": _swapped,
          "comparison": _comparisons}
NAMES = tuple(_RULES)


def broken(statement):
    """(rule, begin, end, what stands there then, edits by which ON chooses) of every way to break a statement, places in the file."""
    for rule, ways in _RULES.items():
        if statement.function == 0 and (rule != "factor" or not CONSTANT.search(statement.text)):
            continue
        at, fixed = statement.begin, re.search(r"(static )?constexpr", statement.text)
        for begin, end, new, choice in ways(statement):
            if choice and fixed:  # what a run chooses is no constant of the compiler
                choice = [*choice, (*fixed.span(), "static inline const" if fixed[1] and not statement.function else "const")]
            yield rule, at + begin, at + end, new, tuple((at + b, at + e, text) for b, e, text in choice) if choice else None
