# SPDX-License-Identifier: Apache-2.0
"""Measures of text data: the one reader of tables, what gzip may expand to, --check opens what a run opens."""
import re

from validation.parts.trust import house as trust_house

RUN = "tests/cli/check_files/run.py"


def fuzz(job, count):
    """Broken files and ways of writing numbers."""
    found, good = job.fuzz("fuzz_tables", count, "*broken*:*every_way*")
    broken = next(t for name, t in found.items() if name.startswith("broken"))
    ways = next(t for name, t in found.items() if name.startswith("every_way"))
    return (f"{broken['files']} files through 6 readers, {broken['refused']} of {broken['tried']} refused, slowest {broken['slowest']} s, "
            f"{broken['megabytes']} MB; {ways['tried']} ways of writing numbers, {ways['refused']} refused, none misread",
            good and int(broken["files"]) >= count and int(ways["tried"]) >= count)


def bombs(job):
    found, good = job.fuzz("fuzz_tables", 1, "*bombs*")
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


def check_files(job, what, least):
    n, wrong_ones = files_and_runs(job)[what]
    return f"{n} {what}, {wrong_ones} judged wrongly", n >= least and wrong_ones == 0


def sanitized(job):
    """The same program of the sanitizers' build."""
    words, folder = trust_house.sanitizer_test(job, "fuzz_tables"), job.scratch / "asan-fuzz_tables"
    result = trust_house.watched(job, folder, ["COUPLET_FUZZ_COUNT=2000", *words], 3 * 3600, cwd=job.scratch)
    found = trust_house.reports(folder)
    return (f"2000 files a test, code {result.returncode}, {len(found)} kinds of reports" + (f": {found[0]}" if found else ""),
            result.returncode == 0 and not found)


def one_reader(job):
    result = job.run(["/usr/bin/python3", job.root / "tests/architecture/check_sources.py", job.root])
    lines = [line for line in result.stdout.splitlines() if "second reader" in line]
    samples = job.run(["/usr/bin/python3", job.root / "tests/architecture/test_check_sources.py"])
    return (f"{len(lines)} outside the list; the check's own samples: {samples.stdout.strip().splitlines()[-1]}",
            not lines and samples.returncode == 0 and "files: in order" in result.stdout)
