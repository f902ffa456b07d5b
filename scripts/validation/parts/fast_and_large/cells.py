# SPDX-License-Identifier: Apache-2.0
"""Accuracy per cell: face values of fourth order beside those of second, on Taylor-Green vortices and the cubic cavity."""
import statistics

TEST = "verification_fluid_fourth_order"
PEAK, HEIGHT = 9.0, 0.0128  # of -dk/dt at Re 1600
KEY = "participants.fluid.face-values="
ORDERS = {"second": KEY + "second-order", "fourth": KEY + "fourth-order"}
TURNS = 5
WHOLE = 0.025  # steps that either order takes whole [s]; twice as long ones are divided by fourth order, whose limit is lower


def order_of_lines(job):
    (u,), passed = job.recorded(TEST, "are_fourth_order", "velocity_slope")
    (p,), _ = job.recorded(TEST, "are_fourth_order", "pressure_slope")
    (gain,), _ = job.recorded(TEST, "are_fourth_order", "gain")
    return f"velocity {u:.2f}, pressure {p:.2f}; 64^2: {gain:.0f} times less error than second order", passed and min(u, p) >= 3.8


def order_on_stretched(job):
    (u,), passed = job.recorded(TEST, "stretched_cells_is", "velocity_slope_stretched")
    (p,), _ = job.recorded(TEST, "stretched_cells_is", "pressure_slope_stretched")
    (gain,), _ = job.recorded(TEST, "stretched_cells_is", "gain_stretched")
    return f"velocity {u:.2f}, pressure {p:.2f}; 64^2: {gain:.1f} times less error than second order", None


def energy_of_lines(job):
    (second,), passed = job.recorded(TEST, "drifts", "drift_second")
    (fourth,), _ = job.recorded(TEST, "drifts", "drift_fourth")
    return f"{fourth:.2e} of the energy in 1 s, second order {second:.2e}; convection gives none to round-off", passed and fourth <= 1.1 * second


def cavity(job):
    """The largest deviation of the three extrema by order, and the processor minutes."""
    found = {}
    for name, setting in ORDERS.items():
        run = job.alone("cavity-3d", [setting], timeout=7200)
        found[name] = job.beside("configs/cavity-3d/extrema.py").errors(run.folder / "fluid"), run.cost.cpu / 60
    return found


def extrema_of_cavity(job):
    found = cavity(job)
    texts = [f"{name} order {', '.join(f'{key} {100 * off:.2f} %' for key, off in errors.items())} ({minutes:.1f} processor minutes)" for name, (errors, minutes) in found.items()]
    return "; ".join(reversed(texts)), max(found["fourth"][0].values()) <= 0.02


def peak(job, n, name, *sets):
    folder, _ = job.solve("taylor-green-3d", [f"participants.fluid.mesh-parameters.n={n}", ORDERS[name], *sets], timeout=48 * 3600)
    return job.beside("configs/taylor-green-3d/budget.py").budget(folder / "fluid")


def vortices(job, n, what, share):
    key, wanted = {"time": ("peak_time", PEAK), "height": ("peak", HEIGHT)}[what]
    sets = ["simulation.time-step=0.02 s"] if n > 64 else []
    got = {name: peak(job, n, name, *sets)[key] for name in ORDERS}
    texts = [f"{name} order {got[name]:.5g} ({100 * (got[name] / wanted - 1):+.1f} %)" for name in ("fourth", "second")]
    return ", ".join(texts), abs(got["fourth"] / wanted - 1) <= share


def step_of_fourth(job):
    """Processor time of 40 steps of 48^3 cells that neither order divides, in pairs."""
    def seconds(setting, turn):
        of = {}
        for steps in (5, 45):
            sets = ["participants.fluid.mesh-parameters.n=48", "participants.fluid.turbulence=null", "participants.fluid.output=null", f"simulation.time-step={WHOLE}",
                    f"simulation.end-time={steps * WHOLE:g}", "simulation.output.interval=100", setting]
            run = job.case_run(job.root / "configs/taylor-green-3d/case.yaml", job.scratch / f"cost-{turn}-{steps}", sets, {"fluid": 1}, 1800)
            of[steps] = run.cost.cpu
            if run.column("fluid", "balance.csv", "sub-steps [-]").max() > 1:
                raise RuntimeError(f"steps of {WHOLE} s are divided")
        return of[45] - of[5]
    ratios = [seconds(ORDERS["fourth"], f"f{i}") / seconds(ORDERS["second"], f"s{i}") for i in range(TURNS)]
    return f"{statistics.median(ratios):.2f} times, median of {TURNS} pairs ({min(ratios):.2f} to {max(ratios):.2f}), Taylor-Green 48^3", statistics.median(ratios) <= 1.3
