# SPDX-License-Identifier: Apache-2.0
"""Measures of the one coupler: added mass, acceleration, mapping."""
import json
import re
import sys

import couplet
from validation.parts.main_job import FLAP, steps_of

RAMP = ["participants.fluid.boundaries.inlet.ramp=0.4"]
LIGHT = [*RAMP, "participants.solid.material.density=1", "simulation.output.interval=1", "simulation.checkpoint.interval=10"]


def tip(folder):
    probes = couplet.read_csv(folder / "solid" / "probes.csv")
    return probes["time [s]"], probes["tip x [m]"]


# -- added mass: two analytic participants, 40 modes ------------------------------------------------------------------
def added_mass(job, test, keys):
    """Recorded properties of one test: {key: text} and whether it passed."""
    tests, _ = job.gtest("coupling_added_mass")
    found = next(v for k, v in tests.items() if test in k)
    return {k: v for k, v in found.items() if re.match(keys, k)}, found["passed"]


def explicit_growth(job):
    found, passed = added_mass(job, "grows_by_the_mass_ratio", "growth_")
    off = [abs(float(v) * float(k.split("_")[1]) - 1) for k, v in found.items()]
    return f"{100 * max(off):.2f} % off at most, {len(off)} runs", passed and len(off) >= 4 and max(off) <= 0.02


def explicit_bounded(job):
    found, passed = added_mass(job, "is_bounded_below", "amplitude_")
    return ", ".join(f"{k.split('_')[1]}: {v}" for k, v in found.items()) + " of the bound", passed and len(found) == 2


def contraction(job):
    found, passed = added_mass(job, "plain_iteration_contracts", "contraction_")
    off = [abs(float(v) / float(k.split("_")[1]) - 1) for k, v in found.items()]
    return f"{100 * max(off):.3f} % off at most", passed and max(off) <= 0.02


def iterations(job, method, most):
    found, _ = added_mass(job, "iterations_of", method + "_")
    numbers = {float(k.split("_")[1]): v.split() for k, v in found.items()}
    met = all(int(numbers[r][1]) <= bound for r, bound in zip((0.5, 5, 50), most))
    return "; ".join(f"r {r:g}: {numbers[r][1]} at most, {numbers[r][0]} on average" for r in sorted(numbers)), met


def very_light(job):
    found, passed = added_mass(job, "holds_at_a_hundredth", "ils_100")
    mean, most = found["ils_100"].split()
    return f"{most} at most, {mean} on average", passed and int(most) <= 30


# -- added mass: the finite-volume fluid under an elastic wall ---------------------------------------------------------
def string(job, pattern, wanted):
    """Numbers of tests/coupling/string/string.py by their claim; met if that many were found and none failed."""
    def make():
        file = job.scratch / "string.json"
        job.run([sys.executable, job.root / "tests/coupling/string/string.py", job.build / "bin", job.build / "bin/tests", file], 3600)
        return json.loads(file.read_text())
    result = job.once("string", make)
    found = {k: v for k, v in result["numbers"].items() if re.search(pattern, k)}
    return "; ".join(f"{k}: {v:.5g}" for k, v in found.items()), len(found) >= wanted and not set(found) & set(result["failed"])


# -- acceleration on the flap -----------------------------------------------------------------------------------------
def light_flap(job, scheme, kind, end=0.6):
    return job.coupled(job.root / FLAP, f"flap-light-{scheme}-{kind}", [
        *LIGHT, f"simulation.end-time={end}", f"coupling.scheme={scheme}", f"coupling.acceleration.type={kind}",
        "coupling.acceleration.initial-relaxation=0.2"])


def light_iterations(job):
    steps = steps_of(light_flap(job, "implicit", "iqn-ils"))
    mean = steps[:, 0].mean()
    return f"{mean:.2f} on average, {steps[:, 0].max():.0f} at most, {len(steps)} steps", bool(mean <= 4 and len(steps) >= 60)


def light_aitken(job):
    steps = steps_of(light_flap(job, "implicit", "aitken"))
    a, b = (tip(light_flap(job, "implicit", kind))[1][-1] for kind in ("aitken", "iqn-ils"))
    return f"{steps[:, 0].mean():.2f} on average; tips {abs(a / b - 1):.1e} apart", None


# -- mapping ----------------------------------------------------------------------------------------------------------
def finer_solid(job, factor, kind, shift=0.0):
    """The flap with `factor` of the solid's faces along one of the fluid's, to the first maximum."""
    geo = (job.root / "configs/perpendicular-flap/solid.geo").read_text()
    side, across = {2: (160, 16), 3: (240, 24), 1: (80, 8)}[factor]
    if shift:
        side, across = 147, 15
    geo = re.sub(r"n_side = \d+;", f"n_side = {side};", re.sub(r"n_tip = \d+;", f"n_tip = {across};", geo))
    mesh = job.scratch / f"solid-{side}.geo"
    mesh.write_text(geo)
    return job.coupled(job.root / FLAP, f"flap-{side}-{kind}", [
        "simulation.end-time=0.8", "simulation.output.interval=1", "simulation.checkpoint.interval=10",
        f"participants.solid.mesh={mesh}", f"coupling.mapping.type={kind}"])


def non_matching(job, factor, shift=0.0):
    wanted = max(tip(finer_solid(job, 2, "nearest"))[1])
    gaps = {kind: max(tip(finer_solid(job, factor, kind, shift))[1]) / wanted - 1 for kind in ("projection", "rbf")}
    return ", ".join(f"{kind} {100 * gap:+.2f} %" for kind, gap in gaps.items()), all(abs(g) <= 0.01 for g in gaps.values())
