# SPDX-License-Identifier: Apache-2.0
"""Measures of the hard cases: structures, under-resolved vortices, backflow, the tank over years; what the quick set takes."""
import re
import time

import numpy as np

from couplet import series

TURNOVERS = 20
PERIODIC = (("left", "right"), ("front", "back"), ("bottom", "top"))


def vortices(job, reynolds):
    """Kinetic energy of the vortices of Taylor and Green on 32^3 hexahedra, by step, and the exit code."""
    def make():
        folder = job.scratch / f"vortices-{reynolds:.0e}"
        folder.mkdir()
        sides = ", ".join(f"{a}: {{type: periodic, partner: {b}}}" for pair in PERIODIC for a, b in (pair, pair[::-1]))
        (folder / "case.yaml").write_text(
            f"simulation: {{end-time: {TURNOVERS}, time-step: 0.1, output: {{folder: out, interval: {TURNOVERS}}}}}\n"
            f"participants: {{fluid: {{program: fluid_solver, mesh: {job.root / 'configs/taylor-green-3d/box.geo'}, mesh-parameters: {{n: 32}}, "
            f"dimension: 3, density: 1, viscosity: {1 / reynolds:g}, projection: incremental, pressure-tolerance: 1e-4, "
            "initial-velocity: ['sin(x)*cos(y)*cos(z)', '-cos(x)*sin(y)*cos(z)', 0], output: {energy-budget: true}, "
            f"boundaries: {{{sides}}}}}}}\n")
        result = job.run([job.build / "bin/fluid_solver", "case.yaml"], 3600, cwd=folder)
        file = folder / "out/fluid/energy.csv"
        return (series.read_csv(file)["kinetic energy [J]"] if file.exists() else np.array([np.nan])), result.returncode
    return job.once(("vortices", reynolds), make)


def bounded(job, reynolds):
    energy, code = vortices(job, reynolds)
    gain = float(np.max(energy[1:] / energy[:-1]) - 1) if len(energy) > 1 else float("nan")
    return (f"energy never grows by more than {max(gain, 0):.1e} a step, {energy[-1] / energy[0]:.3g} of it left at the end, exit code {code}",
            code == 0 and len(energy) > TURNOVERS and gain < 1e-3 and energy[-1] < energy[0])


def quick_set(job):
    """Wall time of the tests of label stability that are not long."""
    start = time.monotonic()
    result = job.run(["ctest", "--test-dir", job.build, "-L", "stability", "-LE", "long", "-j", 2], 1800)
    seconds = time.monotonic() - start
    sums = re.search(r"(\d+)% tests passed, (\d+) tests failed out of (\d+)", result.stdout)
    return f"{sums[3]} tests, {sums[2]} failed, {seconds:.0f} s", int(sums[2]) == 0 and seconds <= 120


def held(job):
    """The table of hard cases in docs/stability.md."""
    from couplet.atlas import cases
    lost = cases.missing(job.root)
    return f"{len(cases.CASES)} cases, {sum(bool(c.fails) for c in cases.CASES)} with a failing neighbour" + (f"; not there: {', '.join(lost)}" if lost else ""), not lost
