# SPDX-License-Identifier: Apache-2.0
"""Bars of "one door": binary foreign data (HDF5, checkpoints, messages of external programs)."""
import json
import os

from validation.job import Bar
from validation.parts.trust import house as trust_house
from validation.parts.trust.runs import gtests, tests


def cases(job, name, count):
    """All tests of a fuzz program at `count` cases each, and whether it ended well."""
    def make():
        program = next(p for p in (job.build / "tests").rglob(name) if p.is_file() and os.access(p, os.X_OK))
        file = job.scratch / f"{name}-all.json"
        result = job.run(["env", f"COUPLET_FUZZ_COUNT={count}", program, f"--gtest_output=json:{file}"], 3600, cwd=job.scratch)
        if not file.exists():
            raise RuntimeError(f"{name} ended with code {result.returncode}: {result.stdout[-200:]}")
        found = {t["name"]: t for suite in json.loads(file.read_text())["testsuites"] for t in suite["testsuite"]}
        return found, result.returncode == 0
    return job.once(("fuzz-all", name, count), make)


def fuzz(name, test, count):
    def measure(job):
        found, _ = cases(job, name, count)
        one = found[test]
        apart = f", {one['crashed_apart']} crashed in the rehearsal and were refused" if "crashed_apart" in one else ""
        return (f"{one['tried']} tried, {one['refused']} refused{apart}, 0 crashes, slowest {one['slowest']} s, {one['megabytes']} MB",
                not one.get("failures") and int(one["tried"]) >= count)
    return measure


def sanitized(job):
    """The same programs of the sanitizers' build, at full count."""
    lines, good = [], True
    for name, count in (("fuzz_hdf5", 2000), ("fuzz_messages", 5000)):
        program, folder = trust_house.sanitizer_test(job, name), job.scratch / f"asan-{name}"
        result = trust_house.watched(job, folder, [f"COUPLET_FUZZ_COUNT={count}", program], 3 * 3600, cwd=job.scratch)
        found = trust_house.reports(folder)
        lines.append(f"{name}: {count} a test, code {result.returncode}, {len(found)} kinds of reports" + (f": {found[0]}" if found else ""))
        good = good and result.returncode == 0 and not found
    return "; ".join(lines), good


BARS = [
    Bar("2 000 crafted modes.h5 (rank, type, size, storage, links, strings, bytes): no crash, no file outside, 1 GB, 5 s", "refused or sound",
        fuzz("fuzz_hdf5", "modes_are_refused_or_sound", 2000)),
    Bar("2 000 crafted checkpoints whose checksums and digests fit: the same", "refused or sound",
        fuzz("fuzz_hdf5", "checkpoints_with_digests_that_fit_are_refused_or_sound", 2000)),
    Bar("each fault of a modes.h5 has its sentence: file, object, what was found, what was expected", "test passes",
        gtests("fuzz_hdf5", "each_fault_has_its_sentence")),
    Bar("the scenes of modes.h5 and checkpoints through plate_modal: --check finds them, the run refuses them", "all scenes",
        tests("^cli_foreign_data$")),
    Bar("5 000 byte streams of external programs: handshake, introduction, replies, places, commands: no crash, 1 GB, 5 s", "refused or sound",
        fuzz("fuzz_messages", "are_refused_or_sound", 5000)),
    Bar("an external program of another version, and other ways to break the protocol, in a real job: named, code 1 or 2, no process left", "all",
        tests("^client_odd_guests_full$")),
    Bar("no second reader of HDF5, messages or roll call (tests/architecture)", "tests pass", tests("^architecture_", 2)),
    Bar("the same crafted files and bytes under sanitizers (preset asan)", "clean",
        sanitized, long=True, but="what the rehearsal's forked process does is judged by its outcome, not by the sanitizers' reports"),
]
