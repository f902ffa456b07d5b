# SPDX-License-Identifier: Apache-2.0
"""Measures of the house: formatting, READMEs, namespaces, presets, what the demo builds, clang-tidy, the sanitizer build."""
import collections
import json
import os
import pathlib
import re
import shutil

MOST_LINES = 40  # of a README
PROGRAMS = ("coupler", "fluid_solver", "solid_solver", "mesh_mover")
SANITIZER = "a build of the preset asan: build-asan, or the folder that COUPLET_ASAN_BUILD names"


def rooms(root):
    """Folders with sources of the programs, without tests."""
    homes = {path.parent for path in root.glob("*/*.cpp")} - {root / "tests"}
    return sorted(homes | {path.parent for home in (*homes, root / "common") for path in home.rglob("*.hpp")})


def formatting(job):
    text = (job.root / ".clang-format").read_text()
    off = [key for key in ("ReflowComments", "BreakStringLiterals") if re.search(rf"^{key}: false$", text, re.M)]
    passed, total, _, _ = job.ctest("^architecture_includes")
    return f"{' and '.join(off) or 'none'} off, {passed} of {total} tests of the format pass", len(off) == 2 and passed == total == 1


def readmes(job):
    lines = {room.relative_to(job.root): len((room / "README.md").read_text().splitlines()) if (room / "README.md").exists() else 0
             for room in rooms(job.root) if room.parts[-1] not in ("build", "benchmarks")}
    lacking = [str(room) for room, n in lines.items() if n == 0]
    long = [f"{room} {n}" for room, n in lines.items() if n > MOST_LINES]
    return (f"{len(lines) - len(lacking)} of {len(lines)} rooms have one{': not ' + ', '.join(lacking) if lacking else ''}; "
            f"longer: {', '.join(long) or 'none'}"), not lacking and not long


def namespaces(job):
    """Outer namespaces of the headers; those of a file's own details (couplet::x within couplet) are part of it."""
    mixed = []
    for room in rooms(job.root):
        found = collections.Counter()
        for header in room.glob("*.hpp"):
            # What only declares a class of another folder puts nothing there.
            text = re.sub(r"^namespace [\w:]+ \{\s*(?:(?:template <[^;{}]*> )?(?:class|struct|enum class) \w+;\s*)+\}", "", header.read_text(), flags=re.M)
            found.update(re.findall(r"^namespace (\w+(?:::\w+)*) \{", text, re.M))
        homes = {name for name in found if not any(name.startswith(other + "::") for other in found if other != name)}
        if len({home for home in homes if home.startswith("couplet")}) > 1:
            mixed.append(f"{room.relative_to(job.root)} {sorted(homes)}")
    return f"{len(mixed)} rooms mix them{': ' + ', '.join(mixed) if mixed else ''}", not mixed


def demo(job):
    text = (job.root / "scripts/demo").read_text()
    count = lambda *targets: len(job.run(["ninja", "-C", job.build, "-t", "commands", *targets]).stdout.splitlines())
    part, whole = count(*PROGRAMS), count("all")
    named = re.search(r"^scripts/build release (.+)$", text, re.M)
    return f"{part} of {whole} steps", bool(named) and set(named[1].split()) == set(PROGRAMS) and 0 < part < 0.6 * whole


def presets(job):
    made = json.loads((job.root / "CMakePresets.json").read_text())
    return ", ".join(p["name"] for p in made["configurePresets"]), all(
        any(p["name"] == "fast" for p in made[kind]) for kind in ("configurePresets", "buildPresets", "testPresets"))


def tidy(job):
    result = job.run([job.root / "scripts/tidy", "common/base/text.cpp"], 600, cwd=job.root)
    return f"exit code {result.returncode} on one source", result.returncode == 0


def documented(job):
    text = (job.root / "docs/quickstart.md").read_text()
    return "docs/quickstart.md, 'A case is code'", "## A case is code" in text and "--allow-commands" in text


def sanitizer_folder(job):
    return pathlib.Path(os.environ.get("COUPLET_ASAN_BUILD", job.root / "build-asan"))


def sanitizer_build(job):
    folder = sanitizer_folder(job)
    if not (folder / "bin/fluid_solver").exists():
        raise FileNotFoundError(f"there is no {SANITIZER}")
    return folder


def sanitizer_test(job, name):
    """The words that run a test of the sanitizers' build, of which no more than that needs to be built."""
    build = sanitizer_folder(job)
    if not build.exists():
        raise FileNotFoundError(f"there is no {SANITIZER}")
    return type(job)(job.root, build, job.quick).test(name)


def reports(folder):
    """First lines of what the sanitizers wrote to a folder."""
    found = [next((line for line in f.read_text(errors="replace").splitlines() if "ERROR: AddressSanitizer" in line or "runtime error:" in line), f.name)
             for f in folder.glob("report*") if f.stat().st_size]
    return sorted(set(found))


def watched(job, folder, command, seconds, **more):
    """Runs a command of the sanitizers' build. They write to files: a test that passes shows no output, and one that expects a program
    to fail would take a report for that. Signals are left to the tests' strikes; limits of the fuzzers' clock are ten times as wide, and
    what is freed is kept for 16 MB only: it counts as memory."""
    folder.mkdir(parents=True, exist_ok=True)
    to = f"log_path={folder}/report"
    return job.run(["env", f"ASAN_OPTIONS=detect_leaks=0:handle_segv=0:quarantine_size_mb=16:{to}", f"UBSAN_OPTIONS=print_stacktrace=1:{to}", "COUPLET_FUZZ_SECONDS=100",
                    *command], seconds, **more)


def sanitized(job):
    """Once more, alone, what failed: tests that hold a clock lose it where everything takes several times as long. A suite whose log is
    newer than all programs is not run again, only what failed in it."""
    build = sanitizer_build(job)
    log, to = build / "suite.log", build / "reports"
    programs = [p for p in build.rglob("*") if p.is_file() and os.access(p, os.X_OK) and not p.suffix]
    suite = ["ctest", "--test-dir", build, "-LE", "long", "--output-on-failure"]
    if not log.exists() or log.stat().st_mtime < max(p.stat().st_mtime for p in programs):
        shutil.rmtree(to, ignore_errors=True)
        watched(job, to, [*suite, "-j", os.cpu_count()], 4 * 3600)
        shutil.copy(build / "Testing/Temporary/LastTest.log", log)
    text = log.read_text(errors="replace")
    passed, failed = (len(re.findall(rf"^Test {word}\.", text, re.M)) for word in ("Passed", "Failed"))
    lost = []
    if failed:
        again = watched(job, to, [*suite, "--rerun-failed"], 4 * 3600)
        lost = re.findall(r"\d+ - (\S+) \((?:Failed|Timeout|Not Run|SEGFAULT)", again.stdout)
    found = reports(to)
    return (f"{passed} of {passed + failed} tests pass" + (f", {failed - len(lost)} of the other {failed} alone" if failed else "")
            + f", {len(found)} kinds of reports of the sanitizers"
            + (f" (lost: {', '.join(lost[:4])})" if lost else "") + (f": {'; '.join(found[:3])}" if found else "")), not lost and passed > 200 and not found


CORPORA = {"fuzz_meshes": 10000, "fuzz_checkpoints": 2000,
           **{f"fuzz_yaml_{p}": 4000 for p in ("solid_solver", "fluid_solver", "mesh_mover", "thermocline", "coupler")}}


def corpora(job):
    """Whole fuzzers with the sanitizers on."""
    failed = []
    for name, count in CORPORA.items():
        result = watched(job, job.scratch / name, [f"COUPLET_FUZZ_COUNT={count}", *sanitizer_test(job, name)], 3 * 3600, cwd=job.scratch)
        found = reports(job.scratch / name)
        if result.returncode != 0 or found:
            failed.append(" ".join([name, *found[:1]]))
    return (f"{len(CORPORA) - len(failed)} of {len(CORPORA)} corpora clean, {sum(CORPORA.values())} inputs" + (f": not {', '.join(failed)}" if failed else ""),
            not failed)
