# SPDX-License-Identifier: Apache-2.0
"""Bars of heat conduction and thermal strain."""
from validation.job import Bar
from validation.parts.measures import at_least, at_most, programs_pass


def wedge_stress(job):
    errors, passed = job.recorded("verification_heat_stress", "Wedge", "stress_error")
    slope, _ = job.recorded("verification_heat_stress", "Wedge", "stress_slope")
    return (f"error {max(errors):.1e} with 40 cells, slopes " + ", ".join(f"{s:.2f}" for s in slope),
            passed and max(errors) <= 0.01 and min(slope) >= 0.95)


EXACT, ORDER, SERIES, STRAIN, STRESS = (f"verification_heat_{n}" for n in
                                        ("exactness", "order", "series", "strain", "stress"))
BARS = [
    Bar("heat: linear temperature under temperature, flux, convection, 6 cell types", "exact to 1e-10",
        at_most(EXACT, "linear_temperature_is_exact", "relative_error", 1e-10)),
    Bar("heat: order in space, hex, tet, prism, mixed, perturbed, 2-D", ">= 1.9", at_least(ORDER, "OrderInSpace", "slope", 1.9)),
    Bar("heat: order in time, Euler", ">= 0.95", at_least(ORDER, r"OrderInTime.*/euler", "slope", 0.95)),
    Bar("heat: order in time, three-point and trapezoidal, constant and varying steps", ">= 1.9",
        at_least(ORDER, r"OrderInTime.*/(three|trap)", "slope", 1.9)),
    Bar("heat: slab heated suddenly against erfc", "<= 1e-3 of the jump", at_most(SERIES, "error_function", "error", 1e-3)),
    Bar("heat: slab cooled by convection against its series", "<= 1e-3, second order",
        at_most(SERIES, "Slab.cooled", "error_1 error_2", 1e-3)),
    Bar("heat: sphere cooled by convection (Bi = 1) against its series", "<= 2e-3, second order",
        at_most(SERIES, "Sphere", "error", 2e-3)),
    Bar("heat: flux through layers of three materials", "exact to 1e-10",
        at_most(EXACT, "flux_through_layers", "relative_error_0 relative_error_2", 1e-10)),
    Bar("heat: 1, 2, 3 ranks", "agree to 1e-8", programs_pass("^verification_heat_(exactness|strain)", 6)),
    Bar("thermal strain: free body at uniform temperature, 6 cell types", "no stress to 1e-10",
        at_most(STRAIN, "grows_without_stress", "relative_error", 1e-10)),
    Bar("thermal strain: bar held at both ends", "- E alpha dT to 1e-10",
        at_most(STRAIN, "held_at_both_ends", "relative_error", 1e-10)),
    Bar("thermal strain: two materials held all around, 6 cell types", "one traction to 1e-10",
        at_most(STRAIN, "two_materials", "relative_error", 1e-10)),
    Bar("thermal strain: alpha(T) integrated", "exact to 1e-10",
        at_most(STRAIN, "coefficient_is_integrated", "relative_error", 1e-10)),
    Bar("temperature-dependent E and nu: pulled bar that gets warmer, 6 cell types", "exact to 1e-9",
        at_most(STRAIN, "constants_follow", "relative_error", 1e-9)),
    Bar("thermoelastic coupling: temperature of an isolated stretched or compressed bar", "closed form to 1e-3",
        at_most(STRAIN, "ThermoelasticCoupling", "relative_error", 1e-3)),
    Bar("thermal stress: hollow cylinder as a wedge, temperature prescribed and solved", "<= 1 %, slope >= 0.95",
        wedge_stress),
    Bar("thermal stress: its displacement", "slope >= 1.9", at_least(STRESS, "Wedge", "displacement_slope", 1.9)),
]
