# SPDX-License-Identifier: Apache-2.0
"""Lists the differences between two runs: effective values, findings, one line for each table or file of fields with
the largest difference and its location, and then the columns of tables and the fields. Their cost (seconds,
iterations, logs) is ignored. The exit code is 0 if everything else is equal bit for bit, or within --tolerance, and 1
otherwise."""
import argparse
import math
import pathlib
import re

from couplet.runs.case import Wrong, expect, load
from couplet.runs.job import RUN_HELP, run_folder
from couplet.runs.results import Results, read_csv

COST = re.compile(r"seconds|waiting|working|processor|clock|so far|iterations|residual")


def share(text):
    value = float(text)
    if not 0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"{text}: expected a number of at least 0")
    return value


def declare(parser):
    parser.add_argument("first", type=pathlib.Path, metavar="RUN", help=RUN_HELP)
    parser.add_argument("second", type=pathlib.Path, metavar="RUN", help="another run")
    parser.add_argument(
        "--tolerance",
        type=share,
        default=0.0,
        metavar="SHARE",
        help="ignores differences up to this fraction of the largest value (default: 0)",
    )
    parser.add_argument("--all", action="store_true", help="also lists values that are equal or within the tolerance")


def flat(node, name=""):
    if isinstance(node, dict):
        for key, child in node.items():
            yield from flat(child, f"{name}.{key}" if name else str(key))
    else:
        yield name, node


def apart(a, b, largest=0.0):
    """Difference of two arrays: (words, share, index of the largest difference, number of values that cannot be
    compared). The words are empty if there is no difference. The share is that of `largest`, or of the largest value
    here."""
    import numpy as np

    if a.shape != b.shape or a.dtype.kind != b.dtype.kind:
        return f"shape {a.shape} | {b.shape}", 0.0, None, max(a.size, b.size)
    if a.dtype.kind not in "fiu":
        unequal = int((a != b).sum())
        return (f"{unequal} of {a.size} values differ" if unequal else ""), 0.0, None, unequal
    if a.tobytes() == b.tobytes():
        return "", 0.0, None, 0
    a, b = a.astype(float), b.astype(float)
    missing = np.isnan(a) != np.isnan(b)
    both = np.isfinite(a) & np.isfinite(b)
    gap = np.where(both, np.abs(np.where(both, a, 0) - np.where(both, b, 0)), 0)
    infinite = ~both & ~missing & ~np.isnan(a) & (a != b)
    most, at = float(gap.max()), np.unravel_index(gap.argmax(), gap.shape)
    share = most / (max(largest, *(float(np.abs(v[both]).max(initial=0)) for v in (a, b))) or 1.0)
    words = [f"the values differ by at most {most:.3g}, which is {share:.2g} of the largest value"] if most else []
    for wrong, what in ((missing, "a gap in only one run"), (infinite, "infinite in one run")):
        words += [f"{what}: {wrong.sum()} of {a.size} values"] if wrong.any() else []
    return "; ".join(words), share, at, int(missing.sum() + infinite.sum())


def with_gaps(values):
    """Numbers of a column, with NaN for empty values. A column of texts is returned as it is."""
    import numpy as np

    try:
        return np.array([float(v or "nan") for v in values]) if values.dtype.kind == "U" else values
    except ValueError:
        return values


def arrays(folder):
    """Returns {name: array} of all tables and field series of a run, without times."""
    import h5py
    import numpy as np

    found = {}
    for file in sorted(folder.glob("*/*.csv")):
        if file.stat().st_size:
            for head, values in read_csv(file).items():
                if not COST.search(head):
                    found[f"{file.relative_to(folder)}: {head}"] = with_gaps(values)
    for file in sorted(folder.glob("*/*.h5")):
        if file.parent.name == "checkpoints":
            continue
        raw = {}
        try:
            with h5py.File(file, "r") as series:
                times = {
                    f"steps/{number}": f"t = {step.attrs['time']:.9g} s"
                    for number, step in series.get("steps", {}).items()
                    if "time" in step.attrs
                }
                if len(set(times.values())) < len(times):  # such as modes of equal frequency
                    times = {}
                series.visititems(
                    lambda name, item: (
                        raw.update({named(name, times): np.asarray(item[...])})
                        if isinstance(item, h5py.Dataset)
                        else None
                    )
                )
        except (OSError, RuntimeError) as error:
            raise Wrong(f"{file}: cannot be read, and may be truncated ({error})") from None
        found.update({f"{file.relative_to(folder)}: {name}": values for name, values in by_number(raw).items()})
    return found


def named(name, times):
    """Name of a dataset with the time of its output in place of the number, which differs between a whole run and a
    resumed one."""
    step = "/".join(name.split("/")[:2])
    return times[step] + name[len(step) :] if step in times else name


def by_number(series):
    """Datasets of one file in the order of cell and point numbers, since files store them rank by rank."""
    import numpy as np

    cells, points = series.get("mesh/cell-id"), series.get("mesh/point-id")
    if cells is None or points is None:
        return series
    order = {"cells": np.argsort(cells, kind="stable"), "points": np.argsort(points, kind="stable")}
    place = {"mesh/cell-id": "cells", "mesh/point-id": "points", "mesh/coordinates": "points"}
    sorted_ones = {}
    for name, values in series.items():
        of = place.get(name) or (
            "points" if name.endswith("/coordinates") else name.split("/")[-2] if name.count("/") > 1 else None
        )
        if name == "mesh/cells" and values.ndim == 2:
            values, of = points[values], "cells"
        sorted_ones[name] = values[order[of]] if of in order and len(values) == len(order[of]) else values
    return sorted_ones


def values_in_force(folder):
    return {
        f"{file.parent.name}.{key}": value
        for file in folder.glob("*/effective.yaml")
        for key, value in flat(load(file.read_text()))
    }


def of_mappings(first, second):
    return [
        f"{key}: {first.get(key, 'absent')} | {second.get(key, 'absent')}"
        for key in sorted({*first, *second})
        if first.get(key, 'absent') != second.get(key, 'absent')
    ]


def scales(*runs):
    """Returns {(table, unit): largest value}: a column that is zero up to round-off is compared with the others of its
    table and unit."""
    import numpy as np

    found = {}
    for name, values in (item for run in runs for item in run.items()):
        if group := group_of(name):
            finite = np.abs(values[np.isfinite(values)]) if values.dtype.kind == "f" else []
            found[group] = max(found.get(group, 0.0), float(max(finite, default=0.0)))
    return found


def group_of(name):
    """Table and unit of a column, or dataset of a component such as stress-zz; None for other values."""
    found = re.fullmatch(r"(.*\.csv): .*(\[.*\])", name) or re.fullmatch(r"(.*\.h5): (.*)-[xyz]{1,2}", name)
    return found.groups() if found else None


def differences(first, second, tolerance):
    """Returns [(name, words or "", True if beyond the tolerance, share, place of the largest difference)] of all
    arrays."""
    a, b = arrays(first), arrays(second)
    largest, times = scales(a, b), {}
    for name in [*a, *(n for n in b if n not in a)]:
        if name not in a or name not in b:
            yield name, f"only in {first if name in a else second}", True, 0.0, ""
            continue
        file, _, head = name.partition(": ")
        words, share, at, odd = apart(a[name], b[name], largest.get(group_of(name), 0.0))
        if head.startswith("time "):
            times[file] = a[name]
        row = at[0] if at and name.endswith("]") and file in times and len(times[file]) == len(a[name]) else None
        place = head if row is None else f"{head} at t = {times[file][row]:g} s"
        yield name, words, odd > 0 or share > tolerance, share, place


def summaries(found):
    """One line for each table or file of fields that differs by more than the tolerance."""
    files = {}
    for name, *rest in found:
        files.setdefault(name.partition(": ")[0], []).append(rest)
    for file, rows in files.items():
        beyond = [row for row in rows if row[1]]
        if not beyond:
            continue
        words, _, share, place = max(beyond, key=lambda row: row[2])
        most = f"by at most {share:.2g} of the largest value ({place})" if share else f"such as: {words}"
        yield f"{file}: {len(beyond)} of {len(rows)} {'columns' if file.endswith('.csv') else 'fields'} differ, {most}"


OUTPUT = re.compile(r"(.*\.h5: )(t = \S+ s)/(.*)")


def by_field(found):
    """One row for each field instead of one for each of its outputs: that with the largest difference."""
    fields = {}
    for item in found:
        output = OUTPUT.fullmatch(item[0])
        fields.setdefault(output[1] + output[3] if output else item[0], []).append(item)
    for name, items in fields.items():
        worst, differ = max(items, key=lambda item: (item[2], item[3])), sum(bool(item[1]) for item in items)
        output, words = OUTPUT.fullmatch(worst[0]), worst[1]
        if output and words:
            words = f"{words} ({output[2]}; {differ} of {len(items)} outputs differ)"
        yield (name, words, *worst[2:])


def run(arguments):
    runs = run_folder(arguments.first), run_folder(arguments.second)
    for folder in runs:
        expect(folder.is_dir() and Results(folder).participants(), f"{folder}: is not the output folder of a run")
    changed = of_mappings(*map(values_in_force, runs))
    findings = of_mappings(
        *(
            {f"finding {f['participant']} {f['id']}": f.get("severity") for f in Results(folder).findings()}
            for folder in runs
        )
    )
    print(*changed, *findings, sep="\n", end="\n" if changed or findings else "")
    found = list(differences(*runs, arguments.tolerance))
    expect(found, f"{runs[0]} and {runs[1]}: have no tables and fields to compare; did the runs fail?")
    for line in summaries(found):
        print(line)
    for name, words, far, *_ in by_field(found):
        if far or arguments.all:
            print(f"  {name}: {words or 'equal'}")
    apart_ones, beyond = sum(bool(words) for _, words, *_ in found), sum(far for _, _, far, *_ in found)
    told = (
        "equal bit for bit"
        if not apart_ones
        else f"{apart_ones} differ"
        + (f", {beyond} by more than {arguments.tolerance:g}" if arguments.tolerance else "")
    )
    print(f"{len(found)} columns and fields: {told}")
    return 1 if beyond else 0
