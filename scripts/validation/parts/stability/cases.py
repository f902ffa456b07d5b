# SPDX-License-Identifier: Apache-2.0
"""Bars of the hard cases: structures, under-resolved vortices, backflow, the tank over years; what the quick set takes."""
import re
import time

import numpy as np

from couplet import series
from validation.job import Bar
from validation.parts.trust.runs import gtests, script

TURNOVERS = 20
REYNOLDS = (1e2, 1e3, 1e4, 1e5, 1e6)
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


def bounded(reynolds):
    def measure(job):
        energy, code = vortices(job, reynolds)
        gain = float(np.max(energy[1:] / energy[:-1]) - 1) if len(energy) > 1 else float("nan")
        return (f"energy never grows by more than {max(gain, 0):.1e} a step, {energy[-1] / energy[0]:.3g} of it left at the end, exit code {code}",
                code == 0 and len(energy) > TURNOVERS and gain < 1e-3 and energy[-1] < energy[0])
    return measure


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


BARS = [
    Bar("every hard case has its test and its neighbour under tests/stability", "all", held),
    Bar("structure: short and long steps as tests: elastic Courant number 0.01 and 1000", "no growth; the neighbour (corrected gradient, undamped) grows",
        gtests("stability_solid_hard_cases", "of_a_hundredth_keep", "grow_with_the_trapezoidal", "of_a_thousand_do_not_grow"),
        but="4000 and 400 steps; 1e5 and 1e4 are the rows above"),
    Bar("structure: steps that jump by a factor of 100", "energy kept by four schemes; the neighbour (generalised-alpha) is ended by name",
        gtests("stability_solid_hard_cases", r"StepsThatJump\w+\.leave", r"StepsThatJump\w+\.make")),
    Bar("structure: cells of aspect 1000", "pulled and bent right, energy kept; the neighbours (other gradients in bending) are reported",
        gtests("stability_solid_hard_cases", "are_pulled_right", "bend_wrongly", "keep_the_energy_of_a_swing"),
        but="bending within 30 % on 16 cells of aspect 1000 along; the run flags it"),
    Bar("structure: stiffness that jumps by 1e6", "energy kept, stretched right; the neighbour (least-squares gradient, leaning cells) ends with its reason",
        gtests("stability_solid_hard_cases", "keeps_the_energy_of_a_swing", "thesiss_gradient_on_leaning", "two_springs")),
    Bar("structure: thermal shock, Fourier number of a cell 0.5 to 1000", "no oscillation; the neighbour (trapezoidal rule) is reported",
        gtests("stability_solid_hard_cases", "with_eulers_scheme", "three_point_scheme_overshoots", "and_that_is_told"),
        but="none with Euler's scheme; up to 2.5 % in the first steps with three-point, the default, at 1000"),
    *[Bar(f"fluid: under-resolved vortices of Taylor and Green, 32^3, Re {re_:.0e}, {TURNOVERS} turnovers", "bounded without added dissipation",
          bounded(re_), long=True, but="projection: incremental, which adds none; the default takes energy out of the finest scales")
      for re_ in REYNOLDS],
    Bar("fluid: the same vortices on a coarse eighth; steps beyond the limit", "bounded; refused by name",
        gtests("stability_fluid_under_resolved", "never_gain_energy", "beyond_the_limit")),
    Bar("fluid: backflow through an outlet", "bounded by the work of the pressure; the neighbour (no stabilisation) is not",
        gtests("stability_fluid_under_resolved", "stays_bounded_by_the_work", "goes_beyond_it_without")),
    Bar("tank: 10 years of hourly weather", "no drift: energy balance to 1e-9 of the heat moved, a year's discharge like the one before to 1e-3",
        script("tests/stability/thermocline/years.py", "{bin}", "{root}/configs", 10), long=True, but="100 cells of the bed; the day that differs most is reported, not judged"),
    Bar("tank: ratcheting over 3650 cycles", "between the active and the passive load, no drift",
        gtests("stability_thermocline", "equal_cycles", "scattered_cycles", "small_cycles")),
    Bar("quick tests of label stability", "all pass within 120 s on 2 cores", quick_set, long=True),
]
