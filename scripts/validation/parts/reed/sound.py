# SPDX-License-Identifier: Apache-2.0
"""Measures of the weakly compressible fluid: recorded by verification_fluid_sound and verification_fluid_gaps."""

SOUND = "verification_fluid_sound"


def ranks(job):
    tests, _ = job.gtest(SOUND)
    chosen = [t["passed"] for name, t in tests.items() if "checkpoint" in name or "number_of_ranks" in name]
    passed, total, _, _ = job.ctest(f"^{SOUND}_[23]$")
    return f"{sum(chosen)} of {len(chosen)} tests on one rank, {passed} of {total} on two and three", all(chosen) and passed == total == 2
