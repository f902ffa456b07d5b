# SPDX-License-Identifier: Apache-2.0
"""Bars of the thermocline's elements: closed forms, energy balances, Solar One, Pacheco's tank, hard cases, cost."""
import re

from validation.job import Bar
from validation.parts.measures import all_pass, at_most

BED, GRAINS, CONDUCTION, MECHANICS, TANK, EXPERIMENTS, SPEED = (
    *(f"verification_thermocline_{name}" for name in
      ("bed", "grains", "conduction", "mechanics", "tank", "solar_one")), "thermocline_speed")
HARD = "stability_thermocline_hard_cases"


def between(executable, pattern, key, low, high, text="{:.3f}"):
    def measure(job):
        values, passed = job.recorded(executable, pattern, key)
        return ", ".join(text.format(v) for v in values), passed and all(low <= v <= high for v in values)
    return measure


def factors(job):
    tests, _ = job.gtest(MECHANICS)
    test = tests["FactorOfSafety.is_that_of_the_closed_form"]
    rows = {k.replace("_", " "): v for k, v in test.items() if k[:2] in ("A_", "G_")}
    return "; ".join(f"{k} {v}" for k, v in rows.items()), test["passed"] and float(test["worst"]) <= 0.01


def passive(job):
    get = lambda key: job.recorded(EXPERIMENTS, "filler_yields", key)[0][0]
    return (f"{get('below_surface'):.0f} of 500 rings (and {get('rings') - get('below_surface'):.0f} within 0.3 m of the free "
            f"surface, where the limit vanishes) reach the limit: the upper ends of the 15.6 and 9.5 mm plates, where its closed "
            f"form lies below the thermal stress of the discharge; the wall pushes them in by {get('millimetres'):.2f} mm. Cause: the limit "
            f"is met exactly with E of the hot wall (119.2 MPa at 7.5 m) and exceeded with E of the cold (124.4), which is the one that acts",
            get("below_surface") == 0)


def program_speed(job):
    """ns per cell-step and shares as the program prints them."""
    result = job.run([job.build / "bin/thermocline", job.root / "configs/thermocline-solar-one/case.yaml",
                      f"--set=simulation.output.folder={job.scratch / 'solar-one'}"])
    line = re.search(r"speed: (.*)", result.stdout)
    return line.group(1) if line else "no line", bool(line) and result.returncode == 0


def walls(job):
    """The first day with solid_solver's wall in the loop beside the rings': differences, and the rings' closing words."""
    def make():
        alone, log = job.solve("thermocline", "thermocline-solar-one", ["simulation.end-time=24 h"])
        out = job.scratch / "solar-one-wall"
        case = job.root / "configs/thermocline-solar-one-wall/case.yaml"
        command = ["mpirun", "--oversubscribe"]
        for i, program in enumerate(("coupler", "thermocline", "solid_solver")):
            command += [":"] * (i > 0) + ["-n", "1", job.build / "bin" / program, case, f"--set=simulation.output.folder={out}"]
        result = job.run(command)
        if result.returncode:
            raise RuntimeError(" / ".join((result.stderr.strip() or result.stdout.strip()).splitlines()[-3:]))
        found, (z, ours, heights, stress) = job.beside("configs/thermocline-solar-one-wall/compare.py").compare(out, alone / "tank")
        return found, max(ours[z < 12.76]), max(stress[heights < 12.76]), log
    return job.once("walls", make)


def coupled_wall(job):
    found, *_ = walls(job)
    return (f"{100 * found['mean']:.1f} %; at the published height of its maximum, 3.4 m, {100 * found['at 3.4 m']:.1f} % "
            f"({found['stress at 3.4 m'] / 1e6:.0f} MPa)", found["mean"] < 0.07)


def coupled_maxima(job):
    """Maxima as maxima, wherever they are."""
    found, rings, stress, _ = walls(job)
    return (f"{100 * found['maximum']:.1f} %: {rings / 1e6:.0f} and {stress / 1e6:.0f} MPa at z = {found['place']:.2f} m. Cause: rings have "
            f"steps where plates meet, which bending rounds off", found["maximum"] < 0.03)


def bent_maxima(job):
    """The same with what the tank's bending estimate makes of the rings' largest stress."""
    _, _, stress, log = walls(job)
    bent = float(re.search(r"largest hoop stress of \d+ MPa becomes (\d+)", log).group(1)) * 1e6
    return f"{100 * abs(bent / stress - 1):.1f} %: {bent / 1e6:.0f} and {stress / 1e6:.0f} MPa", abs(bent / stress - 1) < 0.03


def in_parts(job):
    """Ground and blanket in processes of their own against the tank that has them itself."""
    passed, total, _, output = job.ctest("^coupled_tank_in_parts$")
    line = re.search(r"fluid [\d.]+ K, stress.*", output)
    return line.group(0) if line else "no line", total == 1 and passed == 1 and bool(line)


BARS = [
    Bar("thermocline: Schumann on a fine tvd grid, largest error", "<= 0.5 %", at_most(BED, "fine_tvd_grid", "error", 0.005)),
    Bar("thermocline: Schumann, order of tvd", "2 (1.8 to 2.6)", between(BED, r"Schumann\.tvd_is_second", "slope", 1.8, 2.6)),
    Bar("thermocline: Ogata-Banks front, Pe 10 and 100, largest error", "<= 0.5 %", at_most(BED, "front_is_within", "error_10 error_100", 0.005)),
    Bar("thermocline: late two-temperature front, speed and variance over theory", "1 within 0.1 %, 2 %",
        lambda job: (lambda s, w: (f"{s[0]:.5f}, {w[0]:.4f}", abs(s[0] - 1) < 1e-3 and abs(w[0] - 1) < 0.02))(
            job.recorded(BED, "late_width", "speed_ratio")[0], job.recorded(BED, "late_width", "width_ratio")[0])),
    Bar("thermocline: sphere, Biot 0.1 to 100, mean temperature, of the start difference and of itself", "<= 0.5 %",
        at_most(GRAINS, "mean_temperature", "error relative", 0.005)),
    Bar("thermocline: slab against its series", "<= 0.5 %", at_most(CONDUCTION, "Slab.cools", "error", 0.005, "{:.5f}")),
    Bar("thermocline: ground against erfc", "<= 0.5 %", at_most(CONDUCTION, "Ground.step", "error", 0.005, "{:.5f}")),
    Bar("thermocline: energy balance of the bed, each step, of its capacity", "<= 1e-10",
        at_most(HARD, "three_months", "step_upwind step_tvd", 1e-10, "{:.1e}")),
    Bar("thermocline: energy balance of the bed over 3 months, of the heat moved", "<= 1e-6",
        at_most(HARD, "three_months", "drift_upwind drift_tvd", 1e-6, "{:.1e}")),
    Bar("thermocline: energy balance of the whole tank over a week, of the heat moved", "<= 1e-6",
        at_most(TANK, "whole_tank", "imbalance", 1e-6, "{:.1e}")),
    Bar("Solar One: mid temperature reaches the bottom at 90 kg/s", "9.0 to 9.6 h", between(EXPERIMENTS, "start_up_fill", "hours", 9.0, 9.6)),
    Bar("Solar One: hoop stress at 3.4 m after the first discharge", "178 +- 6 MPa", between(EXPERIMENTS, "hoop_stress", "hoop_3_4", 172, 184, "{:.1f}")),
    Bar("Solar One: passive yielding of the filler", "none", passive),
    Bar("Solar One: rings against the coupled finite-volume wall, height-averaged", "< 7 %", coupled_wall),
    Bar("Solar One: rings against the coupled finite-volume wall, maxima", "< 3 %", coupled_maxima),
    Bar("Solar One: rings with their bending estimate against the coupled finite-volume wall, maxima", "< 3 %", bent_maxima),
    Bar("thermocline: closed form of the factors of safety, A and G, base, AR1, T1", "1.56 1.18 2.24 2.30 1.04 3.45 to 1 %", factors),
    Bar("Pacheco: front speed over theory (upwind, tvd, implicit)", "1 +- 0.02", between(EXPERIMENTS, "front_travels", "ratio", 0.98, 1.02, "{:.4f}")),
    Bar("Pacheco: energy closure", "<= 1e-10", at_most(EXPERIMENTS, "front_travels", "closure", 1e-10, "{:.1e}")),
    Bar("hard cases, three schemes: sharp front, reversal every step, rest, 1e-6 m grains, Biot 1e3", "bounded, conservative",
        all_pass(HARD, "HardCase")),
    Bar("hard cases: steps 10x the advective limit, implicit", "bounded, conservative", all_pass(HARD, "ten_times")),
    Bar("thermocline: elements of any subset, energy balance closed", "32 subsets", all_pass(TANK, "any_subset")),
    Bar("thermocline: ground and insulation as programs of their own, against the tank that has them", "0.2 K, 1 MPa, 1 %, amounts kept",
        in_parts),
    Bar("thermocline: exponent of the cost in cells, 500 to 8000 (upwind, tvd, implicit)", "<= 1.05",
        at_most(SPEED, "linear", "exponent_upwind exponent_tvd exponent_implicit", 1.05, "{:.3f}"), long=True),
    Bar("thermocline: bed alone, ns per cell-step (upwind, tvd, implicit)", "reported",
        at_most(SPEED, "linear", "ns_upwind ns_tvd ns_implicit", 1e9, "{:.1f}"), long=True),
    Bar("thermocline: Solar One, all elements, ns per cell-step and shares", "reported", program_speed),
]
