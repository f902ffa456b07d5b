#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes numbers with units as people spell them (spellings.yaml) into each place where one may stand, runs the program, and measures the value that the run used.
usage: spellings.py BIN_FOLDER [PLACE ...]"""
import csv
import pathlib
import sys
import tempfile

import yaml

import run
import table

PLANT = next(m for m in table.MISTAKES["reliability"] if m.base == "tank").edits[0][0]  # the plant of tank.yaml
PULL = "value: [1 MPa, 0]"
TWO = "0,{v}\n2,{v}\n"


def of_probe(folder):
    """Traction [Pa] that pulled the sheet, which is linear."""
    with open(folder / "out/solid/probes.csv", encoding="utf-8") as file:
        row = list(csv.DictReader(file))[-1]
    return float(next(value for name, value in row.items() if name.startswith("corner x")))


def scalar(*path):
    """A value in force, in SI."""
    def read(folder):
        node = yaml.safe_load(next((folder / "out").glob("*/effective.yaml")).read_text(encoding="utf-8"))
        for key in path:
            node = node[key]
        return float(str(node).split()[0])
    return read


def last_time(folder):
    return float((next((folder / "out").glob("*/steps.csv"))).read_text().splitlines()[-1].split(",")[0])


def second_flow(folder):
    """Start [s] of the second row of the schedule."""
    with open(folder / "out/tank/tank.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return next(float(r["time [s]"]) for r in rows if float(r["mass flow [kg/s]"]) == 5) - 10


def pulled(text, files=None):
    return "solid", [(PULL, f"value: [{text}, 0]")], files or {}


def quoted(spelling):
    return "'" + spelling.replace("'", "''") + "'"


def of_file(heading, rows=TWO.format(v=145), text="{of: t, file: p.csv}"):
    return pulled(text, {"p.csv": heading + "\n" + rows})


def with_expression(first, rows):
    def place(spelling):
        heading, expression = (part.strip() for part in spelling.split(" | "))
        return pulled(quoted(expression), {"p.csv": first.format(heading) + "\n" + rows})
    return place


def edit(base, old, new):
    return lambda spelling: (base, [(old, new.replace("HERE", quoted(spelling)))], {})


DECK = "*NODE\n1, 0, 0\n2, HERE, 0\n3, 1, 1\n4, 0, 1\n*ELEMENT, TYPE=CPS4, ELSET=all\n1, 1, 2, 3, 4\n*SURFACE, NAME=bottom\n1, S1\n*SURFACE, NAME=right\n1, S2\n*SURFACE, NAME=top\n1, S3\n*SURFACE, NAME=left\n1, S4\n"
SCHEDULE = "HERE,mass-flow [kg/s],inlet-temperature [degC]\n0,-5,390\n20,5,290\n"
# {place: (base, edits and files of a spelling, what is measured, what is right there for a value in SI if it is not the value)}
PLACES = {
    "pressure": (lambda s: pulled(quoted(s)), of_probe, lambda v: v),
    "expression": (lambda s: pulled(quoted(s)), of_probe, lambda v: v),
    "table value": (lambda s: pulled(f"{{of: t, at: [0, 2 s], values: [{quoted(s)}, {quoted(s)}]}}"), of_probe, lambda v: v),
    "table time": (lambda s: pulled(f"{{of: t, at: [0, {quoted(s)}], values: [0, 1 Pa]}}"), of_probe, lambda v: 1 / v),
    "heading of values": (lambda s: of_file("t [s]," + s), of_probe, lambda v: v),
    "heading of times": (lambda s: of_file(s + ",p [Pa]", "0,0\n2,1\n"), of_probe, lambda v: 1 / v),
    "scaled table": (with_expression("t [s],{}", TWO.format(v=2)), of_probe, lambda v: v),
    "variable of a table": (with_expression("{},p [Pa]", "0,0\n2,1\n"), of_probe, lambda v: v),
    "density": (edit("solid", "density: 7850 kg/m^3", "density: HERE"), scalar("material", "density"), None),
    "end of the run": (edit("solid", "end-time: 1 s, time-step: 1 s", "end-time: HERE, time-step: 0.1 s"), last_time, None),
    "temperature": (edit("heat", "initial-temperature: 20 degC", "initial-temperature: HERE"), scalar("heat", "initial-temperature"), None),
    "conductivity": (edit("heat", "conductivity: 50 W/(m K)", "conductivity: HERE"), scalar("material", "conductivity"), None),
    "viscosity": (edit("fluid", "viscosity: 50 Pa s", "viscosity: HERE"), scalar("viscosity"), None),
    "speed": (edit("fluid", "velocity: [0.1 m/s, 0 m/s]", "velocity: [HERE, 0]"), scalar("boundaries", "left", "velocity", 0), None),
    "rotation": (edit("fluid", "top: {type: slip}", "top: {type: moving-wall, rotation: {speed: HERE}}"), scalar("boundaries", "top", "rotation", "speed"), None),
    "ratio": (edit("solid", "poissons-ratio: 0.3", "poissons-ratio: HERE"), scalar("material", "poissons-ratio"), None),
    "thickness": (edit("plate", "thickness: 5 mm", "thickness: HERE"), scalar("thickness"), None),
    "mesh scale": (edit("solid", "mesh: square.msh", "mesh: square.msh\n    mesh-scale: HERE"), scalar("mesh-scale"), None),
    "length in a deck": (lambda s: ("solid", [("mesh: square.msh", "mesh: m.inp")], {"m.inp": DECK.replace("HERE", s)}), lambda folder: 1., None),
    "heading of a schedule": (lambda s: ("tank", [("end-time: 1 h, time-step: 10 min", "end-time: 21 h, time-step: 10 s, output: {interval: 0}" if "[h]" in s else "end-time: 0.4 h, time-step: 10 s"),
                                                  (PLANT, "      type: schedule\n      file: f.csv\n")], {"f.csv": SCHEDULE.replace("HERE", s)}), second_flow, None),
}


def used(binaries, base, edits, files, measure):
    """Exit code, what was said, and the value that the run used."""
    with tempfile.TemporaryDirectory(prefix="couplet-spellings-") as folder:
        folder = pathlib.Path(folder)
        mistake = table.Mistake("spelling", base, table.RIGHT, edits, files=files)
        run.prepare(folder, mistake)
        code, said = run.call(binaries, folder, mistake, ["-q"])
        return code, said, measure(folder) if code in (0, 4) else None


def main():
    binaries, chosen = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2:]
    per_pascal, bad, counts = used(binaries, *pulled("1 MPa"), of_probe)[2] / 1e6, 0, {"converted": 0, "refused": 0}
    spellings = yaml.safe_load((run.HERE / "spellings.yaml").read_text(encoding="utf-8"))
    for place, wanted in spellings.items():
        make, measure, result = PLACES[place]
        for spelling, right in wanted.items() if not chosen or place in chosen else ():
            code, said, value = used(binaries, *make(str(spelling)), measure)
            value = None if value is None else value / per_pascal if measure is of_probe else value
            if right == "refused":
                good = code == 2 and "case.yaml" in said or code == 2 and ".csv" in said or code == 2 and ".inp" in said
            else:
                right = float(right)
                good = value is not None and abs(value - (result(right) if result else right)) <= 1e-6 * abs(result(right) if result else right)
            counts["refused" if right == "refused" else "converted"] += good
            bad += not good
            if not good:
                print(f"FAILED {place}: '{spelling}' is not {right}: exit code {code}, {value}", *said.splitlines()[-3:], sep="\n         ")
    print(f"{sum(counts.values())} of {sum(counts.values()) + bad} spellings: {counts['converted']} converted, {counts['refused']} refused")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
