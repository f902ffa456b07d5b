# SPDX-License-Identifier: Apache-2.0
"""Measures of the fluid's orders, energy budget and moving meshes: recorded by the test executables."""


EFFECTS = "verification_fluid_effects"


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
