# SPDX-License-Identifier: Apache-2.0
"""Measures of the house, counted from the sources: geometry, conditions, folders, namespaces, lengths, lines; minutes of a build."""
import importlib
import os
import pathlib
import re
import resource
import shutil
import sys

PROGRAMS = ("solid_solver", "fluid_solver", "mesh_mover", "thermocline", "plate_modal", "coupler")
HOUSE = ("common", *PROGRAMS)
LONGEST_FUNCTION, MOST_MEMBERS = 60, 25
# Of b350924, the commit that the plan was measured at.
LINES_BEFORE, SCRIPT_LINES_BEFORE = 72600, 11437
GROWN = ": the bar is of a tree with about half of the capabilities"


def tracked(job, *folders):
    return job.once(("tracked", folders), lambda: job.run(["git", "-C", job.root, "ls-files", *folders]).stdout.split("\n")[:-1])


def texts(job):
    """{path: text} of the C++ of programs and common."""
    def make():
        return {f: (job.root / f).read_text() for f in tracked(job, *HOUSE) if f.endswith((".cpp", ".hpp"))}
    return job.once("house texts", make)


def checks(job, name):
    """A module of tests/architecture, whose table the bars share."""
    folder = str(job.root / "tests/architecture")
    if folder not in sys.path:
        sys.path.append(folder)
    return importlib.import_module(name)


def matches(job, pattern, folders, apart=""):
    """{file: lines that hold the pattern} of programs and common, or of some of their folders."""
    return {f: n for f, text in texts(job).items() if (not folders or f.startswith(folders)) and not (apart and re.search(apart, f))
             for n in [sum(bool(re.search(pattern, line)) for line in text.splitlines())] if n}


def most(found, limit, what):
    worst = sorted(found, key=lambda f: -found[f])[:3]
    return f"{what}{': ' + ', '.join(f'{f} {found[f]}' for f in worst) + (' ...' if len(found) > 3 else '') if found else ''}", limit


def lines_with(job, pattern, folders=(), apart=""):
    found = matches(job, pattern, folders, apart)
    n = sum(found.values())
    return most(found, n == 0, f"{n} lines in {len(found)} files")


def files_with(job, pattern, folders, limit):
    found = matches(job, pattern, folders)
    return most(found, len(found) <= limit, f"{len(found)} files")


def crowded(job):
    paths = [pathlib.PurePosixPath(f) for f in texts(job)]
    found = checks(job, "floors").crowded(paths)
    return f"{len(found)} of {len({p.parent for p in paths})} folders{': ' + '; '.join(found[:3]) if found else ''}", not found


def readmes(job):
    folders = sorted({str(pathlib.PurePosixPath(f).parent) for f in texts(job)})
    lengths = {f: len((job.root / f / "README.md").read_text().splitlines()) if (job.root / f / "README.md").exists() else 0 for f in folders}
    below = [f for f in folders if f.count("/") > f.startswith("common/")]
    bad = [f for f in folders if lengths[f] == 0 or f in below and lengths[f] > 20]
    return f"{len(folders)} folders, {len(below)} of them sub-folders; without or too long: {', '.join(bad) or 'none'}", not bad


def bare(job):
    headers = {f: text for f, text in texts(job).items() if f.endswith(".hpp")}
    excepted = checks(job, "namespaces").EVERYBODYS
    found = [f for f, text in headers.items() if re.search(r"^namespace couplet\s*\{", text, re.M)]
    rest = [f for f in found if f not in excepted]
    return f"{len(rest)} of {len(headers)} headers, and {', '.join(excepted)} by a written exception", not rest


def long_functions(job):
    bodies = checks(job, "lengths").bodies
    found = {f"{f}:{line}": n for f, text in texts(job).items() for line, n in bodies(text) if n > LONGEST_FUNCTION}
    total = sum(len(bodies(text)) for text in texts(job).values())
    return most(found, not found and total > 1000, f"{len(found)} of {total} functions")


def large_classes(job):
    members = checks(job, "lengths").members_of_classes
    found = {f"{name} ({f})": n for f, text in texts(job).items() for name, _, n in members(text) if n > MOST_MEMBERS}
    reasons = checks(job, "lengths").LARGE_CLASSES
    unexplained = sum(key.split()[0] not in reasons for key in found)
    return most(found, len(found) <= 3 and not unexplained, f"{len(found)} classes, {unexplained} without a reason in tests/architecture/lengths.py")


def long_files(job):
    found = {f: n for f, text in texts(job).items() for n in [len(text.splitlines())] if n > 300}
    return most(found, not found, f"{len(found)} files")


def lines_of(job, files):
    return sum(len((job.root / f).read_bytes().splitlines()) for f in files if (job.root / f).is_file())


def mass(job):
    n = lines_of(job, tracked(job, *HOUSE))
    return f"{n} lines, {100 * n / LINES_BEFORE:.0f} % of {LINES_BEFORE}{GROWN}", n <= 0.95 * LINES_BEFORE


def script_mass(job):
    n = lines_of(job, [*tracked(job, "scripts"), *(f for f in tracked(job, "client/python") if not f.endswith(("participant.py", "transports.py"))), *(f for f in tracked(job, "tests/verification", "benchmarks") if f.endswith((".py", ".sh")))])
    return f"{n} lines, {100 * n / SCRIPT_LINES_BEFORE:.0f} % of {SCRIPT_LINES_BEFORE}{GROWN}", n <= 0.85 * SCRIPT_LINES_BEFORE


def glossary(job):
    there = (job.root / "docs/glossary.md").exists()
    checked = any("glossary" in f.read_text() for f in (job.root / "tests/architecture").glob("check_*.py"))
    return f"{'a' if there else 'no'} docs/glossary.md, {'a' if checked else 'no'} check of tests/architecture reads it", there and checked


def comparison(job):
    folder = str(job.root / "benchmarks/linalg")
    if folder not in sys.path:
        sys.path.append(folder)
    tables = importlib.import_module("tables")
    rows = tables.read(job.root / "benchmarks/linalg/table.csv")
    there = [n for n in tables.HAND_WRITTEN if any((job.root / "common/linalg").rglob(f"{n}.hpp"))]
    gains = {n: tables.best(rows, n) for n in there}
    lacking = tables.problems(rows, job.root / "common/linalg")
    text = ", ".join(f"{n} {min(g[:2]):.2f} of PETSc's best ({g[2]['system']})" for n, g in gains.items() if g)
    return f"{len({r['system'] for r in rows})} systems, {len(rows)} rows; {text}{'; ' + '; '.join(lacking) if lacking else ''}", not lacking


def minutes(job, limit, *targets):
    """Processor minutes of compiler and linker from an empty folder, two jobs, no compiler cache."""
    folder = job.scratch / "house-build"
    shutil.rmtree(folder, ignore_errors=True)
    result = job.run(["cmake", "-G", "Ninja", "-S", job.root, "-B", folder], 600)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    if result.returncode == 0:
        result = job.run(["env", "CCACHE_DISABLE=1", "ninja", "-C", folder, "-j", min(2, os.cpu_count()), *targets], 4 * 3600)
    if result.returncode != 0:
        raise RuntimeError((result.stderr or result.stdout)[-300:])
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime) / 60
    return f"{used:.1f} min", used <= limit
