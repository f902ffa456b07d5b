# SPDX-License-Identifier: Apache-2.0
"""Measures of the weakly compressible fluid: recorded by verification_fluid_sound and verification_fluid_gaps."""

SOUND, GAPS = "verification_fluid_sound", "verification_fluid_gaps"


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
