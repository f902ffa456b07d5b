# SPDX-License-Identifier: Apache-2.0
"""The schemas for editors against all cases (valid) and the wrong ones of the tests: what a schema can see it refuses, as each kind of mistake
shows; and the patterns of units against what the programs accept. Usage: run.py PROJECT BIN"""
import json
import pathlib
import re
import subprocess
import sys

import yaml

try:
    import jsonschema
except ImportError:
    print("skipped: no python3-jsonschema here")
    sys.exit(77)

ROOT = pathlib.Path(sys.argv[1]).resolve()
sys.path[:0] = [str(ROOT / "tests/support"), str(ROOT / "tests/cli/wrong"), str(ROOT / "client/python")]
from checks import check, end  # noqa: E402
from couplet.documents import reference, units  # noqa: E402

BIN = pathlib.Path(sys.argv[2])
SCHEMAS = {pathlib.Path(name).name: json.loads(text) for name, text in reference.files(BIN).items() if name.endswith(".json")}


class Loader(yaml.SafeLoader):
    """Numbers as YAML 1.2 has them: 1e-5 is one."""


Loader.yaml_implicit_resolvers = {k: [r for r in v if r[0] not in ("tag:yaml.org,2002:float", "tag:yaml.org,2002:timestamp")] for k, v in yaml.SafeLoader.yaml_implicit_resolvers.items()}
Loader.add_implicit_resolver("tag:yaml.org,2002:float", re.compile(r"^[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?$"), list("-+0123456789."))
Loader.add_constructor("tag:yaml.org,2002:float", lambda loader, node: float(node.value))


def validator():
    store = {name: content for name, content in SCHEMAS.items()} | {"": SCHEMAS["case.json"]}
    resolver = jsonschema.RefResolver("", SCHEMAS["case.json"], store=store)
    return jsonschema.Draft202012Validator(SCHEMAS["case.json"], resolver=resolver)


def complaints(data):
    return sorted({"/".join(map(str, e.absolute_path)) + ": " + e.message[:80] for e in VALIDATOR.iter_errors(data)})


VALIDATOR = validator()
for schema in SCHEMAS.values():
    jsonschema.Draft202012Validator.check_schema(schema)

# -- all cases are valid
files = [f for f in (ROOT / "configs").glob("*/*.yaml") if "/out" not in str(f)]
bad = {}
for file in files:
    data = yaml.load(file.read_text(), Loader=Loader)
    if isinstance(data, dict) and {"participants", "case"} & set(data) and (found := complaints(data)):
        bad[str(file.relative_to(ROOT))] = found
check(f"all {len(files)} cases of configs/ are valid", len(files) > 60 and not bad, json.dumps(bad, indent=1))

# -- wrong ones are refused where a schema can
def wrong_cases():
    """(name, its YAML, what the program says, whether it is right after all) of the tests' tables."""
    import table
    for case in table.CASES:
        if case.exit_code == 0 or case.exit_code == 2 and not case.files and "--set" not in case.arguments:
            text = case.text if case.text is not None else edited(ROOT / f"tests/cli/wrong/{case.base}.yaml", case.edits)
            yield case.name, text, case.message.strip(), case.exit_code == 0
    del sys.modules["table"]
    sys.path.insert(0, str(ROOT / "tests/mistakes"))
    import table
    for mistake in (m for group in table.MISTAKES.values() for m in group):
        if mistake.outcome != table.FLAGGED and mistake.code is None and not mistake.set:
            yield mistake.name, edited(mistake.case, mistake.edits), mistake.message, mistake.outcome == table.RIGHT


def edited(file, edits):
    text = file.read_text()
    for old, new in edits:
        text = text.replace(old, new)
    return text


refused, let_through = 0, []
for name, text, message, right in wrong_cases():
    try:
        data = yaml.load(text, Loader=Loader)
    except yaml.YAMLError:
        continue
    wrong = not isinstance(data, dict) or bool(complaints(data))
    if right:
        check(f"right: {name}", not wrong, complaints(data))
    else:
        refused += wrong
        let_through += [] if wrong else [f"{name}: {message[:110]}"]
print(f"of {refused + len(let_through)} wrong cases the schema refuses {refused}; the others are wrong by files, meshes, or what several keys say together")
if "--list" in sys.argv:
    print(*let_through, sep="\n")
check("more than 200 wrong cases are tried, 75 and more are refused by the schema alone", refused >= 75 and refused + len(let_through) > 200, (refused, len(let_through)))
# What one key says by itself a schema sees. Let through is what depends on another key.
TOGETHER = ("heat without conductivity", "weekdays without a first one", "rule of a calendar: half a season", "flow without an inlet temperature", "mover without its coupled job",
            "tolerance in percent too large", "no coupling:",
            # names in the midst of texts and lists, and plain numbers where a unit is required
            "rule of a calendar: a day that is none", "foundation of an unknown material", "Celsius without a unit", "a table of temperatures without units",
            "degrees for radians in a motion", "angle of a wall without a unit", "unknown unit in round brackets", "unknown unit of a schedule", "negative film", "Poisson's ratio of a table", "a modulus of a table")
SEEN = r"unknown key|is required|is missing|is not convertible|is not one of|expected one of|unknown unit|expected a list|needs a name|out of range"
seen = [line for line in let_through if re.search(SEEN, line) and not line.startswith(TOGETHER)]
check("no unknown key, missing key, wrong word, wrong unit or number out of range is let through", not seen, json.dumps(seen, indent=1))

# -- units: what a program says about a number is what the pattern says
UNITS = {"kg/m^3": (["1.2 kg/m^3", "1200 g/l", "1 t/m3", "3 kg m^-3", "1e3 g / l", "2 kg/(m m m)", "1.5 N s^2/m^4"], ["1.2 kg", "5 kg/m^2", "3 Pa", "1 kgs/m^3", "2 kg/m^3 x", "1,2 kg/m^3"]),
         "Pa": (["4 MPa", "1 bar", "3 N/mm^2", "2 J/m^3", "5 kN/m²", "1 kg/(m s^2)", "2 kPa", "3 psi", "80 mmHg", "10 cmH2O"], ["4 N", "1 N/m", "3 ksi", "2 Pa s", "5 cP"]),
         "m/s": (["3 m/s", "10 km/h", "5 mm/day", "2 m s^-1", "1 m Hz"], ["3 m", "1 m/s^2", "7 kmh"]), "s": (["5 ms", "2 h", "1 day", "3 min", "1 Hz^-1"], ["2 m", "3 hours", "1 s^2"]),
         "rad": (["3 deg", "1.5 rad"], ["3 s", "2 grad"]), "rad/s": (["3 deg/s", "1 rad/s"], ["4 Hz", "1 rad", "2 1/s", "60 1/min", "50 %"]), "K difference": (["3 K", "0.5 mK"], ["3 degC", "3 degF", "4 s"]),
         "K": (["300 K", "20 degC"], ["20 C", "3 W"]), "W/(m^2 K)": (["5 W/(m^2 K)", "3 W/m^2/K", "2 kW/(m² K)"], ["5 W", "3 W/m^2", "1 W/K"])}
for unit, (good, wrong) in UNITS.items():
    pattern = SCHEMAS["units.json"]["$defs"][units.name_of(unit)]["pattern"]
    check(f"texts in {unit}", all(re.search(pattern, t) for t in good) and not any(re.search(pattern, t) for t in wrong),
          ([t for t in good if not re.search(pattern, t)], [t for t in wrong if re.search(pattern, t)]))
for t in [*UNITS["kg/m^3"][0], *UNITS["kg/m^3"][1]]:  # the same, by the program
    said = subprocess.run([BIN / "solid_solver", str(ROOT / "tests/cli/wrong/solid.yaml"), "--check", "--set", f"participants.solid.material.density={t}"], capture_output=True, text=True).stderr
    accepted = "density" not in said
    check(f"a program takes '{t}': {accepted}", accepted == (t in UNITS["kg/m^3"][0]), said)

# -- the rest of a case
flap = yaml.load((ROOT / "configs/perpendicular-flap/case.yaml").read_text(), Loader=Loader)
for path, value in (("simulation/endtime", "5 s"), ("simulation/time-step", "5 m"), ("simulation/output/folder", {}), ("coupling/scheme", "implict"), ("participant", {}),
                    ("participants/solid/material/density", "1.2 kg"), ("participants/solid/analysis", "dynamics"), ("simulation/end-time", None), ("study/axis", {})):
    data = json.loads(json.dumps(flap))
    node = data
    *parents, last = path.split("/")
    for part in parents:
        node = node.setdefault(part, {})
    if value is None:
        del node[last]
    else:
        node[last] = value
    check(f"refused: {path}: {value}", complaints(data), complaints(data))
end()
