# SPDX-License-Identifier: Apache-2.0
"""Bars of the eddy viscosity and of immersed bodies."""
from validation.job import Bar

EFFECTS = "verification_fluid_effects"


def wale_slope(job):
    (slope,), passed = job.recorded(EFFECTS, "third_power", "slope")
    return f"{slope:.2f}", passed and 2.7 <= slope <= 3.3


def pure_shear(job):
    (eddy,), passed = job.recorded(EFFECTS, "leaves_a_couette", "largest_eddy_viscosity")
    return f"{eddy:.1e} m^2/s at most", passed and eddy <= 1e-12


def drag(job):
    (cd,), passed = job.recorded(EFFECTS, "ImmersedCylinder", "drag_coefficient")
    return f"cd {cd:.3f}, {100 * (cd / 5.5795 - 1):+.1f} %", passed and abs(cd / 5.5795 - 1) <= 0.05


def leak(job):
    (share,), passed = job.recorded(EFFECTS, "ImmersedCylinder", "leak")
    return f"{share:.1e} of the inflow", passed and share <= 0.005


def taylor_green(job, *sets):
    folder, _ = job.solve("fluid_solver", "taylor-green-3d", sets)
    return job.beside("configs/taylor-green-3d/budget.py").budget(folder / "fluid")


def peak_time(job):
    got = taylor_green(job)
    return f"{got['peak_time']:.2f} s, height {got['peak']:.5f}", 8.6 <= got["peak_time"] <= 9.4


def without_model(job):
    got = taylor_green(job, "participants.fluid.turbulence=null")
    text = f"{got['peak_time']:.2f} s, height {got['peak']:.5f}, {100 * got['unexplained']:+.2f} % unexplained"
    return text, 8.6 <= got["peak_time"] <= 9.4 and abs(got["unexplained"]) <= 0.02


def closed(job):
    got = taylor_green(job)
    text = f"{100 * got['unexplained']:+.2f} % unexplained, {100 * got['pressure_share']:.1f} % taken by the pressure"
    return text, abs(got["unexplained"]) <= 0.02


BARS = [
    Bar("WALE: nu_t at walls", "~ y^3 (slope 2.7 to 3.3)", wale_slope),
    Bar("WALE in pure shear", "0", pure_shear),
    Bar("immersed cylinder at Re = 20 against the body-fitted drag", "within 5 %", drag),
    Bar("immersed cylinder: leak", "< 0.5 % of the inlet", leak),
    Bar("Taylor-Green 3-D, Re 1600, 64^3: time of the largest dissipation", "8.6 to 9.4", peak_time, long=True),
    Bar("Taylor-Green 3-D: energy budget", "closed to 2 %", closed, long=True),
    Bar("Taylor-Green 3-D: the same without an eddy viscosity", "8.6 to 9.4, closed to 2 %", without_model, long=True),
]
