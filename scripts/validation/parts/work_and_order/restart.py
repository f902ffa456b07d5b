# SPDX-License-Identifier: Apache-2.0
"""Coupled runs that are stopped in the middle and continued on other numbers of ranks (tests/coupling/restart/ranks.py)."""
import re
import sys

TOLERANCE = 1e-5  # of the coupling's convergence


def lines(job, case):
    def make():
        script = job.root / "tests" / "coupling" / "restart" / "ranks.py"
        result = job.run([sys.executable, script, case, job.root / "configs", job.build / "bin"], 3600)
        if f"{case}: 3 to 1" not in result.stdout:
            raise RuntimeError(result.stdout[-1000:] + result.stderr[-1000:])
        return result.stdout
    return job.once(("restart", case), make)


def equal(job, case):
    found = {int(n): int(differ) for n, differ in re.findall(r": (\d) to \1: (\d+) tables differ", lines(job, case))}
    return "; ".join(f"{n} {'rank' if n == 1 else 'ranks'}: {d} tables differ" for n, d in found.items()), sorted(found) == [1, 2, 3] and not any(found.values())


def other(job, case):
    found = re.findall(r": (\d) to (\d): apart by (\S+) .*?ranks by (\S+)", lines(job, case))
    text = ", ".join(f"{a} to {b}: {off}" for a, b, off, _ in found)
    return f"{text} of the largest value; uninterrupted runs on other ranks: {max(float(r) for *_, r in found):.2g}", len(found) == 4 and all(float(off) <= max(TOLERANCE, float(r)) for *_, off, r in found)
