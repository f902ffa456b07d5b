# SPDX-License-Identifier: Apache-2.0
"""Measures of blocked layers that a moving mesh carries through a seat: recorded by verification_fluid_seat_layer."""

PROGRAM, TEST = "verification_fluid_seat_layer", "passes_without_spikes"
SHARES, LIDS = (100, 10, 1), (5, 3)


def worst(job, key):
    """By cells per step, the larger of both lids."""
    found, good = [], True
    for share in SHARES:
        values = []
        for lid in LIDS:
            (value,), passed = job.recorded(PROGRAM, TEST, f"lid_{lid}_percent_of_a_cell_{share}_{key}")
            values.append(abs(value))
            good = good and passed
        found.append(max(values))
    return found, good


def mass(job):
    found, passed = worst(job, "mass")
    return ", ".join(f"{v:.1e}" for v in found) + " of the inflow", passed and max(found) <= 1e-12


def pressure(job):
    found, passed = worst(job, "pressure")
    (coarse,), _ = job.recorded(PROGRAM, "blocked_at_once", "at_once_tenth_pressure")
    (fine,), _ = job.recorded(PROGRAM, "blocked_at_once", "at_once_hundredth_pressure")
    return (", ".join(f"{100 * v:.1f}" for v in found) + f" % of the pressure before the seat; cells blocked at once: {100 * coarse:.0f} % at 0.1, {100 * fine:.0f} % at 0.01",
            passed and max(found) <= 0.05)


def force(job):
    most, _ = worst(job, "force")
    steps, _ = worst(job, "force_step")
    return ("changes of " + ", ".join(f"{100 * v:.1f}" for v in most) + " %, from step to step " + ", ".join(f"{100 * v:.1f}" for v in steps) +
            " % of the pressure times the seat: when a row of cells opens or closes its own pressure takes the place of that beside it, and the friction at the edge of the orifice changes cells"), steps[2] <= 0.1 * steps[1]
