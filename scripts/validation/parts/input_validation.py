# SPDX-License-Identifier: Apache-2.0
"""Crafted files and messages: refused or sound, within time and memory."""
import re


# -- data -------------------------------------------------------------------------------------------------------------
def fuzz_files(job, name, test, count):
    found, _ = job.fuzz(name, count)
    one = found[test]
    apart = f", {one['crashed_apart']} crashed in the rehearsal and were refused" if "crashed_apart" in one else ""
    return (f"{one['tried']} tried, {one['refused']} refused{apart}, 0 crashes, slowest {one['slowest']} s, {one['megabytes']} MB",
            one["passed"] and int(one["tried"]) >= count)


# -- tables -----------------------------------------------------------------------------------------------------------
RUN = "tests/cli/check_files/run.py"


def fuzz_tables(job, count):
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


# -- gmsh -------------------------------------------------------------------------------------------------------------
def crafted(job, count=500):
    """Geometry files written against the allowlist, with a gmsh that notes its starts and without bubblewrap."""
    found, good = job.fuzz("fuzz_geo", count)  # also: the copy that gmsh gets is meshed as the file itself
    test = next(t for name, t in found.items() if name.startswith("files_are_refused"))
    good = good and int(test["tried"]) >= count
    return (f"{test['tried']} tried: {test['refused']} refused before gmsh, {test['let_through']} let through without harm, slowest "
            f"{test['slowest']} s", good and float(test["slowest"]) < 5)
