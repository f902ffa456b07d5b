#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""docs/benchmarks.md: the coupled benchmarks beside the figures of others, from the committed tables: ours from docs/validation, theirs from
the reference of FSI1 to FSI3 and from OTHER. Usage: page.py [--check] (without: writes the page)."""
import csv
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[4]
sys.path[:0] = [str(ROOT / "scripts")]
from validation import table  # noqa: E402

PAGE = ROOT / "docs" / "benchmarks.md"
NUMBER = r"[-+]?[\d.]+(e[-+]?\d+)?"
HEAD = """# Coupled benchmarks beside others

Written by `scripts/validation/parts/benchmarks/page.py` from the committed tables: ours from [validation](validation/coupled-benchmarks.md)
(`scripts/validate coupled-benchmarks` repeats them), those of others on FSI1 to FSI3 from the reference
data of the case, each with its source, in the other tables as the publications named there give them. A test
compares this page with the tables.

Core-hours of ours are processor time of all programs on a shared machine with two cores (AMD EPYC), good to a third. Others publish
few: solids4foam gives hours and ranks of FSI3 and seconds of the tube; the preCICE tutorials have "a few hours" for FSI3. No published time of
ExaDG or deal.II for one of these cases was found, nor of CalculiX coupled by preCICE. "-": not published, or not measured.
"""
PEERS = {  # source: (name, fluid and solid cells, step, core-hours); the figures stand in configs/turek-hron/reference
    "S4F_1x": ("solids4foam, IQN-ILS", "5.3 k, 0.6 k", "1 ms", "-"), "S4F_2x": ("solids4foam, IQN-ILS", "21.3 k, 2.5 k", "0.5 ms", "44"),
    "S4F_4x": ("solids4foam, IQN-ILS", "85.4 k, 10 k", "0.25 ms", "-"), "preCICE": ("preCICE: OpenFOAM, deal.II (tutorial)", "21 k", "1 ms", "-"),
    "Tukovic18": ("Tuković and others 2018 (foam-extend)", "-", "-", "-"), "TH06": ("Turek and Hron 2006", "-", "-", "-"),
    "FF_2": ("Featflow, level 2", "-", "0.25 ms", "-"), "FF_3": ("Featflow, level 3", "-", "0.25 ms", "-"), "FF": ("Featflow, finest: the reference", "-", "0.25 ms", "-")}
OURS = {  # case: [(name, cells, step, beginning of our rows)]
    "FSI1": [("Couplet", "20.8 k, 2.5 k", "20 ms", "FSI1, about 21 k fluid and 2.5 k solid cells"), ("Couplet", "4.8 k, 0.6 k", "20 ms", "FSI1, 4.8 k fluid cells")],
    "FSI2": [("Couplet", "4.8 k, 0.6 k", "4 ms", "FSI2, 4.8 k fluid cells, dt 4 ms")],
    "FSI3": [("Couplet", "20.8 k, 2.5 k", "0.5 ms", "FSI3, about 21 k fluid and 2.5 k solid cells"), ("Couplet", "4.8 k, 0.6 k", "2 ms", "FSI3, coarse, ten minutes")]}
SHOWN = {  # quantity: (head, factor, digits)
    "FSI1": {"ux_mean": ("u_x [1e-5 m]", 1e5, 4), "uy_mean": ("u_y [1e-4 m]", 1e4, 4), "drag_mean": ("drag [N]", 1, 5), "lift_mean": ("lift [N]", 1, 4)},
    "FSI3": {"uy_amp": ("u_y, amplitude [mm]", 1e3, 4), "uy_f": ("frequency [Hz]", 1, 3), "drag_mean": ("drag, mean [N]", 1, 4), "lift_amp": ("lift, amplitude [N]", 1, 4)}}
SHOWN["FSI2"] = SHOWN["FSI3"]
OTHER = {  # title: (what is compared, [(who, how, figure, core-hours)]); a figure that begins with 'row:' is that of our row
    "Elastic tube in three dimensions": ("largest radial motion of A [m]", [
        ("Couplet, 16 000 and 6400 cells that match, second order", "0.1 ms", "row:tube, 16 000 and 6400 cells", "cost"),
        ("Couplet, faces 3:2", "0.1 ms", "row:tube, a wall of 3:2 faces", "cost"),
        ("solids4foam, Dirichlet-Neumann, Euler", "0.1 ms", "1.192e-04 at 7.00 ms", "-"),
        ("solids4foam, Robin-Neumann, Euler", "0.00625 ms", "1.510e-04 at 7.30 ms", "-"),
        ("solids4foam, weakly compressible, BDF2, Aitken", "0.1 ms", "1.540e-04", "-"),
        ("solids4foam, weakly compressible, BDF2, Aitken", "0.05 ms", "1.573e-04 at 7.30 ms", "0.46"),
        ("its limit of the step to zero", "", "1.585e-04", "")]),
    "Perpendicular flap": ("first and second maximum of the tip [m]", [
        ("Couplet", "10 ms", "flagship:flap: first tip maximum; flap: second tip maximum", "-"),
        ("preCICE: OpenFOAM, CalculiX (tutorial, read from its picture, 0.002 m)", "10 ms", "0.198 at 0.74 s; 0.184 at 2.36 s", "-"),
        ("preCICE: OpenFOAM, FEniCS", "10 ms", "0.199; 0.186", "-"), ("preCICE: Nutils, deal.II", "10 ms", "0.195; 0.183", "-")]),
    "Mok's cavity with an outlet strip": ("least and largest height of the middle over a period [m]", [
        ("Couplet, 32 x 32 cells", "0.1 s", "row:Mok's cavity with an outlet strip: least height; Mok's cavity with an outlet strip: largest height", "cost"),
        ("Kratos (examples, read from their picture, 0.003 m)", "0.1 s", "0.203; 0.262", "-"), ("Valdés 2007 (as in the examples of Kratos)", "0.1 s", "0.197; 0.268", "-"),
        ("Mok 2001 (as there)", "0.1 s", "0.143; 0.214", "-")]),
    "Vibration of a cylinder by vortices, Re 150, U/(f_n D) = 4": ("amplitude over D", [
        ("Couplet, 6000 cells", "50 ms", "row:vibration by vortices, U/(f_n D) = 4: amplitude", "cost"), ("Ahn and Kallinderis 2006", "-", "0.55", "-")])}


def published(case):
    with open(ROOT / "configs/turek-hron/reference/turek_hron.csv", newline="") as file:
        return {r["source"]: r for r in csv.DictReader(line for line in file if not line.startswith("#")) if r["case"] == case}


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
    shown, theirs, found = SHOWN[case], published(case), []

    def number(text, name):
        _, factor, digits = shown[name]
        return f"{factor * float(text):.{digits}g}" if re.fullmatch(NUMBER, text) else "-"  # a row may tell why there is none
    for who, cells, step, beginning in OURS[case]:
        mine = {q.rsplit(": ", 1)[1]: r.got for q, r in rows.items() if q.startswith(beginning) and ": " in q and r.verdict != "not measured"}
        values = [number(mine[name].split(" ")[0], name) if name in mine else "-" for name in shown]
        found.append((f"**{who}**", cells, step, *values, next((hours(text) for text in mine.values()), "-")))
    for source, (who, cells, step, cost) in PEERS.items():
        if source in theirs:
            found.append((who, cells, step if case == "FSI3" else "-", *(number(theirs[source][name], name) for name in shown), cost if case == "FSI3" else "-"))
    values = [[float(number(r[name], name)) for r in theirs.values() if r[name]] for name in shown]
    found.append(("spread of the published", "", "", *map(spread, values), ""))
    return [f"## {case} of Turek and Hron", "", *lines(("", "fluid, solid cells", "step", *(head for head, _, _ in shown.values()), "core-hours"), found)]


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
    rows, flagship = (table.read(ROOT / "docs/validation" / f"{name}.md") for name in ("coupled-benchmarks", "flagship"))
    found = [HEAD, *(line for case in ("FSI1", "FSI2", "FSI3") for line in flag(case, rows))]
    for title, (what, entries) in OTHER.items():
        body = []
        for who, step, given, cost in entries:
            value, measured = figure(given, rows, flagship)
            body.append((f"**{who}**" if measured else who, step, value, measured if cost == "cost" else cost))
        found += [f"## {title}", "", *lines(("", "step", what, "core-hours"), body)]
    return "\n".join(found)


def write():
    PAGE.write_text(text())


if __name__ == "__main__":
    if "--check" in sys.argv and PAGE.read_text() != text():
        sys.exit(f"{PAGE}: differs from the tables that it is made of. Write it again: scripts/validation/parts/benchmarks/page.py")
    if "--check" not in sys.argv:
        write()
