# SPDX-License-Identifier: Apache-2.0
"""Measures of the thermocline's elements: closed forms, energy balances, Solar One, Pacheco's tank, hard cases, cost."""
import re

MECHANICS, EXPERIMENTS = (f"verification_thermocline_{name}" for name in ("mechanics", "grains"))


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


def walls(job):
    """The first day with solid_solver's wall in the loop beside the rings': differences, and the rings' closing words."""
    def make():
        run = job.alone("thermocline-solar-one", ["simulation.end-time=24 h"])
        alone, log = run.folder, run.log
        out = job.scratch / "solar-one-wall"
        case = job.root / "configs/thermocline-solar-one-wall/case.yaml"
        command = ["mpirun", "--oversubscribe"]
        for i, program in enumerate(("coupler", "thermocline", "solid_solver")):
            command += [":"] * (i > 0) + ["-n", "1", job.build / "bin" / program, case, f"--set=simulation.output.folder={out}"]
        job.done(command)
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
