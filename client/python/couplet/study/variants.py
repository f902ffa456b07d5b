# SPDX-License-Identifier: Apache-2.0
"""A study by named variants and sweeps, whose summaries become one table with a column each.

participant: tank                     # whose summary.csv is collected; keys start at it unless they start with a
                                      section
variants: {B: {}, CO1: {flow.cut-off: 25 K}}
sweeps: {diameter: {key: diameter, values: [38 m, 41.8 m]}}   # variants diameter-38m, diameter-41.8m"""
import csv
import re

from couplet import files
from couplet.runs import Task, expect


def variants_of(case):
    """Returns (participant, {name: {full key: value}})."""
    study = case.study
    unknown = set(study) - {"participant", "variants", "sweeps", "optimise"}
    expect(
        not unknown,
        (
            f"{case.file}: study: unknown key '{next(iter(unknown), '')}'; valid keys are participant, variants and"
            " sweeps, or those of a study by axes."
        ),
    )
    participant = study.get("participant", next(iter(case.participants), None))
    expect(
        participant in case.participants, f"{case.file}: study.participant: there is no participant '{participant}'."
    )
    found = {}
    for name, changes in (study.get("variants") or {}).items():
        expect(
            changes is None or isinstance(changes, dict),
            f"{case.file}: study.variants.{name}: expected a mapping of keys.",
        )
        found[str(name)] = {case.absolute(k, participant): v for k, v in (changes or {}).items()}
    for name, sweep in (study.get("sweeps") or {}).items():
        expect(
            isinstance(sweep, dict) and set(sweep) == {"key", "values"} and isinstance(sweep["values"], list),
            f"{case.file}: study.sweeps.{name}: expected {{key: ..., values: [...]}}.",
        )
        for value in sweep["values"]:
            found[f"{name}-{re.sub(r'[^A-Za-z0-9.+-]', '', str(value))}"] = {
                case.absolute(sweep["key"], participant): value
            }
    expect(found, f"{case.file}: study: there are no variants and no sweeps.")
    return participant, found


class Variant(Task):
    """Run of one participant alone for its summary.csv."""

    def make(self):
        record = super().make()
        if record.state == "done" and not (self.folder / self.alone / "summary.csv").exists():
            record.state, record.reason = (
                "failed",
                f"there is no summary.csv: has participant '{self.alone}' a section 'report'?",
            )
            self.write(record)
        return record

    def summary(self):
        with open(self.folder / self.alone / "summary.csv", newline="") as file:
            return {(row["quantity"], row["unit"]): float(row["value"]) for row in csv.DictReader(file)}


def write_table(file, variants):
    """Writes one row per quantity and one column per variant."""
    columns = {variant.name: variant.summary() for variant in variants}
    rows = list(dict.fromkeys(key for column in columns.values() for key in column))
    files.write_rows(
        file.parent,
        file.name,
        [
            ["quantity", "unit", *columns],
            *([*row, *(f"{c[row]:.6g}" if row in c else "" for c in columns.values())] for row in rows),
        ],
    )
    width = max(len(f"{q} [{u}]") for q, u in rows)
    print("\n" + " " * width + "".join(f"{name[:12]:>13}" for name in columns))
    for row in rows:
        print(
            f"{f'{row[0]} [{row[1]}]':{width}}"
            + "".join(f"{c[row]:>13.5g}" if row in c else " " * 13 for c in columns.values())
        )
    print(f"table: {file}")
