#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""docs/benchmarks.md: the coupled benchmarks beside the figures of others, from the committed tables: ours from
docs/validation, theirs from the reference of FSI1 to FSI3 and from page.yaml. Usage: page.py [--check] (without: writes
the page). --check also compares the numbers that README and docs/limitations.md quote with the tables."""
import csv
import pathlib
import re
import sys

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[4]
sys.path[:0] = [str(ROOT / "scripts")]
from validation import table  # noqa: E402

PAGE = ROOT / "docs" / "benchmarks.md"
NUMBER = r"[-+]?[\d.]+(e[-+]?\d+)?"
DATA = yaml.safe_load(pathlib.Path(__file__).with_name("page.yaml").read_text())


def published(case):
    with open(ROOT / "configs/turek-hron/reference/turek_hron.csv", newline="") as file:
        return {
            r["source"]: r
            for r in csv.DictReader(line for line in file if not line.startswith("#"))
            if r["case"] == case
        }


def hours(text):
    """Core-hours of a row that names its processor minutes."""
    minutes = re.search(r"([\d.]+) processor minutes", text)
    return f"{float(minutes[1]) / 60:.3f}" if minutes else "-"


def lines(head, rows):
    return [f"| {' | '.join(head)} |", "|" + "---|" * len(head), *(f"| {' | '.join(row)} |" for row in rows), ""]


def spread(values):
    return f"{min(values):g} to {max(values):g}" if len(values) > 1 else "-"


def flag(case, rows):
    """Turek and Hron's case: ours, the others', the spread of what is published."""
    shown, theirs, found = DATA["shown"][case], published(case), []

    def number(text, name):
        _, factor, digits = shown[name]
        return (
            f"{factor * float(text):.{digits}g}" if re.fullmatch(NUMBER, text) else "-"
        )  # a row may tell why there is none

    mine = {
        q.rsplit(": ", 1)[1]: r.got
        for q, r in rows.items()
        if q.startswith(f"{case}, ") and r.verdict != "not measured"
    }
    values = {name: text.split(" for ")[0].split(", ") for name, text in mine.items()}
    minutes = re.search(r"\(([\d., ]+) processor minutes", next(iter(mine.values()), ""))
    for i, (cells, step) in enumerate(zip(DATA["meshes"], DATA["steps"][case])):
        cost = f"{float(minutes[1].split(', ')[i]) / 60:.3f}" if minutes else "-"
        found.append(
            (
                "**Couplet**",
                cells,
                step,
                *(number(values[name][i], name) if name in values else "-" for name in shown),
                cost,
            )
        )
    for source, (who, cells, step, cost) in DATA["peers"].items():
        if source in theirs:
            found.append(
                (
                    who,
                    cells,
                    step if case == "FSI3" else "-",
                    *(number(theirs[source][name], name) for name in shown),
                    cost if case == "FSI3" else "-",
                )
            )
    values = [[float(number(r[name], name)) for r in theirs.values() if r[name]] for name in shown]
    found.append(("range of the published values", "", "", *map(spread, values), ""))
    return [
        f"## {case} of Turek and Hron",
        "",
        *lines(("", "fluid, solid cells", "step", *(head for head, _, _ in shown.values()), "core-hours"), found),
    ]


def figure(text, rows, flagship):
    """Returns (figure, core-hours) as given, or those of our rows."""
    where, _, names = text.partition(":")
    if where not in ("row", "flagship"):
        return text, None
    source = rows if where == "row" else flagship
    chosen = [next(r for q, r in source.items() if q.startswith(name)) for name in names.split("; ")]
    got = [re.sub(r" \([\d.]+ processor minutes[^)]*\)", "", r.got) for r in chosen]
    return "; ".join(got), hours(" ".join(r.got for r in chosen))


def text():
    files = [
        ROOT / "docs/validation" / f"{name}.md" for name in ("fluid", "finite-strain", "coupled-benchmarks", "flagship")
    ]
    fluid, solid, coupled, flagship = map(table.read, files)
    rows = {**fluid, **solid, **coupled}
    ages = [f"- [{f.stem}](validation/{f.name}): {re.search(r'[*]{2}(.*)[*]{2}', f.read_text())[1]}" for f in files]
    found = [
        DATA["head"],
        "Age of our rows:",
        "",
        *ages,
        "",
        *(line for case in ("FSI1", "FSI2", "FSI3") for line in flag(case, rows)),
    ]
    for title, other in DATA["others"].items():
        body = []
        for who, step, given, cost in other["rows"]:
            value, measured = figure(given, rows, flagship)
            body.append((f"**{who}**" if measured else who, step, value, measured if cost == "cost" else cost))
        found += [f"## {title}", "", *lines(("", "step", other["what"], "core-hours"), body)]
    return "\n".join(found)


def misquoted():
    """Yields what page.yaml's quotes say and no page or table does."""
    for page, words, name, beginning in DATA["quotes"]:
        said, file = words.replace("`", ""), ROOT / "docs/validation" / f"{name}.md"
        rows = (
            [r.got for q, r in table.read(file).items() if q.startswith(beginning)]
            if beginning
            else [file.read_text().partition("\n| quantity")[0]]
        )
        if said not in " ".join((ROOT / page).read_text().split()):
            yield f"{page} does not say '{said}'"
        if len(rows) != 1:
            yield f"{page}: '{said}': {file.name} has {len(rows)} rows '{beginning}'"
        there = [abs(float(n)) for n in re.findall(r"-?\d+(?:\.\d+)?", " ".join(rows))]
        for number in re.findall(r"`([\d.]+)`", words):
            if float(number) not in [round(n, len(number.partition(".")[2])) for n in there]:
                yield f"{page}: '{said}': {number} is not in {file.name}, {beginning or 'the note'}"


def write():
    PAGE.write_text(text())


if __name__ == "__main__":
    if "--check" in sys.argv and PAGE.read_text() != text():
        sys.exit(
            f"{PAGE}: differs from the tables that it is made of. Write it again:"
            " scripts/validation/parts/benchmarks/page.py"
        )
    if "--check" in sys.argv and (wrong := list(misquoted())):
        sys.exit("\n".join(wrong))
    if "--check" not in sys.argv:
        write()
