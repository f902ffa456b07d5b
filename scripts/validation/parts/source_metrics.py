# SPDX-License-Identifier: Apache-2.0
"""Metrics of the sources, counted with regular expressions rather than a compiler: good to a few per cent, and the same
from one commit to the next. Every measure returns (what it found, whether the limit is met)."""
import importlib
import json
import os
import re
import resource
import shutil
import statistics
import sys

PROGRAMS = ("solid_solver", "fluid_solver", "mesh_mover", "thermocline", "plate_modal", "coupler")
HOUSE = ("common", *PROGRAMS)
LITERAL = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'(?!\w)', re.S)
CLASS = re.compile(r"\b(?:class|struct)\s+(?:\[\[\w+\]\]\s*)?([\w:]+)(?:\s+final)?\s*(?::([^:;{(][^;{(]*))?\{")


# -- files ------------------------------------------------------------------------------------------------------------
def tracked(job, *folders):
    return job.once(
        ("tracked", folders), lambda: job.run(["git", "-C", job.root, "ls-files", *folders]).stdout.split("\n")[:-1]
    )


def texts(job):
    """Returns {path: text} of the C++ of programs and common."""

    def make():
        return {
            f: (job.root / f).read_text()
            for f in tracked(job, *HOUSE)
            if f.endswith((".cpp", ".hpp")) and (job.root / f).is_file()
        }

    return job.once("texts of the sources", make)


def lines_of(job, endings, *folders):
    return sum(
        len((job.root / f).read_bytes().splitlines())
        for f in tracked(job, *folders)
        if f.endswith(endings) and (job.root / f).is_file()
    )


def worst(found, count=3):
    names = sorted(found, key=lambda f: -found[f])
    return ", ".join(f"{n} {found[n]}" for n in names[:count]) + (" ..." if len(names) > count else "")


def lines(job, endings, folders, most):
    n = lines_of(job, tuple(endings), *folders)
    return f"{n}", n <= most


def tokens(job, most):
    """Comments and blanks do not count."""
    one = re.compile(
        r'(//[^\n]*|/\*.*?\*/)|R"(\w*)\(.*?\)\2"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'(?!\w)|'
        r'\d(?:[\w.\']|(?<=[eE])[+-])*|\w+|\S',
        re.S,
    )
    n = sum(not token[1] for text in texts(job).values() for token in one.finditer(text))
    return f"{n}", n <= most


def size(job, folder, megabytes, most):
    """Files of the last commit, in a folder or '.'."""
    sizes = [
        int(line.split()[3])
        for line in job.run(["git", "-C", job.root, "ls-tree", "-r", "-l", "HEAD", folder]).stdout.splitlines()
    ]
    return f"{len(sizes)} files, {sum(sizes) / 1e6:.2f} MB", sum(sizes) <= megabytes * 1e6 and len(sizes) <= most


def pack(job):
    clone = job.scratch / "clone"
    job.run(["git", "clone", "-q", "--bare", "--depth", "1", f"file://{job.root}", clone])
    return f"{sum(f.stat().st_size for f in clone.rglob('*.pack')) / 1e6:.2f} MB", True


def lines_of_programs(job, most):
    found = {}
    for f, text in texts(job).items():
        found[f.split("/")[0]] = found.get(f.split("/")[0], 0) + len(text.splitlines())
    return f"{sum(found.values())}: {worst(found, 7)}", sum(found.values()) <= most


def files(job, most):
    sizes = [len(t.splitlines()) for t in texts(job).values()]
    return f"{len(sizes)} files, median {statistics.median(sizes):.0f} lines", len(sizes) <= most


# Ten cases of different kinds as runs of seconds: (case, keys, whether it is a single static solve).
TEN = (
    ("cook", (".mesh-parameters={n: 64, shape: 0}",), True),
    ("elliptic-plate", (), True),
    ("filleted-bracket", (), True),
    ("bent-beam", (), True),
    ("vibrating-cantilever", ("simulation.end-time=10 s",), False),
    ("cavity", ("simulation.end-time=4 s",), False),
    ("cylinder", (".mesh-parameters={n: 24}", "simulation.end-time=0.4 s"), False),
    ("perpendicular-flap", ("simulation.end-time=0.3 s",), False),
    ("plate-drop", ("simulation.end-time=0.04 s",), False),
    ("thermocline-andasol", ("simulation.end-time=10 day", ".report.run-in=2 day"), False),
)


def share_of_diagnostics(job, most, most_of_static):
    """Returns the time of the timer that every run has, over the processor time of its process. In a coupled job the
    participant with the largest share counts. The timer also counts while other processes run, hence the least of three
    runs, and over the time on the clock if that is longer."""
    found = {}
    for case, keys, is_static in TEN:
        runs = [job.case(case, (*keys, f"simulation.name={case}-{i}")) for i in range(3)]
        reports = [[json.loads(f.read_text()) for f in run.folder.glob("*/run.json")] for run in runs]
        spent = lambda r: max(r["processor"], r["wall"] - r["phases"].get("waiting for the coupler", 0))
        share = min(max(r["phases"].get("diagnostics", 0) / spent(r) for r in some) for some in reports)
        found[case] = (share, most_of_static if is_static else most)
    text = ", ".join(f"{case} {100 * share:.1f} %" for case, (share, _) in found.items())
    return text, all(share <= limit for share, limit in found.values())


# -- classes
# ------------------------------------------------------------------------------------------------------------
def plain(text):
    """Comments, literals and preprocessor lines are blank."""
    blank = lambda match: re.sub(r"[^\n]", " ", match.group())
    return re.sub(r"^[ \t]*#[^\n]*", blank, LITERAL.sub(blank, text), flags=re.M)


def closing(text, begin):
    """Position of the brace that closes the one before `begin`."""
    depth = 1
    for brace in re.compile(r"[{}]").finditer(text, begin):
        depth += 1 if brace.group() == "{" else -1
        if depth == 0:
            return brace.start()
    return len(text)


def data_members(body):
    """Number of data members declared in the body of a class; those of nested classes count."""
    count, at = 0, 0
    while match := CLASS.search(body, at):
        end = closing(body, match.end())
        if not re.search(r"\benum\s+$", body[: match.start()]):
            count += data_members(body[match.end() : end])
        body = body[: match.start()] + "struct X " + body[end + 1 :]
        at = match.start() + 9
    while True:  # bodies of functions, initializers, arguments of templates
        shorter = re.sub(
            r"<[^<>;{}()]*>",
            "",
            re.sub(r"\{(?:[^{}]|\{\})*\}", "{}", body.replace("->", "").replace("operator<", "operator")),
        )
        shorter = re.sub(r"\{\}(?=\s*[,;])", "", re.sub(r"=[^,;{}()]*(?=[,;])", "", shorter))
        if shorter == body:
            break
        body = shorter
    for statement in re.split(r";|\{\}|\b(?:public|protected|private)\s*:", body):
        head = statement.strip()
        if (
            not head
            or "(" in head
            or re.match(
                (
                    r"(?:using|typedef|friend|static_assert|enum|template|static|constexpr|struct X$|class \w+$|struct"
                    r" \w+$)\b"
                ),
                head,
            )
        ):
            continue
        if re.search(r"[\w>*&]\s+[&*]?\w+", head):
            count += 1 + head.count(",")
    return count


def largest_class(job, most):
    """Classes and structs but those in files of parameters, which list the keys of a case."""
    found = {}
    for f, text in ((f, plain(text)) for f, text in texts(job).items() if "parameters" not in f):
        at = 0
        while match := CLASS.search(text, at):
            at = closing(text, match.end())
            if not re.search(r"\benum\s+$", text[: match.start()]):
                found[match[1]] = max(found.get(match[1], 0), data_members(text[match.end() : at]))
    over = sum(n > most for n in found.values())
    return f"{worst(found, 5)}; {over} of {len(found)} have more than {most}", not over


def mirrored(job, share):
    """tests/unit/mesh/order_test.cpp is the test of common/mesh/order.hpp, tests/unit/coupler/links_test.cpp that of
    coupler/links.hpp."""
    tests = {f for f in tracked(job, "tests/unit") if f.endswith("_test.cpp")}
    headers = [f for f in texts(job) if f.endswith(".hpp")]
    there = [h for h in headers if f"tests/unit/{h.removeprefix('common/').removesuffix('.hpp')}_test.cpp" in tests]
    return f"{len(there)} of {len(headers)}", len(there) >= share * len(headers)


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
    return (
        (
            f"{len({r['system'] for r in rows})} systems, {len(rows)} rows;"
            f" {text}{'; ' + '; '.join(lacking) if lacking else ''}"
        ),
        not lacking,
    )


def minutes(job, limit, *targets):
    """Processor minutes of compiler and linker from an empty folder, two jobs, no compiler cache."""
    folder = job.scratch / "metrics-build"
    shutil.rmtree(folder, ignore_errors=True)
    result = job.run(["cmake", "-G", "Ninja", "-S", job.root, "-B", folder], 600)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    if result.returncode == 0:
        result = job.run(
            ["env", "CCACHE_DISABLE=1", "ninja", "-C", folder, "-j", min(2, os.cpu_count()), *targets], 4 * 3600
        )
    if result.returncode != 0:
        raise RuntimeError((result.stderr or result.stdout)[-300:])
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime) / 60
    return f"{used:.1f} min", used <= limit
