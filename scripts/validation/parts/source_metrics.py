# SPDX-License-Identifier: Apache-2.0
"""Metrics of the sources, counted with regular expressions rather than a compiler: good to a few per cent, and the same
from one commit to the next. Every measure returns (what it found, whether the limit is met)."""
import collections
import json
import os
import re
import resource
import shutil
import subprocess

PROGRAMS = ("solid_solver", "fluid_solver", "mesh_mover", "thermocline", "plate_modal", "coupler")
HOUSE = ("common", *PROGRAMS)
LITERAL = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'(?!\w)', re.S)


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


def processor_minutes(job, command, seconds):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    result = job.run(command, seconds)
    if result.returncode != 0:
        raise RuntimeError((result.stderr or result.stdout)[-300:])
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime) / 60


def minutes(job, limit, *targets):
    """Processor minutes of compiler and linker from an empty folder, two jobs, no compiler cache."""
    folder = job.scratch / "metrics-build"
    shutil.rmtree(folder, ignore_errors=True)
    subprocess.run(["cmake", "-G", "Ninja", "-S", job.root, "-B", folder], check=True, capture_output=True)
    used = processor_minutes(
        job, ["env", "CCACHE_DISABLE=1", "ninja", "-C", folder, "-j", min(2, os.cpu_count()), *targets], 4 * 3600
    )
    return f"{used:.1f} min", used <= limit


# -- ideas ----------------------------------------------------------------------------------------------------------------
def keys_of_programs(job):
    """Returns {program: its keys}."""
    return {
        p: set(re.findall(r"^\| `([^`]+)`", job.run([job.build / "bin" / p, "--docs"]).stdout, re.M)) for p in PROGRAMS
    }


def keys(job, most):
    found = {p: len(k) for p, k in keys_of_programs(job).items()}
    return f"{sum(found.values())}: {worst(found)}", sum(found.values()) <= most


def unused_keys(job, most):
    """Keys of a program that no case sets."""
    there = {
        word
        for f in tracked(job, "configs")
        if f.endswith(".yaml")
        for word in re.findall(r"[\w-]+(?=\s*:)", (job.root / f).read_text())
    }
    found = {p: len([k for k in keys if k not in there]) for p, keys in keys_of_programs(job).items()}
    return f"{sum(found.values())}: {worst(found)}", sum(found.values()) <= most


def word_options(job, most):
    """Words that keys may have as values."""
    found = set()

    def walk(node, key, program):
        for name, value in (
            node.items() if isinstance(node, dict) else ((None, v) for v in node if isinstance(node, list))
        ):
            if name in ("enum", "const"):
                found.update(
                    (program, key, w) for w in (value if isinstance(value, list) else [value]) if isinstance(w, str)
                )
            elif name == "properties":
                for inner, schema in value.items():
                    walk(schema, inner, program)
            elif isinstance(value, (dict, list)):
                walk(value, key, program)

    for program in PROGRAMS:
        walk(json.loads(job.run([job.build / "bin" / program, "--schema"]).stdout), "", program)
    return f"{len(found)}", len(found) <= most


def estimators(job, most):
    """Those that the ablation switches off one by one."""
    switches = (job.root / "benchmarks/ablation.py").read_text().partition("SWITCHES = {")[2].partition("\n}")[0]
    found = collections.Counter()
    for program, names in re.findall(r'^    "(\w+)": \{(.*?)^    \},', switches, re.M | re.S):
        found[program] = len(re.findall(r'^        "[^"]+": \[', names, re.M))
    return f"{sum(found.values())}: {worst(found)}", sum(found.values()) <= most


def findings(job, most):
    n = (job.root / "common/diagnostics/ids.cpp").read_text().count("FindingId{")
    return f"{n}", n <= most


def virtuals(job, file, most):
    n = len(re.findall(r"\bvirtual (?!~)", (job.root / file).read_text()))
    return f"{n}", n <= most


def floors(job, program, most):
    """Longest chain of folders of a program that include from each other; folders that include in a circle are one."""
    below = collections.defaultdict(set)
    for f, text in texts(job).items():
        here = f.split("/")
        if here[0] == program and len(here) > 2:
            below[here[1]] |= {m for m in re.findall(rf'#include "{program}/(\w+)/', text) if m != here[1]}
    seen = {}

    def reach(folder):
        found, ahead = {folder}, [folder]
        while ahead:
            for other in below[ahead.pop()] - found:
                found.add(other), ahead.append(other)
        return found

    reached = {f: reach(f) for f in list(below)}

    def height(folder):
        if folder not in seen:
            seen[folder] = 1 + max((height(o) for o in reached[folder] if folder not in reached[o]), default=0)
        return seen[folder]

    circles = sorted(f for f in reached if any(o != f and f in reached[o] for o in reached[f]))
    n = max(map(height, reached))
    return f"{n} of {len(reached)} folders" + (f"; in a circle: {', '.join(circles)}" if circles else ""), n <= most


def classes(job, most, most_of_two_meanings):
    listing = job.run(
        [
            "ctags",
            "--languages=C++",
            "--c++-kinds=cs",
            "--fields=+s",
            "-x",
            "--_xformat=%N %F",
            *(job.root / f for f in texts(job)),
        ]
    ).stdout
    names = collections.Counter(line.split()[0] for line in listing.splitlines() if not line.startswith("__anon"))
    two = {n: k for n, k in names.items() if k > 1}
    return (
        f"{sum(names.values())} classes; {len(two)} names with more than one: {worst(two, 5)}",
        sum(names.values()) <= most and len(two) <= most_of_two_meanings,
    )


def macros(job, most):
    found = [f for f, text in texts(job).items() if re.search(r"^#\s*define\b", text, re.M)]
    return f"{len(found)} files: {', '.join(found)}", len(found) <= most


def mirrored(job, most):
    """tests/unit/mesh/order_test.cpp is the test of common/mesh/order.hpp, tests/unit/coupler/links_test.cpp that of coupler/links.hpp."""
    tests = {f for f in tracked(job, "tests/unit") if f.endswith("_test.cpp")}
    headers = [f for f in texts(job) if f.endswith(".hpp")]
    there = [h for h in headers if f"tests/unit/{h.removeprefix('common/').removesuffix('.hpp')}_test.cpp" in tests]
    return f"{len(there)} of {len(headers)}", len(there) >= most


def suite(job, limit):
    """Processor minutes of the short tests, which also includes those in which processes wait for each other by polling."""
    used = processor_minutes(job, ["ctest", "--test-dir", job.build, "-j", "2", "-LE", "long"], 2 * 3600)
    return f"{used:.1f} min", used <= limit
