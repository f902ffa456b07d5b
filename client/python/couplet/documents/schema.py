# SPDX-License-Identifier: Apache-2.0
"""Schemas for editors: those printed by the programs, with units as patterns, and one for a complete case file with its
sections `simulation`, `study` and `plot`."""
import collections
import json
import re

from couplet.documents import units
from couplet.plots.section import NUMBER, PLOT, mapping
from couplet.study import interest, pictures, quantities, study

EXPRESSION = ["number", "string", "object"]
A_QUANTITY = f"^ *{units.NUMBER} *(?![eE][+-]?[0-9])[A-Za-zµ%/][A-Za-zµ0-9^/*· ()²³-]*$"
WORTH_SHARING = 150  # characters of a description, above which a reference to it is shorter
PARTICIPANT = (  # problem_of_name of common/app/case/case_file.cpp
    r"^(?!(coupler|checkpoints|run)$)(?!-)[^/\\ .\n\t]{1,50}$"
)


def with_units(node, used):
    """Replaces the text of each unit by a reference to units.json. Collects the units in `used`."""
    if isinstance(node, list):
        return [with_units(n, used) for n in node]
    if not isinstance(node, dict):
        return node
    unit, found = node.get("x-unit"), {k: with_units(v, used) for k, v in node.items()}
    if not isinstance(unit, str):
        return found
    used.add(unit)
    return with_reference(found, {"$ref": f"units.json#/$defs/{units.name_of(unit)}"}, unit in units.BARE_NOT)


def with_reference(node, reference, bare_zero):
    """Replaces the pattern of a number with any unit. Where a bare number is ambiguous, zero is still allowed."""
    if isinstance(node, list):
        return [with_reference(n, reference, bare_zero) for n in node]
    if not isinstance(node, dict):
        return node
    if node.get("type") == "string" and "pattern" in node:
        rest = {k: v for k, v in node.items() if k not in ("type", "pattern")}
        return {
            **rest,
            **(
                {"anyOf": [{"const": 0}, reference]}
                if bare_zero and reference["$ref"].rpartition("/")[2] != "K"
                else reference
            ),
        }
    if node.get("type") == EXPRESSION:  # a number with a unit must have the right one
        rest = {k: v for k, v in node.items() if k != "type"}
        return {
            **rest,
            "anyOf": [{"type": ["number", "object"]}, {"type": "string", "not": {"pattern": A_QUANTITY}}, reference],
        }
    if (
        any(branch.get("minimum", branch.get("exclusiveMinimum", -1)) >= 0 for branch in node.get("anyOf", ()))
        and "K" not in reference["$ref"]
    ):
        reference = {**reference, "pattern": "^ *[+]?[0-9.]"}  # and must not be negative
    return {k: with_reference(v, reference, bare_zero) if k in ("anyOf", "items") else v for k, v in node.items()}


def is_description(node):
    """True for the schema of a value, but not for the table below `properties`, whose keys are names."""
    return isinstance(node, dict) and any(
        isinstance(node.get(key), kind) for key, kind in (("type", (str, list)), ("anyOf", list), ("oneOf", list))
    )


def shared(schema):
    """Moves descriptions that occur more than once to `$defs`: the parts of a boundary have the same conditions as the
    whole."""
    times, names, found = collections.Counter(), {}, {}

    def count(node):
        if is_description(node):
            times[json.dumps(node)] += 1
        if not is_description(node) or times[json.dumps(node)] == 1:
            for child in node.values() if isinstance(node, dict) else node if isinstance(node, list) else ():
                count(child)

    def with_references(node, key):
        if isinstance(node, list):
            return [with_references(n, key) for n in node]
        if not isinstance(node, dict):
            return node
        text = json.dumps(node)
        if times[text] > 1 and len(text) > WORTH_SHARING:
            if text not in names:
                names[text] = f"{key}-{len(names) + 1}"
                found[names[text]] = {k: with_references(v, k) for k, v in node.items()}
            return {"$ref": f"#/$defs/{names[text]}"}
        return {k: with_references(v, k) for k, v in node.items()}

    count(schema)
    return with_references(schema, "") | ({"$defs": found} if found else {})


# -- the section `study` -----------------------------------------------------------------------------------------------
CHANGES = {
    "type": ["object", "null"],
    "description": "keys and their values; a key is relative to the participant unless it begins with a section",
}


def named(schema):
    return {"type": "object", "minProperties": 1, "additionalProperties": schema}


AXIS = {
    "oneOf": [
        mapping(
            {
                "sizes": {"type": "array", "items": {"type": "number", "exclusiveMinimum": 0}},
                "set": CHANGES,
                "multiple": {"type": "number", "minimum": 0},
            },
            required=["sizes", "set"],
        ),
        mapping(
            {"ranks": {"type": "string"}, "values": {"type": "array", "items": {"type": "integer", "minimum": 1}}},
            required=["ranks", "values"],
        ),
        mapping({"key": {"type": "string"}, "values": {"type": "array"}}, required=["key", "values"]),
        mapping({"values": {"type": "object"}}, required=["values"]),
    ]
}
VARIABLE = mapping(
    {
        "key": {"type": "string"},
        "from": NUMBER,
        "to": NUMBER,
        "unit": {"type": "string"},
        "sets": {"type": "object", "additionalProperties": NUMBER},
    },
    required=["from", "to"],
)
OPTIMISE = mapping(
    {
        "minimise": {"type": "string"},
        "maximise": {"type": "string"},
        "runs": {"type": "integer", "minimum": 1},
        "tolerance": NUMBER,
        "set": CHANGES,
        "variables": {**named(VARIABLE), "maxProperties": 4},
    },
    required=["variables"],
    oneOf=[{"required": ["minimise"]}, {"required": ["maximise"]}],
)
STUDY = {
    "description": "runs of this case for `couplet study` (docs/studies.md)",
    "oneOf": [
        mapping(
            {
                "participant": {"type": "string"},
                "variants": named({"type": ["object", "null"]}),
                "optimise": OPTIMISE,
                "sweeps": named(
                    mapping({"key": {"type": "string"}, "values": {"type": "array"}}, required=["key", "values"])
                ),
            },
            anyOf=[{"required": [word]} for word in ("variants", "sweeps", "optimise")],
        ),
        mapping(
            {
                **{name: {} for name in sorted(study.KEYS)},
                "participant": {"type": "string"},
                "alone": {"type": "boolean"},
                "axes": named(AXIS),
                "set": CHANGES,
                "quantities": named({"type": "object", "propertyNames": {"enum": sorted(quantities.KEYS)}}),
                "clock": {"enum": list(pictures.CLOCKS)},
                "leave-out": {"type": "array", "items": {"type": "object"}},
                "repeats": {"type": "integer", "minimum": 1},
                "timeout": NUMBER,
                "title": {"type": "string"},
                "text": {"type": "string"},
                "optimise": OPTIMISE,
                "sources": named({"type": "object", "propertyNames": {"enum": sorted(interest.KEYS)}}),
            },
            required=["axes", "quantities"],
        ),
    ],
}


# -- sections that a program describes as Markdown ---------------------------------------------------------------------
def limits(allowed):
    found = {}
    for pattern, key in (
        (r"above (-?[\d.e+-]+)", "exclusiveMinimum"),
        (r"at least (-?[\d.e+-]+)", "minimum"),
        (r"from (-?[\d.e+-]+) to", "minimum"),
        (r"from \S+ to (-?[\d.e+-]+)", "maximum"),
    ):
        if match := re.search(pattern, allowed.partition("usual")[0]):
            found[key] = float(match[1])
    return found


def of_row(kind, unit, allowed):
    text = {"type": ["string", "number", "boolean"]}
    if kind == "word":
        return {"enum": re.findall(r"`([^`]+)`", allowed)}
    if kind == "true or false":
        return {"type": "boolean"}
    if kind.startswith("list"):
        return {"type": "array", "items": text}
    if kind not in ("number", "whole number"):
        return text
    number = {"type": "integer" if kind == "whole number" else "number", **limits(allowed)}
    if kind == "whole number":
        return number
    return {
        **({"x-unit": unit} if unit else {}),
        "anyOf": [
            number,
            {"type": "string", "pattern": f"^{units.NUMBER} *[^0-9 ].*$" if unit else f"^{units.NUMBER}$"},
        ],
    }


def of_markdown(text):
    """Schema of a section from the tables that a program prints: one heading per mapping, one row per key."""
    root = {"type": "object", "properties": {}, "additionalProperties": False}
    node = root
    for line in text.splitlines():
        if heading := re.match(r"#+ `([\w.-]+)`", line):
            node = root
            for part in heading[1].split("."):
                node = node["properties"].setdefault(part, {})
            node.update({"type": "object", "properties": {}, "additionalProperties": False})
        row = [c.strip().replace("\\|", "|") for c in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(row) == 6 and (key := re.match(r"`([\w-]+)`", row[0])):
            _, kind, unit, default, allowed, meaning = row
            node["properties"][key[1]] = {
                "description": meaning,
                **({} if kind == "mapping" else of_row(kind, unit.strip("`"), allowed)),
            }
            if "required" in default:
                node.setdefault("required", []).append(key[1])
    return root


def case_schema(programs, simulation):
    """Schema of a complete case file. The program of an entry determines its keys."""
    choices = [
        {
            "if": {"properties": {"program": {"const": program}}, "required": ["program"]},
            "then": {"$ref": f"{program}.json"},
        }
        for program in programs
    ]
    participants = {
        "type": "object",
        "minProperties": 1,
        "propertyNames": {"pattern": PARTICIPANT},
        "additionalProperties": {"type": "object", "required": ["program"], "allOf": choices},
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Couplet case",
        "type": "object",
        "oneOf": [
            {"required": ["simulation", "participants"], "not": {"required": ["case"]}},
            {"required": ["case", "study"], "maxProperties": 2},
        ],
        "properties": {
            "simulation": simulation,
            "participants": participants,
            "coupling": {"$ref": "coupler.json"},
            "study": STUDY,
            "plot": PLOT,
            "case": {"type": "string", "description": "another case file to which this study belongs"},
        },
        "additionalProperties": False,
    }


def files(ask, programs, source):
    """Returns {name: text} of docs/schema. `ask`(program, question) returns its output; `source` is the text of
    common/base/units.cpp."""
    used, found = set(), {}
    for program in programs:
        found[program] = shared(with_units(json.loads(ask(program, "--schema")), used))
    simulation = re.search(r"^#+ simulation$(.*)", ask("coupler", "--docs"), flags=re.M | re.S)[1]
    found["case"] = with_units(case_schema(programs[1:], of_markdown(simulation)), used)
    found["units"] = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Numbers with a unit",
        "$defs": units.definitions(used, source),
    }
    return {
        f"docs/schema/{name}.json": json.dumps(content, indent=1, ensure_ascii=False) + "\n"
        for name, content in found.items()
    }
