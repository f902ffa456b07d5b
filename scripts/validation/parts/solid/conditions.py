# SPDX-License-Identifier: Apache-2.0
"""Measures of the solid's boundary conditions, materials and bad input, and its orders of accuracy: test executables."""
import re


def wrong_input(job):
    passed, total, _, output = job.ctest("^wrong_configurations|cli_wrong")
    found = re.findall(r"(\d+) wrong configurations|^(\d+) of \d+", output, flags=re.M)
    return f"{passed} of {total} test programs passed" + (f", {max(found[-1])} configurations" if found else ""), (
        total > 0 and passed == total)
