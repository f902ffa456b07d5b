# SPDX-License-Identifier: Apache-2.0
"""Samples of output in the documents beside what the commands say."""
import math
import re

NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
NOTHING = 1e-9  # below which a number is round-off


def is_said(line, said):
    """True if a line of a sample is in the output, with numbers within 2 %; "..." stands for anything."""
    wanted = [float(n) for n in NUMBER.findall(line)]
    pattern = ".*".join(f"({NUMBER.pattern})".join(map(re.escape, NUMBER.split(part))) for part in line.strip().split("..."))
    return any(all(math.isclose(float(a), b, rel_tol=0.02, abs_tol=NOTHING) for a, b in zip(m.groups(), wanted)) for m in re.finditer(pattern, said))
