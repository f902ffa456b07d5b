# SPDX-License-Identifier: Apache-2.0
"""Measures of heat conduction and thermal strain."""


def wedge_stress(job):
    errors, passed = job.recorded("verification_heat_stress", "Wedge", "stress_error")
    slope, _ = job.recorded("verification_heat_stress", "Wedge", "stress_slope")
    return (f"error {max(errors):.1e} with 40 cells, slopes " + ", ".join(f"{s:.2f}" for s in slope),
            passed and max(errors) <= 0.01 and min(slope) >= 0.95)
