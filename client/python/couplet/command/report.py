# SPDX-License-Identifier: Apache-2.0
"""Shows the outcome of a run: all results (probes and coefficients, then forces, then the rest), the estimated error
and its parts, warnings, the distance to stability limits, and costs."""
import pathlib
import re
import textwrap

from couplet.runs.case import expect
from couplet.runs.job import RUN_HELP, run_folder
from couplet.runs.results import Results

MOST_LINES = 14  # of the results at the end of a run, on a terminal of 24 lines
USUAL_VERDICT = 3  # lines of a verdict for which there is room beside them


def declare(parser):
    parser.add_argument("folder", type=pathlib.Path, metavar="RUN", help=RUN_HELP)


def rows(results, names, most=10**9):
    """Lines of the results of these participants, the most important first, at most `most` in all."""
    found = {name: rows for name in names if (rows := results.report(name).get("results"))}
    names = sorted(found, key=lambda name: min(r["rank"] for r in found[name]))
    blocks, left, hidden = {}, most - 1, 0
    for name, result in sorted(((n, r) for n in names for r in found[n]), key=lambda item: item[1]["rank"]):
        left -= 1 + (name not in blocks)
        if left < 0:
            hidden += 1
        else:
            width = max(min(len(r["name"]), 34) for r in found[name])
            blocks.setdefault(name, []).append(f"  {result['name']:{width}}  {result['text']}")
    lines = []
    for name in (n for n in names if n in blocks):
        lines += [f"Results of '{name}' at t = {results.report(name).get('time', 0):g} s", *blocks[name]]
    return lines + ([f"and {hidden} more: couplet report"] if hidden else [])


def ending(results, names):
    """Last lines of a run: its main results and the verdict."""
    last = verdict(results, names)
    return [*rows(results, names, MOST_LINES - max(0, len(last) - USUAL_VERDICT)), *last]


def error_of(results, names, judge):
    """Returns a sentence about the estimated error, and the participant with the largest one. In a coupled run the
    sentence has the field of each participant, the largest error first, without those below a tenth of it."""
    found = []
    for name in (n for n in names if "coupler" in names and n != "coupler"):
        report = results.report(name)
        said = re.match(r"estimated error: (.*?) ?((?:unknown|above|[\d.]).*)", report.get("error", ""))
        if said:
            parts = [report.get("errors", {}).get(kind) for kind in ("mesh", "step", "linear")]
            total = sum(part for part in parts if part)
            found.append((total, "unknown" in said[2], f"{said[1] or 'result'} of '{name}' {said[2]}", name))
    found = [f for f in found if f[1] or f[0] >= 0.1 * max(f[0] for f in found)]
    error = judge.get("error", "the error is not estimated")
    if not found or "(coupling tolerance)" in error:
        return error, ""
    found.sort(key=lambda f: -f[0])
    largest = "" if any(f[1] for f in found) else found[0][-1]  # an unknown part is looked for first
    return "estimated error: " + "; ".join(f[2] for f in found), largest


def verdict(results, names):
    """Returns a few lines: the errors, the warnings that were not accepted, and the best next change."""
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
    error, largest = error_of(results, names, judge)
    lines = textwrap.wrap(f"Verdict: {word}; {error}", 78, subsequent_indent="  ")
    if ids:
        shown = textwrap.shorten(', '.join(ids), 56, placeholder=' and more', break_on_hyphens=False)
        lines += [f"  {shown} (docs/findings.md)"]
    cures = (f["advice"] for f in found if f["severity"] == "wrong" and f["id"] != "error-estimate" and f["advice"])
    following = next(cures, "")
    whose = f" for '{largest}'" if largest and not following else ""
    following = following or (results.report(largest) if largest else judge).get("next", "")
    following = following.rpartition(" (with")[0] if len(following) > 70 else following
    return lines + ([f"  next{whose}: {following}"] if 0 < len(following) <= 70 else [])


def costs(results, names):
    yield "             steps  iterations     busy [s]  memory [MB]"
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
                f"  {place['quantity']} {place['value']:.3g}, limit {place['limit']:.3g} (docs/stability.md,"
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
