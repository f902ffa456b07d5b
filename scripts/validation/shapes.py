# SPDX-License-Identifier: Apache-2.0
"""What most rows are measured by; rows.py finds these functions by their names. Each takes the job and gives (what the
table shows, whether it is met).

Tests: `claims` and `filtered` ask whether tests of a test executable pass, `tests` those that ctest knows, `script`
whether a script ends well, `wrong` wrong configurations; `at_most`, `at_least`, `between`, `numbers`, `near`, `shown`,
`told` judge what tests record: `pattern` chooses tests by name, `keys` (separated by spaces) the numbers; a test that
did not pass is never a bar that is met.

Runs: `run` reads numbers of a case of configs/ and compares them with what is right, `apart` those of several runs with
each other; `order` tells how they converge from run to run, `extrapolated` how far they are from their limit. `fuzz`
sums up what fuzz programs record."""
import fnmatch
import math
import re
import sys

import numpy as np

from couplet.runs.pool import WARNING
from couplet.series import extrema
from couplet.study.axes import evaluate
from couplet.study.quantities import top


def tests(job, pattern, least=1, seconds=1800):
    """Registered tests, such as one program on 1, 2 and 3 ranks; one that is skipped does not pass."""
    passed, total, skipped, output = job.ctest(pattern, seconds)
    lost = re.findall(r"\d+ - (\S+) \((?:Failed|Timeout|Not Run)", output)
    lost = f" (lost: {', '.join(lost[:4])})" if lost else f" ({skipped} skipped)" if skipped else ""
    return f"{passed} of {total} tests pass{lost}", passed == total >= least


def claims(job, program, names, least=0):
    """Tests of an executable whose names hold the pattern, or one of several; `least`: so many, if not one for each."""
    names = (names,) if isinstance(names, str) else names
    found, _ = job.gtest(program)
    return held([v["passed"] for n, v in found.items() if any(re.search(p, n) for p in names)], least or len(names))


def held(passed, least=1):
    return f"{sum(passed)} of {len(passed)} claims hold", len(passed) >= least and all(passed)


def script(job, path, *words, timeout=7200):
    """A script that prints its sum in its last line; {bin} and {root} are the folders of programs and project."""
    words = [str(w).format(bin=job.build / "bin", root=job.root) for w in words]
    result = job.run(["/usr/bin/python3", job.root / path, *words], timeout)
    last = (result.stdout.strip() or result.stderr.strip()).splitlines()[-1]
    return last[:300], result.returncode == 0


def fuzz(job, programs, count, filter_="*", least=None):
    """Fuzz programs, each at `count` inputs: sums of what their tests recorded, but for times and memory, of which the
    most counts; `least`: so many were tried in all, if not `count` by each."""
    found = [test for program in programs.split() for test in job.gtest(program, filter_, 3600, count)[0].values()]
    keys = [key for key in dict.fromkeys(k for test in found for k in test) if key != "passed"]
    total = {
        key: (max if key in ("slowest", "megabytes") else sum)(float(test.get(key, 0)) for test in found)
        for key in keys
    }
    said = ", ".join(f"{key.replace('_', ' ')} {value:g}" for key, value in total.items())
    return said, all(test["passed"] for test in found) and total["tried"] >= (least or count * len(programs.split()))


def wrong(job, names, least):
    """Runs the cases of tests/cli/wrong whose names begin with one of `names`."""
    sys.path.insert(0, str(job.root / "tests/cli/wrong"))
    import table

    chosen = [case.name for case in table.CASES if case.name.startswith(names)]
    result = job.run(["/usr/bin/python3", job.root / "tests/cli/wrong/run.py", job.build / "bin", *chosen])
    good = len(re.findall(r"^ok ", result.stdout, re.M))
    return f"{good} of {len(chosen)} cases pass", result.returncode == 0 and good == len(chosen) >= least


# -- numbers that tests record -----------------------------------------------------------------------------------------
def recorded(job, program, pattern, keys):
    found = [job.recorded(program, pattern, key) for key in keys.split()]
    return [v for values, _ in found for v in values], all(passed for _, passed in found)


def listed(values, text):
    return ", ".join(text.format(v).replace("%", " %") for v in values)


def at_most(job, program, pattern, keys, limit, text="{:.1e}"):
    """Compares absolute values, because an error may have either sign."""
    values, passed = recorded(job, program, pattern, keys)
    shown = (
        listed(values, text) if len(values) < 8 else f"{listed([max(values, key=abs)], text)} at most of {len(values)}"
    )
    return shown, passed and max(map(abs, values)) <= limit


def at_least(job, program, pattern, keys, limit, also="", text="{:.2f}"):
    """`also`: further keys, to be shown."""
    values, passed = recorded(job, program, pattern, keys)
    more = (
        f" ({key.replace('_', ' ')} {listed(job.recorded(program, pattern, key)[0], text)})" for key in also.split()
    )
    return listed(values, text) + "".join(more), passed and all(v >= limit for v in values)


def between(job, program, pattern, keys, low, high, text="{:.3f}"):
    values, passed = recorded(job, program, pattern, keys)
    return listed(values, text), passed and all(low <= v <= high for v in values)


def numbers(job, program, pattern, keys, text="{:.3g}"):
    """Several, each with its range: {key: [least, most]}, null where there is no bound; the name of another key stands
    for its number."""
    said, met = [], True
    for key, bounds in keys.items():
        low, high = (job.recorded(program, pattern, b)[0][0] if isinstance(b, str) else b for b in bounds)
        values, passed = recorded(job, program, pattern, key)
        said.append(f"{key.replace('_', ' ')} {listed(values, text)}")
        met = met and passed and all((low is None or v >= low) and (high is None or v <= high) for v in values)
    return "; ".join(said), met


def near(job, program, pattern, keys, wanted, share, text="{:.4g}"):
    """Checks that values are within this share of the wanted one."""
    values, passed = recorded(job, program, pattern, keys)
    said = ", ".join(f"{text.format(v)} ({100 * (v / wanted - 1):+.2f} %)" for v in values)
    return said, passed and all(abs(v / wanted - 1) <= share for v in values)


def told(job, program, filter_, keys):
    """Returns texts that tests recorded. Keys are separated by spaces, and * matches many."""
    tests, _ = job.gtest(program, filter_)
    found = [
        (key, value)
        for test in tests.values()
        for wanted in keys.split()
        for key, value in test.items()
        if fnmatch.fnmatch(key, wanted)
    ]
    return "; ".join(f"{key.replace('_', ' ')}: {value.strip()}" for key, value in found), bool(found) and all(
        test["passed"] for test in tests.values()
    )


def shown(job, program, pattern, keys, text="{:g}"):
    """Reported."""
    return listed(recorded(job, program, pattern, keys)[0], text), None


# -- numbers of a run
# -----------------------------------------------------------------------------------------------------
WAYS = {
    "last": lambda values: values[-1],
    "first": lambda values: values[0],
    "least": min,
    "largest": max,
    "mean": np.mean,
    "all": lambda values: values,
    "top": lambda values: top(np.arange(len(values)), values)[1],
    # rms third difference over rms first difference of the last 8 steps: below 0.1 smooth, above 1 a two-step
    # oscillation
    "zigzag": lambda values: float(np.sqrt(np.mean(np.diff(values[-9:], 3) ** 2) / np.mean(np.diff(values[-9:]) ** 2))),
}


def run(
    job,
    case,
    read,
    of=None,
    within=None,
    low=None,
    high=None,
    limits=(),
    keys=(),
    quick=(),
    meshes=("",),
    quiet=False,
    cost=False,
    timeout=3600,
):
    """`case`: as job.case takes it. `read`, one or several: 'FILE.csv: COLUMN' of the participant's monitors (of
    another participant 'NAME/FILE.csv') at the end, or over the run with a word of WAYS before the column, in a row
    ('row-6'), or the number ('maximum-1') and the time ('time-of-maximum-1', the middle of what is within 1 %) of a
    maximum; 'FILE.py: FUNCTION(NUMBERS).KEY' of a file beside the case, which takes the participant's folder
    ('./FILE.py': that of the run; without KEY: all that it gives); 'passes: mean' of the coupling, 'residual: largest'
    of its last passes. Met where it is within the share `within` of `of`, or from `low` to `high`, each one number or
    one for each reading, and with `quiet` where the run does not warn; reported where nothing judges. `keys`: keys of
    the case, '.key' for those of its participant, or 'ranks=1,2,1,1'; `quick`: further keys with --quick. `meshes`: its
    mesh-parameters, or lists of keys, of several runs, of which the last is judged; `limits`: of each, of the share by
    which the first reading is off, or of its size without `of`. `cost`: shows the processor minutes."""
    keys = (*keys_of(keys), *(keys_of(quick) if job.quick else ()))
    runs = [started(job, case, (*keys, *own_of(mesh)), timeout) for mesh in meshes]
    found = [readings(job, case, results, read) for results in runs]
    said, verdicts = [], []
    for i, (name, value) in enumerate(found[-1].items()):
        right, share, least, most = (number(x[i] if isinstance(x, tuple) else x) for x in (of, within, low, high))
        off = None if right is None else value / right - 1
        unit = re.search(r"\[([^-\]][^\]]*)\]$", name)
        text = (
            ", ".join(f"{values[name]:.5g}" for values in found)
            + (f" {unit[1]}" if unit else "")
            + (f" ({100 * off:+.2f} %)" if right is not None else "")
        )
        said.append(text if len(found[-1]) == 1 else f"{name.split(' [')[0]} {text}")
        verdicts += [abs(off) <= share] if share is not None else []
        verdicts += [value >= least] if least is not None else []
        verdicts += [value <= most] if most is not None else []
    verdicts += within_limits([next(iter(one.values())) for one in found], number(of) if limits else None, limits)
    warned = WARNING.findall(runs[-1].log) if quiet else []
    said = (
        "; ".join(said)
        + (f", {warned[0] if warned else 'no warning'}" if quiet else "")
        + (f" ({runs[-1].cost.cpu / 60:.1f} processor minutes)" if cost else "")
    )
    return said, bool(all(verdicts)) and not warned if verdicts else None


def apart(job, case, read, runs, within, keys=(), quick=(), timeout=3600):
    """Readings of several runs of a case, {name: further keys}, beside those of the first: each within the share
    `within` of it, a whole column ('all') of its largest value. `quick`: further keys with --quick."""
    keys, found, said = (*keys_of(keys), *(keys_of(quick) if job.quick else ())), {}, []
    for name, own in runs.items():
        results = started(job, case, (*keys, *keys_of(own)), timeout)
        found[name] = readings(job, case, results, read)
        passes = (
            f", {results.iterations().mean():.2f} coupling iterations per step"
            if (results.folder / "coupler/residuals.csv").exists()
            else ""
        )
        right = next(iter(found.values()))
        gaps = [
            float(np.max(np.abs(value - right[key])) / np.max(np.abs(right[key]))) for key, value in found[name].items()
        ]
        shown = (
            ""
            if any(np.ndim(v) for v in found[name].values())
            else " ".join(f"{v:.5g}" for v in found[name].values()) + ", "
        )
        said.append(
            (
                (
                    f"{name}: {shown}{max(gaps):.1e} apart{passes}"
                    if len(found) > 1
                    else f"{name}: {shown or 'runs'}{passes}".rstrip(", ")
                ),
                max(gaps),
            )
        )
    return "; ".join(text for text, _ in said) + (" (a quick run)" if quick and job.quick else ""), all(
        gap <= within for _, gap in said
    )


def order(job, case, read, runs, least, of=None, limits=(), errors=False, keys=(), timeout=3600):
    """Order by which readings converge over runs of which each, by its keys or its mesh-parameters, is twice as fine as
    the one before: of their changes on average, or of their errors against `of` in each step. `limits`: of each run, of
    the share by which it is off."""
    found = [readings(job, case, started(job, case, (*keys_of(keys), *own_of(own)), timeout), read) for own in runs]
    said, met = [], True
    for i, key in enumerate(found[0]):
        values, right = [one[key] for one in found], number(of[i] if isinstance(of, tuple) else of)
        gaps = [abs(v - right) for v in values] if errors else [abs(a - b) for a, b in zip(values, values[1:])]
        orders = (
            [math.log2(a / b) for a, b in zip(gaps, gaps[1:])]
            if errors
            else [math.log2(gaps[0] / gaps[-1]) / (len(gaps) - 1)]
        )
        said.append(
            f"{', '.join(f'{v:.6g}' for v in values)}: order {', '.join(f'{o:.2f}' for o in orders)}"
            + (f" (the last {100 * (values[-1] / right - 1):+.3f} %)" if right else "")
        )
        met = met and min(orders) >= least and all(within_limits(values, right, limits))
    return "; ".join(said), bool(met)


def extrapolated(job, case, read, runs, within, ratio=2, formal=None, which=-1, keys=(), timeout=3600):
    """Readings of the last run, or of run `which`, beside the limit of the two finest, each `ratio` as fine as the one
    before: by the formal order, or by the one that the last three show, from 1 to 2."""
    found = [readings(job, case, started(job, case, (*keys_of(keys), *own_of(own)), timeout), read) for own in runs]
    said, met = [], True
    for key in found[0]:
        values = [one[key] for one in found]
        first, second = values[-2] - values[-3], values[-1] - values[-2]
        shown = formal or (
            min(2.0, max(1.0, math.log(first / second) / math.log(number(ratio)))) if first * second > 0 else 1.0
        )
        limit = values[-1] + second / (number(ratio) ** shown - 1)
        off = values[which] / limit - 1
        said.append(
            f"{key.split(' [')[0]} {', '.join(f'{v:.6g}' for v in values)}, limit {limit:.6g} by order {shown:.1f}:"
            f" {100 * off:+.2f} %"
        )
        met = met and abs(off) <= within
    return "; ".join(said), bool(met)


def within_limits(values, right, limits):
    return [
        abs(value if right is None else value / right - 1) <= limit
        for value, limit in zip(values, limits)
        if limit is not None
    ]


def keys_of(keys):
    """Keys of a row, some of which may be lists."""
    return tuple(
        k
        for key in ((keys,) if isinstance(keys, str) else keys or ())
        for k in ((key,) if isinstance(key, str) else key)
    )


def own_of(run):
    """Keys of one of several runs: a text is its mesh-parameters."""
    return keys_of(run) if not isinstance(run, str) else (".mesh-parameters={%s}" % run,) if run else ()


def started(job, case, keys, timeout):
    """The run of a case, with a key 'ranks=1,2,1,1' on these ranks."""
    ranks = next((tuple(map(int, k[6:].split(","))) for k in keys if k.startswith("ranks=")), ())
    return job.case(case, tuple(k for k in keys if not k.startswith("ranks=")), ranks, timeout)


def readings(job, case, results, read):
    """Reads one or several results of a run. Returns {name: value}."""
    found = {}
    for text in (read,) if isinstance(read, str) else read:
        found |= {
            (text.split(": ", 1)[1] if k in found else k): v for k, v in reading(job, case, results, text).items()
        }
    return found


def reading(job, case, results, text):
    file, what = text.split(": ", 1)
    if file == "passes":
        return {f"{what} coupling iterations per step": float(WAYS[what](results.iterations()))}
    if file == "residual":  # of the last pass of each step
        return {
            f"{what} residual": float(
                WAYS[what](
                    results.table("coupler", "residuals.csv")["relative residual"][np.cumsum(results.iterations()) - 1]
                )
            )
        }
    who, _, file = file.rpartition("/")
    who = who or results.participant
    if file.endswith(".py"):
        function, numbers, key = re.fullmatch(r"(\w+)\(([^)]*)\)(?:\.(.+))?", what).groups()
        found = getattr(job.beside(f"configs/{case.split('/')[0]}/{file}"), function)(
            results.folder / who, *(float(n) for n in numbers.split(",") if n)
        )
        return {key: found[int(key) if key.isdigit() else key]} if key else found
    way, _, column = what.partition(" ")
    if asked := re.fullmatch(r"(time-of-)?maximum-(\d)", way):
        times, values = results.column(who, file, "time [s]"), results.column(who, file, column)
        time, top, _ = [found for found in extrema(times, values) if found[2] == "max"][int(asked[2]) - 1]
        if not asked[1]:
            return {column: top}
        below = values < top - 0.01 * abs(
            top
        )  # the middle of a flat top: a ripple on it moves the largest value from one end to the other
        return {
            f"time of {column.split(' [')[0]} [s]": 0.5 * float(
                times[below & (times < time)].max() + times[below & (times > time)].min()
            )
        }
    if row := re.fullmatch(r"row-(\d+)", way):
        return {what: float(results.column(who, file, column)[int(row[1])])}
    values = results.column(who, file, column if way in WAYS else what)
    found = WAYS.get(way, WAYS["last"])(values)
    return {column if way in WAYS else what: found if way == "all" else float(found)}


def number(given):
    """A number, or the value of '100*40**3/(3*210e9/12)'; pi is known."""
    return evaluate(given, {"pi": math.pi}) if isinstance(given, str) else given
