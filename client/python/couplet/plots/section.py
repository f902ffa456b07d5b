# SPDX-License-Identifier: Apache-2.0
"""The section `plot` of a case: its keys, what they accept, and its schema for editors.

plot:
  title: ...                   # of the whole picture
  size: [14, 4.6]              # width and height [inch]
  columns: 2                   # diagrams side by side (all of them, at most 3)
  file: name.png               # in the output folder (<folder of the case>.png)
  panels:
    - title: ...
      x: {label: "time [s]", from: 0, to: 5, log: true}
      y: {label: "tip [m]"}
      curves:                  # each reads one source
        - {monitor: solid/probes.csv, y: "tip x [m]", label: Couplet}      # a file of the output folder
        - {table: reference/tip.csv, x: "time [s]", y: "tip [m]", style: points}   # a file beside the case
        - {fields: solid, with: {s: stress-xx}, x: "sqrt(x^2+y^2)", y: s/1e6, where: x > 0}  # cells of the last output
        - {function: "exp(-x)", from: 0, to: 5}
        - {points: [[0.7, 0.22]], style: points}
        - {levels: [0.22, 0.23], style: dotted}
        - {python: "tip.py: motion", x: "time [s]", y: "tip [m]"}   # columns that a function of a file beside the case
                                                                    makes of the first participant's folder
    - field: velocity          # a map
      participant: fluid
      at: 2 s                  # or {first-maximum: "tip x [m]", monitor: solid/probes.csv}
      bodies: [solid]
  quantities: {tip: {probe: "tip x [m]", at: maximum, participant: solid, reference: 0.22}}  # printed
                                                                                             (docs/studies.md)"""
import re

from couplet.runs.case import expect

SOURCES = ("monitor", "table", "fields", "function", "points", "levels", "python")
STYLES = ("line", "points", "crosses", "pluses", "squares", "dots", "dashed", "dotted")
TEXT, NUMBER, FLAG = {"type": "string"}, {"type": "number"}, {"type": "boolean"}
VALUE, EXPRESSION = {"type": ["number", "string"]}, {"type": ["string", "number"]}
PAIR = {"type": "array", "items": NUMBER, "minItems": 2, "maxItems": 2}


def mapping(properties, **more):
    return {"type": "object", "properties": properties, "additionalProperties": False, **more}


AXIS = mapping({"label": TEXT, "from": NUMBER, "to": NUMBER, "log": FLAG})
CURVE = mapping(
    {
        "monitor": TEXT,
        "table": TEXT,
        "fields": TEXT,
        "python": TEXT,
        "function": EXPRESSION,
        "levels": {"type": "array", "items": NUMBER, "minItems": 1},
        "points": {"type": "array", "items": PAIR, "minItems": 1},
        "with": {"type": "object", "additionalProperties": TEXT},
        "x": EXPRESSION,
        "y": EXPRESSION,
        "where": TEXT,
        "each": EXPRESSION,
        "at": VALUE,
        "from": NUMBER,
        "to": NUMBER,
        "label": TEXT,
        "style": {"enum": list(STYLES)},
        "colour": TEXT,
        "every": {"type": "integer", "minimum": 1},
        "extrema": FLAG,
        "sorted": FLAG,
        "optional": FLAG,
    },
    oneOf=[{"required": [s]} for s in SOURCES],
)
TOP = mapping({"first-maximum": TEXT, "monitor": TEXT}, required=["first-maximum", "monitor"])
PANEL = mapping(
    {
        "title": TEXT,
        "x": AXIS,
        "y": AXIS,
        "curves": {"type": "array", "items": CURVE, "minItems": 1},
        "legend": {"type": ["boolean", "integer"]},
        "field": TEXT,
        "participant": TEXT,
        "at": {"anyOf": [VALUE, TOP]},
        "component": {"enum": ["x", "y", "z"]},
        "warp": NUMBER,
        "factor": NUMBER,
        "label": TEXT,
        "bodies": {"type": "array", "items": TEXT},
        "mesh": TEXT,
        "range": PAIR,
        "colours": TEXT,
        "axes": FLAG,
        "plane": TEXT,
    },
    oneOf=[{"required": ["curves"]}, {"required": ["field"]}],
)
PLOT = {
    "description": "the picture that `couplet plot` draws of a run of this case (docs/plots.md)",
    **mapping(
        {
            "title": TEXT,
            "size": PAIR,
            "columns": {"type": "integer", "minimum": 1},
            "file": TEXT,
            "panels": {"type": "array", "items": PANEL, "minItems": 1},
            "share-x": FLAG,
            "quantities": {"type": "object", "additionalProperties": {"type": "object"}},
        },
        required=["panels"],
    ),
}
OF_FIELD = {
    "participant",
    "at",
    "component",
    "warp",
    "factor",
    "label",
    "bodies",
    "mesh",
    "range",
    "colours",
    "axes",
    "plane",
}
KINDS = {"string": str, "number": (int, float), "boolean": bool, "integer": int, "array": list, "object": dict}
NAMES = {
    "string": "text",
    "number": "a number",
    "boolean": "true or false",
    "integer": "a whole number",
    "array": "a list",
    "object": "a mapping",
}


def is_of(value, kind):
    return isinstance(value, KINDS[kind]) and (kind == "boolean" or not isinstance(value, bool))


def follow(value, schema, where):
    """Checks a value against the subset of JSON schema used above. Wrong states the location and what is allowed."""
    if "anyOf" in schema:
        schema = schema["anyOf"][1 if isinstance(value, dict) else 0]
    if "enum" in schema:
        expect(value in schema["enum"], f"{where}: '{value}'; allowed: {', '.join(schema['enum'])}.")
        return
    kinds = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
    expect(
        any(is_of(value, k) for k in kinds),
        f"{where}: expected {' or '.join(NAMES[k] for k in kinds)}, found '{str(value)[:40]}'.",
    )
    if isinstance(value, dict) and "properties" in schema:
        unknown = [k for k in value if k not in schema["properties"]]
        expect(
            not unknown, f"{where}: unknown key '{(unknown or [''])[0]}'; allowed: {', '.join(schema['properties'])}."
        )
        missing = [k for k in schema.get("required", ()) if k not in value]
        expect(not missing, f"{where}: the key '{(missing or [''])[0]}' is missing.")
    if isinstance(value, dict):
        for key, item in value.items():
            inner = schema.get("properties", {}).get(key) or schema.get("additionalProperties")
            follow(item, inner, f"{where}.{key}") if inner else None
    elif isinstance(value, list):
        low, high = schema.get("minItems", 0), schema.get("maxItems", 10**6)
        expect(
            low <= len(value) <= high,
            f"{where}: expected {low if low == high else f'at least {low}'} values, found {len(value)}.",
        )
        for i, item in enumerate(value):
            follow(item, schema["items"], f"{where}[{i}]")
    elif "minimum" in schema:
        expect(
            value >= schema["minimum"], f"{where}: expected a number of at least {schema['minimum']}, found {value}."
        )


def seconds(value, where):
    """Converts a time, a number [s] or text such as `2 s`. Returns None for `last`."""
    if value in (None, "last"):
        return None
    found = re.fullmatch(r"([-+\d.eE]+)\s*(?:s)?", str(value).strip())
    try:
        return float(found[1])
    except (TypeError, ValueError):
        expect(False, f"{where}: '{value}' is not a time in seconds; expected for example 2 s, or last.")


def check(case):
    """Section of a case. Raises Wrong if it is invalid."""
    section, place = case.data["plot"], f"{case.file}: plot"
    follow(section, PLOT, place)
    file = section.get("file", "x.png")
    expect(
        all(1 <= v <= 100 for v in section.get("size", ())),
        f"{place}.size: expected width and height from 1 to 100 inch, found {section.get('size')}.",
    )
    expect(
        "/" not in file and file.endswith(".png"),
        f"{place}.file: '{file}'; expected a name that ends in .png: it is written to the output folder.",
    )
    for i, panel in enumerate(section["panels"]):
        where = f"{place}.panels[{i}]"
        expect(("curves" in panel) != ("field" in panel), f"{where}: expected either curves or field.")
        strange = sorted(OF_FIELD & set(panel)) if "curves" in panel else []
        expect(not strange, f"{where}: '{(strange or [''])[0]}' belongs to a field.")
        for name in [panel[k] for k in ("participant",) if k in panel] + panel.get("bodies", []):
            expect(
                name in case.participants,
                f"{where}: there is no participant '{name}'; the participants are: {', '.join(case.participants)}.",
            )
        if not isinstance(panel.get("at"), dict):
            seconds(panel.get("at"), f"{where}.at")
        for j, curve in enumerate(panel.get("curves", ())):
            sources = [s for s in SOURCES if s in curve]
            expect(len(sources) == 1, f"{where}.curves[{j}]: expected one of {', '.join(SOURCES)}.")
            expect(
                "fields" not in curve or curve["fields"] in case.participants,
                (
                    f"{where}.curves[{j}].fields: there is no participant '{curve.get('fields')}'; the participants"
                    f" are: {', '.join(case.participants)}."
                ),
            )
            expect(
                sources[0] in ("function", "points", "levels") or "y" in curve,
                f"{where}.curves[{j}]: the key 'y' is missing; give a column or an expression.",
            )
            seconds(curve.get("at"), f"{where}.curves[{j}].at")
            expect(
                "optional" not in curve or "monitor" in curve, f"{where}.curves[{j}]: 'optional' belongs to a monitor."
            )
            if "python" in curve:
                file, _, function = (part.strip() for part in curve["python"].partition(":"))
                expect(
                    function and (case.file.parent / file).is_file() and "/" not in file,
                    (
                        f"{where}.curves[{j}].python: '{curve['python']}'; expected 'FILE.py: FUNCTION', with a file"
                        " next to the case."
                    ),
                )
            expect(
                "function" not in curve or {"from", "to"} <= set(curve),
                f"{where}.curves[{j}]: a function needs 'from' and 'to'.",
            )
    if "quantities" in section:
        from couplet.study.quantities import quantities_of

        quantities_of(case, section, next(iter(case.participants)), "plot")
    return section
