# SPDX-License-Identifier: Apache-2.0
"""Predictions of --for-error beside ladders of runs."""
import argparse
import csv
import json
import math
import pathlib
import sys

import numpy as np


# -- rows -------------------------------------------------------------------------------------------------------------
HERE = pathlib.Path(__file__).resolve().parent


def ladder(name):
    return [(r["series"], float(r["size"]), float(r["value"]), float(r["seconds"])) for r in read(HERE / f"{name}.csv") if r["value"]]


def truth_of(given, rows):
    """A number, or the series whose finest run of the ladder is the truth, or whose finest runs' fit is its limit."""
    if not isinstance(given, tuple):
        return given
    from couplet.study import fits
    how, series = given
    own = sorted((n, v) for s, n, v, _ in rows if s == series)
    if how == "finest":
        return own[-1][1]
    return fits.of_values(*zip(*own[-5:]))[0].limit


def wrong(value, truth):
    return abs(value - truth) / (abs(truth) or 1)


def cost_of(rows, series, size):
    """Seconds of the ladder at this size, by powers between its sizes; None outside of it."""
    own = sorted((n, t) for s, n, _, t in rows if s == series)
    if not own or not own[0][0] <= size <= own[-1][0]:
        return None
    return math.exp(np.interp(math.log(size), *np.log(np.array(own)).T))


def asked(job, name, quantity, target):
    out = job.scratch / f"prediction-{name}"
    done = job.run([sys.executable, job.root / "scripts/couplet", "study", HERE / f"{name}.yaml", f"--build={job.build}", f"--out={out}", f"--for-error={target}"], timeout=3600)
    file = out / f"for-error-{quantity.replace(' ', '-')}-{target.replace('%', 'pc')}.json"
    if not file.exists():
        raise RuntimeError((done.stderr or done.stdout)[-300:])
    return json.loads(file.read_text())


def judged(rows, truth, r):
    """Returns the text of a case, and true if all its four bars are met."""
    if "error" not in r:
        return "none found", False
    error, cheapest = wrong(r["value"], truth), min((t for _, _, v, t in rows if wrong(v, truth) <= r["target"]), default=math.inf)
    price = (cost_of(rows, r["series"], r["size"]) or r["seconds"]) / cheapest
    share, time, before = error / r["target"], r["seconds"] / r["predicted seconds"], r["before"] / r["seconds"]
    text = (f"{r['series']} {r['size']:g}: true error {share:.2f} of it, reported {r['error'] / r['target']:.2f}; {price:.2f} times the cheapest; "
            f"time {time:.2f} of the predicted; before it {before:.1f} times {r['seconds']:.2g} s")
    return text, 0.3 <= share <= 1.1 and price <= 1.5 and 0.7 <= time <= 1.3 and (before <= 3 or r["seconds"] <= 1)


def predicted(job, name, quantity, targets, truth):
    """`name`: a file beside this one."""
    rows, parts = ladder(name), []
    right = truth_of(truth, rows)
    for target in targets:
        text, met = judged(rows, right, asked(job, name, quantity, target))
        parts.append((f"{target}: {text}" + ("" if met else " (not met)"), met))
    return "; ".join(p for p, _ in parts), all(met for _, met in parts)


# -- ladders ----------------------------------------------------------------------------------------------------------
sys.path.insert(0, str(HERE.parents[3] / "client/python"))
from couplet.runs import Case  # noqa: E402
from couplet.study.study import Study  # noqa: E402

HEAD = ("series", "size", "value", "seconds", "reason")


def read(file):
    with open(file, newline="") as source:
        return list(csv.DictReader(source))


def climb(study, quantity, sizes, word, say):
    """A row per size and series."""
    refining, rows = study.axes.refining, []
    labels = {tuple((k, v) for k, v in p.labels.items() if k != refining.name) for p in study.axes.points()}
    for fixed in sorted(labels):
        name = ", ".join(v for _, v in fixed) or "the case"
        for size in sizes if word in name else ():
            row, = study.run([study.axes.point({**dict(fixed), refining.name: f"{size:g}"}, size)], 1, False, say)
            rows.append({"series": name, "size": f"{size:g}", "value": f"{row.values[quantity]:.10g}" if row.good else "",
                         "seconds": f"{getattr(row.record, study.clock):.4g}" if row.good else "", "reason": row.reason})
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=pathlib.Path)
    parser.add_argument("quantity")
    parser.add_argument("--sizes", required=True)
    parser.add_argument("--series", default="")
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    study = Study(Case(arguments.file, arguments.build), arguments.out)
    rows = climb(study, arguments.quantity, [float(n) for n in arguments.sizes.split(",")], arguments.series, lambda line: print(line, flush=True))
    target = arguments.file.with_suffix(".csv")
    kept = {(r["series"], r["size"]): r for r in (read(target) if target.exists() else [])} | {(r["series"], r["size"]): r for r in rows}
    with open(target, "w", newline="") as out:
        writer = csv.DictWriter(out, HEAD, lineterminator="\n")
        writer.writeheader()
        writer.writerows(sorted(kept.values(), key=lambda r: (r["series"], float(r["size"]))))


if __name__ == "__main__":
    main()
