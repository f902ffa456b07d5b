# SPDX-License-Identifier: Apache-2.0
"""Measures of solids that meet a seat: recorded by verification_solid_seat and verification_solid_bounce."""

SEAT, BOUNCE = "verification_solid_seat", "verification_solid_bounce"


def hertz(job):
    (width,), passed = job.recorded(SEAT, "of_hertz", "width_error_80")
    (peak,), _ = job.recorded(SEAT, "of_hertz", "peak_error_80")
    (face,), _ = job.recorded(SEAT, "of_hertz", "face_80")
    return (f"half width {100 * width:+.2f} % (a face there is {100 * face:.1f} % of it), largest pressure {100 * peak:+.2f} %",
            passed and abs(width) <= max(0.02, face) and abs(peak) <= 0.01)


def pressed(job):
    tests = [t for name, t in job.gtest(SEAT)[0].items() if "has_uniform_stress" in name]
    values = [float(v) for t in tests for key, v in t.items() if key.startswith("stress_")]
    passed = all(t["passed"] for t in tests)
    return f"{max(values):.1e} of the stress, on {len(values)} kinds of cells", passed and len(values) == 6 and max(values) <= 1e-7


def stiffness(job):
    (most,), passed = job.recorded(SEAT, "at_any_stiffness", "corrections")
    return f"at most {most:.0f} corrections, 1e9 to 1e18 N/m^3", passed


def column(job):
    (found,) = (t for name, t in job.gtest(BOUNCE)[0].items() if "two_travel_times" in name)
    duration, force, rebound = map(float, found["bar_100"].split())
    return (f"duration {duration:.4f}, pressure {force:.4f}, momentum {rebound:.4f} of the closed form, 100 cells",
            found["passed"] and max(abs(v - 1) for v in (duration, force, rebound)) <= 0.02)


def kept(job):
    (small,), passed = job.recorded(BOUNCE, "every_impact", "conserving")
    (other,), _ = job.recorded(BOUNCE, "every_impact", "midpoint")
    (large,), more = job.recorded(BOUNCE, "at_large_strain", "large_strain")
    return f"{small:.1e} at small, {large:.1e} at large strain; the midpoint rule beside it {other:.1f}", passed and more and max(small, large) <= 1e-6


def ranks(job):
    passed, total, _, _ = job.ctest(f"^({SEAT}|{BOUNCE})_[23]$")
    (same,), restarted = job.recorded(BOUNCE, "bit_for_bit", "same")
    return f"{passed} of {total} tests on two and three ranks; restarted in contact bit for bit: {'yes' if same else 'no'}", passed == total == 4 and restarted
