# SPDX-License-Identifier: Apache-2.0
"""Shows what a run ended with: all results (probes and coefficients, then forces, then the rest), the estimated error
and its parts, warnings, distance to the limits of stability, and costs."""
import csv
import math
import pathlib
import re
import textwrap

from couplet.runs.case import expect
from couplet.runs.job import RUN_HELP, run_folder
from couplet.runs.results import Results

MOST_LINES = 14  # of the results at the end of a run, on a terminal of 24 lines
OWN = ("probes", "coefficients")  # tables that the case asks for
TABLES = ("reactions", "forces", "bodies", "flow-areas", "heat", "contact", "gaps", "amounts", "energies", "tank")
NOISE = 1e-9  # share of the largest value of a row or a unit below which a value is printed as 0
# (prefix, factor, smallest value without prefix); five digits make kilo superfluous below 10 000
PREFIXES = (
    ("G", 1e9, 1e9),
    ("M", 1e6, 1e6),
    ("k", 1e3, 1e4),
    ("", 1, 0.1),
    ("m", 1e-3, 1e-4),
    ("u", 1e-6, 1e-7),
    ("n", 1e-9, 1e-10),
)
SCALED = ("Pa", "N", "J", "W", "Hz", "m")  # units with prefixes; lengths have none above m


def declare(parser):
    parser.add_argument("folder", type=pathlib.Path, metavar="RUN", help=RUN_HELP)


def digits(value, number):
    """Value with at most so many significant digits."""
    return f"{float(f'{value:.{number}g}'):.{max(number, 6)}g}"


def percent(share):
    return "useless" if share >= 0.995 else f"{digits(100 * share, 2)} %"


def prefix_of(largest, unit):
    """Prefix of a unit for this absolute value, and its factor."""
    allowed = [p for p in PREFIXES if unit in SCALED and (unit != "m" or p[1] <= 1)]
    return next(((name, factor) for name, factor, least in allowed if largest >= least), ("", 1))


def largest_of(values):
    return max((abs(v) for v in values if v is not None and math.isfinite(v)), default=0.0)


def largest_by_unit(found):
    """Largest absolute value of each unit. Numbers without a unit are not compared with each other."""
    most = {}
    for result in found:
        unit = result["unit"]
        if unit not in ("", "1", "-"):
            most[unit] = max(most.get(unit, 0.0), largest_of(result["values"]))
    return most


def row(result, width, most):
    """One result in at most 80 columns. `most` is largest_by_unit() of its participant."""
    unit, largest = result["unit"], largest_of(result["values"])
    noise = NOISE * max(largest, most.get(unit, 0.0))
    numbers = [math.nan if v is None else 0.0 if abs(v) <= noise else v for v in result["values"]]
    prefix, factor = prefix_of(largest_of(numbers), unit)
    line = f"  {result['name']:{width}}  {'  '.join(digits(v / factor, 5) for v in numbers)}"
    line += "" if unit in ("", "1", "-") else f" {prefix}{unit}"
    error, more = result["error"], ""
    if error is not None:
        own = digits(error * abs(numbers[0]) / factor, 2)
        more = f" +- {own} ({percent(error)})" if len(numbers) == 1 else f" +- {percent(error)}"
    more += f" {result['place']}" if result["place"] else ""
    return line + (more if len(line) + len(more) < 80 else f"\n     {more}")


def names_in(file):
    """Names of the columns of a table without their units and components, as in its results."""
    if not file.is_file():
        return set()
    with open(file, newline="") as lines:
        heads = [head.strip().rpartition(" [")[0] or head.strip() for head in next(csv.reader(lines), [])]
    return {*heads, *(head[:-2] for head in heads if head[-2:] in (" x", " y", " z"))}


def by_importance(results, name):
    """Returns [(rank, result)] of a participant. The rank is 0 for a table that the case asks for, 1 for forces and the
    like and for values with an estimated error, and 2 for the rest."""
    own, others = (
        {n for table in tables for n in names_in(results.folder / name / f"{table}.csv")} for tables in (OWN, TABLES)
    )

    def rank(result):
        if result["name"] in own:
            return 0
        return 1 if result["error"] is not None or any(f" {result['name']}".endswith(f" {n}") for n in others) else 2

    return sorted(((rank(r), r) for r in results.report(name).get("results", ())), key=lambda item: item[0])


def rows(results, names, most=10**9):
    """Lines of the results of these participants, the most important first, at most `most` in all."""
    ranked = {name: found for name in names if (found := by_importance(results, name))}
    names = sorted(ranked, key=lambda name: ranked[name][0][0])
    blocks, left, hidden = {}, most - 1, 0
    for _, name, result in sorted(((r, n, x) for n in names for r, x in ranked[n]), key=lambda item: item[0]):
        found = [x for _, x in ranked[name]]
        line = row(result, max(min(len(r["name"]), 34) for r in found), largest_by_unit(found))
        left -= line.count("\n") + 1 + (name not in blocks)
        if left < 0:
            hidden += 1
        else:
            blocks.setdefault(name, []).append(line)
    lines = []
    for name in (n for n in names if n in blocks):
        lines += [f"Results of '{name}' at t = {results.report(name).get('time', 0):g} s", *blocks[name]]
    return lines + ([f"and {hidden} more: couplet report"] if hidden else [])


def ending(results, names):
    """Last lines of a run: its main results and the verdict."""
    return [*rows(results, names, MOST_LINES), *verdict(results, names)]


def verdict(results, names):
    """Returns at most three lines: the error, the warnings that were not accepted, and the best next change."""
    judge = results.report("coupler" if "coupler" in names else names[0]) if names else {}
    found = [
        f for f in results.findings() if f["participant"] in names and f["severity"] != "note" and not f.get("accepted")
    ]
    ids = list(dict.fromkeys(f["id"] for f in found))
    word = (
        "useless"
        if any(f["severity"] == "wrong" for f in found)
        else f"{len(ids)} warning{'s' if len(ids) > 1 else ''}" if ids else "no warning"
    )
    error = re.sub(
        r"(?<![\d.])([\d.]+e\+\d+|\d{3,}) %", "over 100 % (useless)", judge.get("error", "the error is not estimated")
    )
    lines = [f"Verdict: {word}; {error}"]
    if ids:
        shown = textwrap.shorten(', '.join(ids), 56, placeholder=' and more', break_on_hyphens=False)
        lines += [f"  {shown} (docs/findings.md)"]
    following = judge.get("next", "")
    following = following.rpartition(", for")[0] if len(following) > 70 else following
    return lines + ([f"  next: {following}"] if 0 < len(following) <= 70 else [])


def costs(results, names):
    yield "             steps  iterations  at work [s]  memory [MB]"
    for name in names:
        report = results.report(name)
        working = report.get("processor-working") or report.get("processor", 0)
        yield (
            f"{name:12} {report.get('steps', 0):5}  {report.get('iterations', 0):10}  {working:11.1f} "
            f" {report.get('memory-all', 0):11.0f}"
        )
    for name in names:
        phases = sorted(results.report(name).get("phases", {}).items(), key=lambda item: -item[1])
        yield f"time of {name}: " + ", ".join(f"{phase} {seconds:.3g} s" for phase, seconds in phases)


def details(results, names):
    """Lines that a run does not end with."""
    for name in names:
        report = results.report(name)
        parts = {k: v for k, v in report.get("errors", {}).items() if isinstance(v, (int, float))}
        if parts:
            yield f"estimated error of {name}: " + ", ".join(
                f"{part} {value:.2g}" for part, value in sorted(parts.items(), key=lambda p: -p[1])
            )
        for key, words in (("model-by", "neglected"), ("could-be-omitted", "could be omitted")):
            if report.get("errors", {}).get(key):
                yield f"  {words}: {report['errors'][key]}"
        for place in report.get("atlas", []):
            yield (
                f"  {place['quantity']} {place['value']:.3g}, limit {place['limit']:.3g} (docs/stability.md, map"
                f" {place['map']})"
            )
    for finding in results.findings():
        yield f"{finding['participant']}: {finding['severity']}: {finding.get('sentence', '')} [{finding['id']}]"
    yield from costs(results, names)


def run(arguments):
    folder = run_folder(arguments.folder)
    expect(folder.is_dir(), f"{folder}: there is no such folder")
    results = Results(folder)
    names = [name for name in results.participants() if results.report(name)]
    expect(names, f"{folder}: no run has finished here")
    print(*rows(results, names), *verdict(results, names), *details(results, names), sep="\n")
    return 0
