# SPDX-License-Identifier: Apache-2.0
"""The section `study` for editors: what the modules of this folder accept."""
from couplet.study import dominance, pictures, quantities, study

CHANGES = {"type": ["object", "null"], "description": "keys and their values; they start at the participant unless they begin with a section"}
NUMBER = {"type": "number"}


def mapping(properties, **more):
    return {"type": "object", "properties": properties, "additionalProperties": False, **more}


def named(schema):
    return {"type": "object", "minProperties": 1, "additionalProperties": schema}


AXIS = {"oneOf": [
    mapping({"sizes": {"type": "array", "items": {"type": "number", "exclusiveMinimum": 0}}, "set": CHANGES, "multiple": {"type": "number", "minimum": 0}}, required=["sizes", "set"]),
    mapping({"ranks": {"type": "string"}, "values": {"type": "array", "items": {"type": "integer", "minimum": 1}}}, required=["ranks", "values"]),
    mapping({"key": {"type": "string"}, "values": {"type": "array"}}, required=["key", "values"]),
    mapping({"values": {"type": "object"}}, required=["values"])]}
VARIABLE = mapping({"key": {"type": "string"}, "from": NUMBER, "to": NUMBER, "unit": {"type": "string"}, "sets": {"type": "object", "additionalProperties": NUMBER}}, required=["from", "to"])
OPTIMISE = mapping({"minimise": {"type": "string"}, "maximise": {"type": "string"}, "runs": {"type": "integer", "minimum": 1}, "tolerance": NUMBER, "set": CHANGES,
                    "variables": {**named(VARIABLE), "maxProperties": 4}}, required=["variables"], oneOf=[{"required": ["minimise"]}, {"required": ["maximise"]}])
STUDY = {"description": "runs of this case for `couplet study` (docs/studies.md)", "oneOf": [
    mapping({"participant": {"type": "string"}, "variants": named({"type": ["object", "null"]}), "optimise": OPTIMISE,
             "sweeps": named(mapping({"key": {"type": "string"}, "values": {"type": "array"}}, required=["key", "values"]))},
            anyOf=[{"required": [word]} for word in ("variants", "sweeps", "optimise")]),
    mapping({**{name: {} for name in sorted(study.KEYS)}, "participant": {"type": "string"}, "alone": {"type": "boolean"}, "axes": named(AXIS), "set": CHANGES,
             "quantities": named({"type": "object", "propertyNames": {"enum": sorted(quantities.KEYS)}}), "clock": {"enum": list(pictures.CLOCKS)},
             "leave-out": {"type": "array", "items": {"type": "object"}}, "repeats": {"type": "integer", "minimum": 1}, "timeout": NUMBER, "title": {"type": "string"},
             "text": {"type": "string"}, "optimise": OPTIMISE, "sources": named({"type": "object", "propertyNames": {"enum": sorted(dominance.KEYS)}})},
            required=["axes", "quantities"])]}
