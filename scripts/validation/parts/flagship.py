# SPDX-License-Identifier: Apache-2.0
"""Measures of the first coupled job."""
import math
import re

from couplet.command.compare import apart, arrays


def fresh_clone(job, script, sign):
    clone = job.scratch / "clone"
    if not clone.exists():
        job.done(["git", "clone", "-q", job.root, clone])
    result = job.run([clone / "scripts" / script], timeout=7200)
    found = re.findall(sign, result.stdout)
    return (
        f"exit code {result.returncode}; {found[-1] if found else 'nothing found of its result'}",
        result.returncode == 0 and bool(found),
    )


def demo_time(job):
    got, met = fresh_clone(job, "demo", r"done in [\d.]+ s")
    seconds = re.search(r"done in ([\d.]+) s", got)
    picture = job.scratch / "clone/configs/perpendicular-flap/out/perpendicular-flap.png"
    there = picture.exists() and picture.stat().st_size > 10_000
    return f"{got}; picture {'written' if there else 'missing'}", bool(met and there and float(seconds[1]) < 180)


def ranks_agree(job):
    keys = (
        "simulation.end-time=0.2",
        "simulation.output.interval=0.2",
        "coupling.convergence.relative=1e-9",
        "coupling.convergence.max-iterations=100",
        "participants.fluid.pressure-tolerance=1e-12",
    )
    one, other = (arrays(job.case("perpendicular-flap", keys, ranks).folder) for ranks in ((1, 1, 1, 1), (1, 3, 2, 2)))
    gaps = {
        name: math.inf if odd else share
        for name, values in one.items()
        if name.endswith(("/displacement", "/velocity", "/pressure", "tip x [m]"))
        for _, share, _, odd in [apart(values, other[name])]
    }
    return (
        ", ".join(f"{name.split(': ')[1]} {gap:.1e}" for name, gap in gaps.items()),
        len(gaps) > 3 and max(gaps.values()) <= 1e-7,
    )
