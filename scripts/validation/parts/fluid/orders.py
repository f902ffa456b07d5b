# SPDX-License-Identifier: Apache-2.0
"""Bars of the fluid's orders, energy budget and moving meshes: recorded by the test executables."""
from validation.job import Bar
from validation.parts.measures import at_least, at_most

EFFECTS, EXACT, GREEN = "verification_fluid_effects", "verification_fluid_exactness", "verification_fluid_taylor_green"


def drift(job):
    test = EFFECTS, "InviscidVortices"
    value = {}
    for name in ("incremental", "flux_memory", "non_incremental"):
        (value[name],), passed = job.recorded(*test, f"drift_{name}")
    (slope,), _ = job.recorded(*test, "drift_slope_incremental")
    (error,), _ = job.recorded(*test, "time_error_incremental")
    return (f"{value['incremental']:.1e} over t = 1, slope {slope:.2f} with dt (time error of u {error:.1e}); "
            f"flux-memory {value['flux_memory']:.1e}, non-incremental {value['non_incremental']:.1e}",
            passed and slope > 1.9 and value["incremental"] <= error)


def checkerboard(job):
    texts, worst, fine = [], 0, True
    for name in ("incremental", "flux_memory", "non_incremental"):
        (part,), passed = job.recorded(EFFECTS, "Checkerboard", f"alternating_{name}")
        (taken,), _ = job.recorded(EFFECTS, "Checkerboard", f"taken_{name}")
        texts.append(f"{name.replace('_', '-')} {part:.1e} of the pressure, takes {100 * taken:.2g} % of the energy lost")
        worst, fine = max(worst, part), fine and passed
    return "; ".join(texts), fine and worst <= 0.01


def variants(job):
    texts = []
    for name in ("flux_memory", "non_incremental"):
        (time,), _ = job.recorded(EFFECTS, "second_order_in_time$", f"time_slope_{name}")
        (u,), _ = job.recorded(EFFECTS, "on_quadrilaterals", f"velocity_slope_{name}")
        (p,), _ = job.recorded(EFFECTS, "on_quadrilaterals", f"pressure_slope_{name}")
        texts.append(f"{name.replace('_', '-')}: time {time:.2f}, space u {u:.2f}, p {p:.2f}")
    (time,), _ = job.recorded(EFFECTS, "with_runge_kutta", "time_slope_incremental")
    return "; ".join(texts) + f"; incremental with Runge-Kutta: time {time:.2f}", True


def hard(job):
    tests, _ = job.gtest("stability_fluid_step_sizes", "*HardMeshes*")
    solved = sum(int(t.get("solved", 0)) for t in tests.values())
    return (f"{solved} of {len(tests)} solved, the others refused with the reason",
            all(t["passed"] for t in tests.values()))


BARS = [
    Bar("Taylor-Green 2-D on quadrilaterals: order in space, u and p (p at t^{n+1/2})", ">= 1.95",
        at_least(EFFECTS, "on_quadrilaterals", "velocity_slope_incremental pressure_slope_incremental", 1.95)),
    Bar("Taylor-Green 2-D: order in time", ">= 1.9",
        at_least(EFFECTS, "second_order_in_time$", "time_slope_incremental", 1.9)),
    Bar("Taylor-Green 2-D: other variants beside it", "reported", variants),
    Bar("Taylor-Green on perturbed prisms: order in space", ">= 1.8",
        at_least(EFFECTS, "perturbed_prisms", "velocity_slope", 1.8)),
    Bar("convection on perturbed meshes: share of its work in the energy budget", "round-off (<= 1e-12)",
        at_most(EFFECTS, "Convection", "share", 1e-12)),
    Bar("inviscid vortices: kinetic energy from convection per step", "<= 1e-12",
        at_most(EFFECTS, "InviscidVortices", "convection_per_step", 1e-12)),
    Bar("inviscid vortices: total drift of the kinetic energy", "<= the time error shown", drift),
    Bar("checkerboard of the pressure, cavity Re 1000 on 48^2", "not visible (<= 1 %), its dissipation reported", checkerboard),
    Bar("uniform flow on randomly moving, accelerating meshes, each time scheme", "<= 1e-12",
        at_most(EXACT, r"UniformFlow\.", "error", 1e-12)),
    Bar("linear shear on a moving mesh: order, explicit and implicit", "second order (>= 1.9)",
        at_least(EFFECTS, "LinearShear", "slope_explicit slope_implicit", 1.9)),
    Bar("order in time on a moving mesh", ">= 1.9", at_least(GREEN, "order_in_time_on_a_moving_mesh/", "time_slope", 1.9)),
    Bar("oscillating box: u = w(t)", "<= 1e-10", at_most(EXACT, r"OscillatingBox\.", "velocity_error", 1e-10)),
    Bar("oscillating box: p = -rho a x", "<= 1e-10", at_most(EXACT, r"OscillatingBox\.", "pressure_error", 1e-10)),
    Bar("oscillating body: force whether mesh or frame moves", "equal to 0.5 %",
        at_most(EFFECTS, "OscillatingBody", "relative_gap", 0.005)),
    Bar("70 degrees, aspect ratio 1000, needle tetrahedra", "solved or refused with the reason, never NaN", hard),
]
