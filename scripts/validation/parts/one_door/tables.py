# SPDX-License-Identifier: Apache-2.0
"""Bars of text data: the one reader of tables, what gzip may expand to, --check opens what a run opens."""
import json
import os
import re

from validation.job import Bar
from validation.parts.trust import house as trust_house
from validation.parts.trust.runs import gtests, wrong

RUN = "tests/cli/check_files/run.py"


def recorded(job, count, names):
    """{test: what fuzz_tables recorded}, and whether all of them passed."""
    program = next(p for p in (job.build / "tests").rglob("fuzz_tables") if p.is_file() and os.access(p, os.X_OK))
    file = job.scratch / f"fuzz_tables_{count}.json"
    result = job.run(["env", f"COUPLET_FUZZ_COUNT={count}", program, f"--gtest_filter={names}", f"--gtest_output=json:{file}"], 3600,
                     cwd=job.scratch)
    if not file.exists():
        raise RuntimeError(f"fuzz_tables ended with code {result.returncode}: {result.stdout[-200:]}")
    found = {t["name"]: t for suite in json.loads(file.read_text())["testsuites"] for t in suite["testsuite"]}
    return found, result.returncode == 0 and not any(t.get("failures") for t in found.values())


def fuzz(count):
    """Broken files and ways of writing numbers."""
    def measure(job):
        found, good = recorded(job, count, "*broken*:*every_way*")
        broken = next(t for name, t in found.items() if name.startswith("broken"))
        ways = next(t for name, t in found.items() if name.startswith("every_way"))
        return (f"{broken['files']} files through 6 readers, {broken['refused']} of {broken['tried']} refused, slowest {broken['slowest']} s, "
                f"{broken['megabytes']} MB; {ways['tried']} ways of writing numbers, {ways['refused']} refused, none misread",
                good and int(broken["files"]) >= count and int(ways["tried"]) >= count)
    return measure


def bombs(job):
    found, good = recorded(job, 1, "*bombs*")
    test = next(iter(found.values()))
    return (f"{test['refused']} of {test['tried']} refused, slowest {test['slowest']} s, {test['megabytes']} MB",
            good and test["tried"] == test["refused"] and int(test["tried"]) >= 100)


def files_and_runs(job):
    def make():
        result = job.run(["/usr/bin/python3", job.root / RUN, job.build / "bin"], 600)
        found = re.findall(r"(\d+) (files|runs), (\d+) judged wrongly", result.stdout)
        if len(found) != 2:
            raise RuntimeError(result.stdout[-200:] + result.stderr[-200:])
        return {what: (int(n), int(wrong)) for n, what, wrong in found}
    return job.once("check files", make)


def check_files(what, least):
    def measure(job):
        n, wrong_ones = files_and_runs(job)[what]
        return f"{n} {what}, {wrong_ones} judged wrongly", n >= least and wrong_ones == 0
    return measure


def sanitized(job):
    """The same program of the sanitizers' build."""
    program, folder = trust_house.sanitizer_test(job, "fuzz_tables"), job.scratch / "asan-fuzz_tables"
    result = trust_house.watched(job, folder, ["COUPLET_FUZZ_COUNT=2000", program], 3 * 3600, cwd=job.scratch)
    found = trust_house.reports(folder)
    return (f"2000 files a test, code {result.returncode}, {len(found)} kinds of reports" + (f": {found[0]}" if found else ""),
            result.returncode == 0 and not found)


def one_reader(job):
    result = job.run(["/usr/bin/python3", job.root / "tests/architecture/check_sources.py", job.root])
    lines = [line for line in result.stdout.splitlines() if "second reader" in line or "readers.py" in line]
    samples = job.run(["/usr/bin/python3", job.root / "tests/architecture/test_check_sources.py"])
    return (f"{len(lines)} outside the list; the check's own samples: {samples.stdout.strip().splitlines()[-1]}",
            not lines and samples.returncode == 0 and "files: in order" in result.stdout)


BARS = [
    Bar("a table with decimal commas (0,0;1000,5): refused with its line and what to write", "tests pass",
        gtests("unit_csv", "decimal_commas", "could_be_decimal_commas", "slip_is_not_taken")),
    Bar("... by --check, in a run alone with --strict and in a coupled run, all programs ended", "all judged rightly", check_files("runs", 6)),
    Bar("ragged rows, words, nan, inf, zero bytes, lines and files beyond the limits, pipes: file, line, what to do", "tests pass",
        gtests("unit_csv", "one_width", "no_finite_numbers", "no_text", "no_regular_file", "limits_of_size")),
    Bar("gzip: expansion and size bounded, cut and damaged files refused; measured data and several members pass", "tests pass",
        gtests("unit_csv", "cut_or_damaged", "beyond_what_measured", "whatever_the_ratio", "several_members")),
    Bar("2 000 crafted CSV through tables, grids, flows, weather, series: no crash, 5 s, 1 GB; no number misread", "none fails", fuzz(2000)),
    Bar("gzip bombs (3 MB for 3 GB; one stream, members, cut, rubbish behind): refused in 5 s and 1 GB", "all refused", bombs),
    Bar("--check finds every broken file of every key that names one, of every program, and of --restart", "all found", check_files("files", 200)),
    Bar("tables of users with a mistake each have their sentence", "cases pass", wrong("table", "velocity from a file", "--check: broken", least=3)),
    Bar("one reader: no other source opens, parts or parses text data", "none", one_reader),
    Bar("the same files and bombs under sanitizers (preset asan)", "clean", sanitized, long=True),
    Bar("20 000 crafted CSV", "none fails", fuzz(20000), long=True),
]
