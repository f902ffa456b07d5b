# SPDX-License-Identifier: Apache-2.0
"""Broken files, the sanitizers' build, and mutants."""
import os
import pathlib
import re
import shutil


# -- sanitizers -------------------------------------------------------------------------------------------------------
def sanitizer_build(job):
    folder = pathlib.Path(os.environ.get("COUPLET_ASAN_BUILD", job.root / "build-asan"))
    if not folder.exists():
        raise FileNotFoundError(
            "there is no build of the preset asan: build-asan, or the folder that COUPLET_ASAN_BUILD names"
        )
    return folder


def reports(folder):
    """First lines of what the sanitizers wrote to a folder."""
    found = [
        next(
            (
                line
                for line in f.read_text(errors="replace").splitlines()
                if "ERROR: AddressSanitizer" in line or "runtime error:" in line
            ),
            f.name,
        )
        for f in folder.glob("report*")
        if f.stat().st_size
    ]
    return sorted(set(found))


def watched(job, folder, command, seconds, **more):
    """Runs a command of the sanitizers' build. They write to files: a test that passes shows no output, and one that
    expects a program to fail would take a report for that. Signals are left to the tests' strikes; limits of the
    fuzzers' clock are ten times as wide, and what is freed is kept for 16 MB only: it counts as memory."""
    folder.mkdir(parents=True, exist_ok=True)
    to = f"log_path={folder}/report"
    return job.run(
        [
            "env",
            f"ASAN_OPTIONS=detect_leaks=0:handle_segv=0:quarantine_size_mb=16:{to}",
            f"UBSAN_OPTIONS=print_stacktrace=1:{to}",
            "COUPLET_FUZZ_SECONDS=100",
            *command,
        ],
        seconds,
        **more,
    )


def sanitized(job):
    """Once more, alone, what failed: tests that hold a clock lose it where everything takes several times as long. A
    suite whose log is newer than all programs is not run again, only what failed in it."""
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
    return (
        f"{passed} of {passed + failed} tests pass"
        + (f", {failed - len(lost)} of the other {failed} alone" if failed else "")
        + f", {len(found)} kinds of reports of the sanitizers"
        + (f" (lost: {', '.join(lost[:4])})" if lost else "")
        + (f": {'; '.join(found[:3])}" if found else "")
    ), not lost and passed > 200 and not found


# -- mutants ----------------------------------------------------------------------------------------------------------
def campaign(job):
    """Continues in the build's folder `mutants`, or the one that COUPLET_MUTANTS names (a whole run takes hours of one
    core)."""
    copy = pathlib.Path(os.environ.get("COUPLET_MUTANTS", job.build / "mutants"))
    result = job.run(
        ["/usr/bin/python3", job.root / "tests/mutants/campaign.py", job.root, copy, copy.with_suffix(".jsonl")], 100000
    )
    return (result.stdout.strip() or result.stderr.strip()).splitlines()[-1], result.returncode == 0
