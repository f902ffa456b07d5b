# SPDX-License-Identifier: Apache-2.0
"""Shows what a run ended with: all results, the estimated error and its parts, warnings, distance to the limits of
stability, and costs."""
import math
import pathlib
import textwrap

from couplet.runs.case import expect
from couplet.runs.job import RUN_HELP, run_folder
from couplet.runs.results import Results

MOST_ROWS = 14  # of a run that ends on a terminal of 24 lines


def declare(parser):
    parser.add_argument("folder", type=pathlib.Path, metavar="RUN", help=RUN_HELP)


def row(result, width):
    """One result in at most 80 columns, as the programs print it."""
    numbers = [math.nan if v is None else v for v in result["values"]]
    line = (
        f"  {result['name']:{width}} "
        f" {'  '.join(f'{v:.5g}' for v in numbers)}{'' if result['unit'] in ('', '1', '-') else ' ' + result['unit']}"
    )
    error = result["error"]
    more = (
        ""
        if error is None
        else (
            f" +- {error * abs(numbers[0]):.2g} ({100 * error:.2g} %)"
            if len(numbers) == 1
            else f" +- {100 * error:.2g} %"
        )
    )
    more += f" {result['place']}" if result["place"] else ""
    return line + (more if len(line) + len(more) < 80 else f"\n     {more}")


def rows(results, names, most=10**9):
    """Lines of the results of these participants, at most `most` in all."""
    told = {name: report["results"] for name in names if (report := results.report(name)).get("results")}
    lines = []
    for name, found in told.items():
        here = max(1, most // len(told))
        lines.append(f"Results of '{name}' at t = {results.report(name).get('time', 0):g} s")
        width = max(min(len(r["name"]), 34) for r in found[:here])
        lines += [row(r, width) for r in found[:here]] + (
            [f"  and {len(found) - here} more: couplet report"] if len(found) > here else []
        )
    return lines


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
    lines = [f"Verdict: {word}; {judge.get('error', 'the error is not estimated')}"]
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
