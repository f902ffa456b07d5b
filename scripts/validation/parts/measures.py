# SPDX-License-Identifier: Apache-2.0
"""What bars that live in test executables are judged by. `pattern` chooses tests by name, `keys` (separated by spaces) the
numbers that they recorded; a test that did not pass is never a bar that is met."""
import re


def recorded(job, executable, pattern, keys):
    found = [job.recorded(executable, pattern, key) for key in keys.split()]
    return [v for values, _ in found for v in values], all(passed for _, passed in found)


def listed(values, text):
    return ", ".join(text.format(v) for v in values)


def at_most(executable, pattern, keys, limit, text="{:.1e}"):
    def measure(job):
        values, passed = recorded(job, executable, pattern, keys)
        shown = listed(values, text) if len(values) < 8 else f"{text.format(max(values))} at most of {len(values)}"
        return shown, passed and all(v <= limit for v in values)
    return measure


def at_least(executable, pattern, keys, limit, also="", text="{:.2f}"):
    """`also`: further keys, to be shown."""
    def measure(job):
        values, passed = recorded(job, executable, pattern, keys)
        more = (f" ({key.replace('_', ' ')} {listed(job.recorded(executable, pattern, key)[0], text)})" for key in also.split())
        return listed(values, text) + "".join(more), passed and all(v >= limit for v in values)
    return measure


def all_pass(executable, pattern, count=1):
    """All tests of that name, `count` of them or more."""
    def measure(job):
        tests, _ = job.gtest(executable)
        chosen = [v["passed"] for name, v in tests.items() if re.search(pattern, name)]
        return f"{sum(chosen)} of {len(chosen)} tests passed", len(chosen) >= count and all(chosen)
    return measure


def programs_pass(pattern, count):
    """Registered tests, such as one program on 1, 2 and 3 ranks; none may be skipped."""
    def measure(job):
        passed, total, skipped, _ = job.ctest(pattern)
        return f"{passed} of {total} test programs passed", total >= count and passed == total and not skipped
    return measure
