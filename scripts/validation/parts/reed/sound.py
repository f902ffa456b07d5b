# SPDX-License-Identifier: Apache-2.0
"""Bars of the weakly compressible fluid: recorded by verification_fluid_sound and verification_fluid_gaps."""
import dataclasses

from validation.job import Bar

SOUND, GAPS = "verification_fluid_sound", "verification_fluid_gaps"


def at_most(limit, test, key, program=SOUND, unit="%", what=""):
    """The largest of the recorded errors against a limit, both as numbers; shown in percent or as they are."""
    def measure(job):
        values, passed = job.recorded(program, test, key)
        worst = max(abs(v) for v in values)
        text = f"{100 * worst:.3f} %" if unit == "%" else f"{worst:.1e}"
        return text + what, passed and worst <= limit
    return measure


def order(job):
    (value,), passed = job.recorded(SOUND, "order_two", "order")
    return f"{value:.2f}", passed and value >= 1.9


def bounded(job):
    tests, _ = job.gtest(SOUND)
    chosen = {name: test for name, test in tests.items() if "ten_thousand" in name}
    return f"{sum(t['passed'] for t in chosen.values())} of {len(chosen)} rules in time", len(chosen) == 2 and all(
        t["passed"] for t in chosen.values())


def closed_valve(job):
    errors, passed = zip(*(job.recorded(GAPS, "before_a_closed_valve", f"rise_error_{c}") for c in (30, 340)))
    return ", ".join(f"{100 * e:+.2f} %" for (e,) in errors), all(passed) and all(abs(e) <= 0.01 for (e,) in errors)


def small_mach(job):
    (change,), passed = job.recorded(SOUND, "small_mach", "change")
    (slope,), _ = job.recorded(SOUND, "small_mach", "slope")
    return f"{change:.1e} m/s beside 1 m/s, slope {slope:.3f}", passed and change <= 1e-6 and abs(slope - 2) <= 0.1


def ranks(job):
    tests, _ = job.gtest(SOUND)
    chosen = [t["passed"] for name, t in tests.items() if "checkpoint" in name or "number_of_ranks" in name]
    passed, total, _, _ = job.ctest(f"^{SOUND}_[23]$")
    return f"{sum(chosen)} of {len(chosen)} tests on one rank, {passed} of {total} on two and three", all(chosen) and passed == total == 2


THREE = "speed_of_sound_and_leaves/three_level"
SOUND_BARS = [
    Bar("acoustics: speed of a pulse of half width 0.2 ms at 5 us", "within 0.2 %", at_most(0.002, THREE, "speed_error_5us")),
    Bar("acoustics: order in time of that speed between 5 and 2.5 us", ">= 1.9", order),
    Bar("acoustics: 10 000 steps at acoustic Courant numbers 1, 10, 100", "bounded", bounded),
    Bar("acoustics: reflection of an absorbing outlet at 5 us", "< 0.1 %", at_most(0.001, THREE, "reflection_5us"),
        but="mean-time 1 s: by default, ten times the travel time of sound, the mean's filter reflects 0.6 % of this pulse"),
    Bar("acoustics: three modes of a quarter wave", "within 0.2 %", at_most(0.002, "open_at_one_end", "period_error")),
    Bar("acoustics: three modes of a Helmholtz resonator, both rules", "within 0.2 %", at_most(0.002, "as_a_resonator", "period_error")),
    Bar("acoustics: change of u against the incompressible run at Mach 1e-4", "<= 1e-6, with the square of the Mach number", small_mach),
    Bar("acoustics: uniform flow on a moving mesh", "to 1e-12", at_most(1e-12, "uniform_flow_on", "uniform_flow", unit="")),
    Bar("acoustics: piston in a closed cylinder against rho c^2 ln(V_0/V)", "within 0.2 %", at_most(0.002, "piston", "piston_error")),
    Bar("acoustics: a valve closed under a fixed inflow, rise by rho c^2 q/V at c = 30 and 340 m/s", "within 1 %",
        closed_valve),
    Bar("acoustics: ranks 1, 2, 3 and checkpoints", "the same; bit for bit", ranks),
]
SOURCES = ("common/base", "common/parallel", "common/linalg", "common/mesh", "common/fv", "fluid_solver", "tests/verification/fluid")
SOUND_BARS = [dataclasses.replace(bar, sources=SOURCES) for bar in SOUND_BARS]
