# SPDX-License-Identifier: Apache-2.0
"""Coupled runs that are stopped in the middle and continued on other numbers of ranks (tests/coupling/restart/ranks.py)."""
import re
import sys

from validation.job import Bar

CASES = {"flap": "flap", "tube": "3-D tube", "fsi1": "FSI1"}
TOLERANCE = 1e-5  # of the coupling's convergence


def lines(job, case):
    def make():
        script = job.root / "tests" / "coupling" / "restart" / "ranks.py"
        result = job.run([sys.executable, script, case, job.root / "configs", job.build / "bin"], 3600)
        if f"{case}: 3 to 1" not in result.stdout:
            raise RuntimeError(result.stdout[-1000:] + result.stderr[-1000:])
        return result.stdout
    return job.once(("restart", case), make)


def equal(case):
    def measure(job):
        found = {int(n): int(differ) for n, differ in re.findall(r": (\d) to \1: (\d+) tables differ", lines(job, case))}
        return "; ".join(f"{n} {'rank' if n == 1 else 'ranks'}: {d} tables differ" for n, d in found.items()), sorted(found) == [1, 2, 3] and not any(found.values())
    return measure


def other(case):
    def measure(job):
        found = re.findall(r": (\d) to (\d): apart by (\S+) .*?ranks by (\S+)", lines(job, case))
        text = ", ".join(f"{a} to {b}: {off}" for a, b, off, _ in found)
        return f"{text} of the largest value; uninterrupted runs on other ranks: {max(float(r) for *_, r in found):.2g}", len(found) == 4 and all(float(off) <= max(TOLERANCE, float(r)) for *_, off, r in found)
    return measure


COARSE = "six steps on coarse meshes; all fields of the last state"
CLOSER = {"fsi1": "; the coupling converges to 1e-7, as the velocities of the plate, which hardly moves yet, are compared too"}
BARS = [bar for case, name in CASES.items() for bar in (
    Bar(f"restart of the {name} on the same ranks, 1, 2, 3", "bit for bit", equal(case), long=True, but=COARSE + CLOSER.get(case, "")),
    Bar(f"restart of the {name} from 1 to 2, 3 and back", "within solver tolerance: 1e-5, the coupling's, or what runs that were never stopped are apart by on those ranks", other(case), long=True, but=COARSE + CLOSER.get(case, "")))]
