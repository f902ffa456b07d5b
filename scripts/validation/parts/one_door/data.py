# SPDX-License-Identifier: Apache-2.0
"""Measures of "one door": binary foreign data (HDF5, checkpoints, messages of external programs)."""
from validation.parts.trust import house as trust_house


def fuzz(job, name, test, count):
    found, _ = job.fuzz(name, count)
    one = found[test]
    return (f"{one['tried']} tried, {one['refused']} refused, 0 crashes, slowest {one['slowest']} s, {one['megabytes']} MB",
            not one.get("failures") and int(one["tried"]) >= count)


def sanitized(job):
    """The same programs of the sanitizers' build, at full count."""
    lines, good = [], True
    for name, count in (("fuzz_hdf5", 2000), ("fuzz_messages", 5000)):
        words, folder = trust_house.sanitizer_test(job, name), job.scratch / f"asan-{name}"
        result = trust_house.watched(job, folder, [f"COUPLET_FUZZ_COUNT={count}", *words], 3 * 3600, cwd=job.scratch)
        found = trust_house.reports(folder)
        lines.append(f"{name}: {count} a test, code {result.returncode}, {len(found)} kinds of reports" + (f": {found[0]}" if found else ""))
        good = good and result.returncode == 0 and not found
    return "; ".join(lines), good
