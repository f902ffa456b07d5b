#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every key with a unit, of every program, states a range: usual magnitudes, limits on both sides, or why it has none.
usage: keys.py BIN_FOLDER"""
import pathlib
import re
import subprocess
import sys

PROGRAMS = ("coupler", "fluid_solver", "solid_solver", "mesh_mover", "plate_modal", "thermocline")
LEAST = {"coupler": 6, "fluid_solver": 30, "solid_solver": 50, "mesh_mover": 4, "plate_modal": 17, "thermocline": 120}  # or the table is not read
NUMBER = r"-?[\d.]+(?:e[-+]?\d+)?"
USUAL = re.compile(rf"usual: ({NUMBER}) to ({NUMBER})")
LIMITS = re.compile(rf"(?:from|above) {NUMBER}(?: \S.*?)? (?:to|and at most) {NUMBER}")
HIDDEN = re.compile(r"\[(rad(/s)?|m(/s(\^2)?)?|s|K|Pa( s)?|kg/\S+|W/\S+|Hz)\]")  # a unit in the text of a key that declares none


def rows(binary):
    """(section, key, type, unit, default, allowed, meaning) of --docs."""
    text = subprocess.run([binary, "--docs"], capture_output=True, text=True, check=True).stdout
    section = ""
    for line in text.splitlines():
        if line.startswith("#"):
            section = line.lstrip("# ")
        cells = [c.strip().replace("\0", "|") for c in line.replace("\\|", "\0").split("|")]
        if len(cells) == 8 and cells[1].startswith("`"):
            yield [section] + [c.strip("`") for c in cells[1:7]]


def problem(key_type, unit, default, allowed, meaning):
    if not unit:
        hidden = key_type.startswith(("number", "list of 2", "list of numbers")) and HIDDEN.search(meaning)
        return f"its meaning has the unit {hidden.group(0)}, its declaration none" if hidden else ""
    usual = USUAL.search(allowed)
    if not usual:
        return "" if LIMITS.search(allowed) or "any magnitude: " in allowed else f"no range: '{allowed}'"
    lowest, highest = map(float, usual.groups())
    if not 0 <= lowest < highest:
        return f"{lowest} to {highest} is no range"
    value = re.match(NUMBER, default)
    if value and float(value.group(0)) != 0 and not lowest <= abs(float(value.group(0))) <= highest:
        return f"its default {default} is not usual: {allowed}"
    return ""


def main():
    binaries, bad, seen = pathlib.Path(sys.argv[1]), [], 0
    for program in PROGRAMS:
        with_unit = 0
        for section, key, *facts in rows(binaries / program):
            with_unit += bool(facts[1])
            if what := problem(*facts):
                bad.append(f"{program}: {section}.{key}: {what}")
        if with_unit < LEAST[program]:
            bad.append(f"{program}: {with_unit} keys with a unit, at least {LEAST[program]} were expected")
        seen += with_unit
    print("\n".join(bad))
    print(f"{seen} keys with a unit, {len(bad)} without a range")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
