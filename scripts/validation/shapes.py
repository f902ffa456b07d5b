# SPDX-License-Identifier: Apache-2.0
"""What most rows are measured by; rows.py finds these functions by their names. Each takes the job and gives (what the table shows, whether it is met).

Tests: `claims` and `filtered` ask whether tests of a test executable pass, `tests` those that ctest knows, `script` whether a script ends well, `wrong` wrong
configurations; `at_most`, `at_least`, `between`, `numbers`, `near`, `shown`, `told` judge what tests record: `pattern` chooses tests by name, `keys` (separated by
spaces) the numbers; a test that did not pass is never a bar that is met.

Runs: `run` reads numbers of a case of configs/ that one program runs and compares them with what is right."""
import math
import re
import sys

from couplet.runs.pool import WARNING
from couplet.study.axes import evaluate


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


def filtered(job, program, filter_):
    """Only these tests of a long executable."""
    found, _ = job.gtest(program, filter_)
    return held([v["passed"] for v in found.values()])


def held(passed, least=1):
    return f"{sum(passed)} of {len(passed)} claims hold", len(passed) >= least and all(passed)


def script(job, path, *words, timeout=7200):
    """A script that prints its sum in its last line; {bin} and {root} are the folders of programs and project."""
    words = [str(w).format(bin=job.build / "bin", root=job.root) for w in words]
    result = job.run(["/usr/bin/python3", job.root / path, *words], timeout)
    last = (result.stdout.strip() or result.stderr.strip()).splitlines()[-1]
    return last[:300], result.returncode == 0


def wrong(job, names, least):
    """Those cases of tests/cli/wrong whose names begin so."""
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
    """Of their sizes: an error may have either sign."""
    values, passed = recorded(job, program, pattern, keys)
    shown = listed(values, text) if len(values) < 8 else f"{listed([max(values, key=abs)], text)} at most of {len(values)}"
    return shown, passed and max(map(abs, values)) <= limit


def at_least(job, program, pattern, keys, limit, also="", text="{:.2f}"):
    """`also`: further keys, to be shown."""
    values, passed = recorded(job, program, pattern, keys)
    more = (f" ({key.replace('_', ' ')} {listed(job.recorded(program, pattern, key)[0], text)})" for key in also.split())
    return listed(values, text) + "".join(more), passed and all(v >= limit for v in values)


def between(job, program, pattern, keys, low, high, text="{:.3f}"):
    values, passed = recorded(job, program, pattern, keys)
    return listed(values, text), passed and all(low <= v <= high for v in values)


def numbers(job, program, pattern, keys, text="{:.3g}"):
    """Several, each with its range: {key: [least, most]}, null where there is no bound."""
    said, met = [], True
    for key, (low, high) in keys.items():
        values, passed = recorded(job, program, pattern, key)
        said.append(f"{key.replace('_', ' ')} {listed(values, text)}")
        met = met and passed and all((low is None or v >= low) and (high is None or v <= high) for v in values)
    return "; ".join(said), met


def near(job, program, pattern, keys, wanted, share, text="{:.4g}"):
    """Within this share of what is wanted."""
    values, passed = recorded(job, program, pattern, keys)
    said = ", ".join(f"{text.format(v)} ({100 * (v / wanted - 1):+.2f} %)" for v in values)
    return said, passed and all(abs(v / wanted - 1) <= share for v in values)


def told(job, program, filter_, keys):
    """What tests recorded as text, the keys separated by spaces."""
    found, _ = job.gtest(program, filter_)
    said = "; ".join(f"{key.replace('_', ' ')}: {test[key].strip()}" for test in found.values() for key in keys.split())
    return said, all(test["passed"] for test in found.values())


def shown(job, program, pattern, keys, text="{:g}"):
    """Reported."""
    return listed(recorded(job, program, pattern, keys)[0], text), None


# -- numbers of a run -----------------------------------------------------------------------------------------------------
WAYS = {"first": lambda values: values[0], "least": min, "largest": max}


def run(job, case, read, of=None, within=None, low=None, high=None, keys=(), meshes=("",), quiet=False, timeout=3600):
    """`case`: a folder of configs/, or a file in it, 'folder/name'. `read`, one or several: 'FILE.csv: COLUMN' of the participant's monitors, at the end ('least',
    'largest' or 'first' before the column: over the run), or 'FILE.py: FUNCTION(NUMBERS).KEY' of a file beside the case, which takes the participant's folder
    (without KEY: all that it gives). Met where it is within the share `within` of `of`, or from `low` to `high`, each one number or one for each reading, and with
    `quiet` where the run does not warn; reported where nothing judges. `keys`: of the case, '.key' those of its participant. `meshes`: its mesh-parameters of
    several runs, of which the last is judged."""
    keys = [k for key in keys for k in ((key,) if isinstance(key, str) else key)]
    runs = [job.alone(case, (*keys, *((".mesh-parameters={%s}" % mesh,) if mesh else ())), timeout=timeout) for mesh in meshes]
    found = [{k: v for text in ((read,) if isinstance(read, str) else read) for k, v in reading(job, case, results, text).items()} for results in runs]
    said, verdicts = [], []
    for i, (name, value) in enumerate(found[-1].items()):
        right, share, least, most = (number(x[i] if isinstance(x, tuple) else x) for x in (of, within, low, high))
        off = None if right is None else value / right - 1
        unit = re.search(r"\[([^-\]][^\]]*)\]$", name)
        text = ", ".join(f"{values[name]:.5g}" for values in found) + (f" {unit[1]}" if unit else "") + (f" ({100 * off:+.2f} %)" if right is not None else "")
        said.append(text if len(found[-1]) == 1 else f"{name.split(' [')[0]} {text}")
        verdicts += [abs(off) <= share] if share is not None else []
        verdicts += [value >= least] if least is not None else []
        verdicts += [value <= most] if most is not None else []
    warned = WARNING.findall(runs[-1].log) if quiet else []
    return "; ".join(said) + (f", {warned[0] if warned else 'no warning'}" if quiet else ""), all(verdicts) and not warned if verdicts else None


def reading(job, case, results, text):
    """{name: value}"""
    file, what = text.split(": ", 1)
    folder = results.folder / results.participant
    if file.endswith(".py"):
        function, numbers, key = re.fullmatch(r"(\w+)\(([^)]*)\)(?:\.(.+))?", what).groups()
        found = getattr(job.beside(f"configs/{case.split('/')[0]}/{file}"), function)(folder, *(float(n) for n in numbers.split(",") if n))
        return {key: found[key]} if key else found
    way, _, column = what.partition(" ")
    if way not in WAYS:
        return {what: float(results.column(results.participant, file, what)[-1])}
    return {column: float(WAYS[way](results.column(results.participant, file, column)))}


def number(given):
    """A number, or the value of '100*40**3/(3*210e9/12)'; pi is known."""
    return evaluate(given, {"pi": math.pi}) if isinstance(given, str) else given
