# SPDX-License-Identifier: Apache-2.0
"""Runs every size of a ladder with every series of a case: what --for-error is judged against.
Usage: ladders.py FILE.yaml QUANTITY --sizes 4,6,8 [--series WORD] --build FOLDER --out FOLDER, writes FILE.csv beside it."""
import argparse
import csv
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
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
