# SPDX-License-Identifier: Apache-2.0
"""Bars of the first coupled job."""
import re

import numpy as np

import couplet
from validation.job import Bar

FLAP = "configs/perpendicular-flap/case.yaml"


# -- set-up -----------------------------------------------------------------------------------------------------------
def fresh_clone(job, script, sign):
    clone = job.once("clone", lambda: job.scratch / "clone")
    if not clone.exists():
        job.run(["git", "clone", "-q", job.root, clone]).check_returncode()
    result = job.run([clone / "scripts" / script], timeout=7200)
    found = re.findall(sign, result.stdout)
    return f"exit code {result.returncode}; {found[-1] if found else 'nothing found of its result'}", (
        result.returncode == 0 and bool(found))


def demo_time(job):
    got, met = fresh_clone(job, "demo", r"done in [\d.]+ s")
    seconds = re.search(r"done in ([\d.]+) s", got)
    picture = job.scratch / "clone/configs/perpendicular-flap/out/perpendicular-flap.png"
    there = picture.exists() and picture.stat().st_size > 10_000
    return f"{got}; picture {'written' if there else 'missing'}", bool(met and there and float(seconds.group(1)) < 180)


# -- flap -------------------------------------------------------------------------------------------------------------
def flap_run(job):
    end = ["simulation.end-time=1"] if job.quick else []
    return job.coupled(job.root / FLAP, "flap", end)


def tip_maxima(folder):
    probes = couplet.read_csv(folder / "solid" / "probes.csv")
    return [(t, x) for t, x, kind in couplet.extrema(probes["time [s]"], probes["tip x [m]"]) if kind == "max"]


def maximum(job, number, wanted, tolerance, when=None):
    t, x = tip_maxima(flap_run(job))[number]
    met = abs(x - wanted) <= tolerance and (when is None or abs(t - when[0]) <= when[1])
    return f"{x:.4f} m at {t:.3f} s", met


def steps_of(folder):
    """Last residual and number of iterations of each accepted step."""
    rows = couplet.read_csv(folder / "coupler" / "residuals.csv")
    last = {}
    for time, iteration, residual in zip(rows["time [s]"], rows["iteration"], rows["relative residual"]):
        last[round(time, 9)] = (iteration, residual)
    return np.array(list(last.values()))


def interface_tolerance(job):
    steps = steps_of(flap_run(job))
    return f"largest last residual of {len(steps)} steps {steps[:, 1].max():.2e}", bool(steps[:, 1].max() <= 1e-5)


def mean_iterations(job):
    steps = steps_of(flap_run(job))
    return f"{steps[:, 0].mean():.2f} on average, {steps[:, 0].max():.0f} at most", len(steps) > 0


def implicit_agrees(job):
    folder = job.coupled(job.root / FLAP, "flap-implicit", ["simulation.end-time=1", "coupling.scheme=implicit"])
    (_, semi), (_, implicit) = tip_maxima(flap_run(job))[0], tip_maxima(folder)[0]
    gap = abs(semi - implicit) / implicit
    return f"{semi:.4f} m and {implicit:.4f} m, {100 * gap:.2f} % apart", gap <= 0.01


# -- ranks ------------------------------------------------------------------------------------------------------------
def sorted_fields(folder, participant, names):
    series = couplet.find_series(folder / participant)
    last = len(series.times) - 1
    cell_id = series.file["mesh/cell-id"][...]
    point_id = series.file["mesh/point-id"][...]
    fields = {}
    for name in names:
        values = series.field(last, name)
        fields[name] = values[np.argsort(cell_id if len(values) == len(cell_id) else point_id)]
    return fields


def ranks_agree(job):
    tight = ["simulation.end-time=0.2", "simulation.output.interval=0.2", "coupling.convergence.relative=1e-9",
             "coupling.convergence.max-iterations=100", "participants.fluid.pressure-tolerance=1e-12"]
    runs = [job.coupled(job.root / FLAP, f"flap-ranks-{i}", tight, ranks)
            for i, ranks in enumerate(((1, 1, 1, 1), (1, 3, 2, 2)))]
    tips = [couplet.read_csv(run / "solid" / "probes.csv")["tip x [m]"] for run in runs]
    gaps = {"tip": np.abs(tips[0] - tips[1]).max() / np.abs(tips[0]).max()}
    for participant, names in (("solid", ["displacement"]), ("fluid", ["velocity", "pressure"])):
        a, b = (sorted_fields(run, participant, names) for run in runs)
        gaps.update({name: np.abs(a[name] - b[name]).max() / np.abs(a[name]).max() for name in names})
    return ", ".join(f"{k} {v:.1e}" for k, v in gaps.items()), max(gaps.values()) <= 1e-7 and len(tips[0]) >= 20


# -- parts ------------------------------------------------------------------------------------------------------------
def largest(executable, pattern, key, limit):
    def measure(job):
        values, passed = job.recorded(executable, pattern, key)
        return f"{max(values):.2e} at most in {len(values)} cases", passed and max(values) <= limit
    return measure


def smallest(executable, pattern, key, limit):
    def measure(job):
        values, passed = job.recorded(executable, pattern, key)
        return ", ".join(f"{v:.2f}" for v in values), passed and min(values) >= limit
    return measure


def cantilever(job):
    tests, _ = job.gtest("verification_solid_cantilever")
    test = next(v for k, v in tests.items() if "tip_deflection" in k)
    tips = [float(test[f"tip_{n}"]) for n in ("coarse", "medium", "fine")]
    errors = [abs(t - 0.10008) for t in tips]
    return ", ".join(f"{t:.5f} m" for t in tips), test["passed"] and errors[0] > errors[1] > errors[2]


def cavity(job):
    u, passed = job.recorded("verification_fluid_cavity", "ghia", "largest_deviation_u")
    v, _ = job.recorded("verification_fluid_cavity", "ghia", "largest_deviation_v")
    return f"{max(u):.4f}, {max(v):.4f}", passed and max(u + v) <= 0.01


# -- start, death, configuration, readers -----------------------------------------------------------------------------
def registered(pattern, at_least=1, count=None):
    """Tests registered in ctest; `count` finds a number of scenarios in their output."""
    def measure(job):
        passed, total, skipped, output = job.ctest(pattern)
        text = f"{passed} of {total} tests passed"
        if skipped:
            text += f", {skipped} skipped"
        met = total > 0 and passed == total and not skipped
        if count:
            found = re.findall(count, output, flags=re.M)
            number = int(found[-1]) if found and found[-1].isdigit() else len(found)
            text += f", {number} scenarios"
            met = met and number >= at_least
        return text, met
    return measure


BARS = [
    Bar("scripts/test on a fresh clone", "succeeds", lambda job: fresh_clone(job, "test", r"100% tests passed.*"), long=True),
    Bar("scripts/demo on a fresh clone", "succeeds, run below 180 s, picture there", demo_time, long=True),
    Bar("flap: first tip maximum", "0.198 +- 0.006 m at 0.74 +- 0.03 s",
        lambda job: maximum(job, 0, 0.198, 0.006, (0.74, 0.03))),
    Bar("flap: second tip maximum", "0.184 +- 0.008 m", lambda job: maximum(job, 1, 0.184, 0.008), long=True),
    Bar("flap: interface residual in every step", "<= 1e-5", interface_tolerance),
    Bar("flap: coupling iterations", "reported", mean_iterations),
    Bar("flap: first maximum, semi-implicit and implicit", "within 1 %", implicit_agrees, long=True),
    Bar("solid: patch test, relative error", "<= 1e-10 on hex, tet, prism, mixed",
        largest("verification_solid_patch", "linear_field_is_exact", "relative_error", 1e-10)),
    Bar("solid: order of the displacement, hexahedra and quadrilaterals", ">= 1.9",
        smallest("verification_solid_order", "hexahedra|quadrilaterals", "displacement_slope", 1.9)),
    Bar("solid: cantilever tip, 20x2x2 to 80x8x8", "converging to 0.10008 m", cantilever),
    Bar("solid: reactions against load", "<= 1e-8",
        largest("verification_solid_cantilever", "tip_deflection", "imbalance", 1e-8)),
    Bar("fluid: Taylor-Green, order in space", ">= 1.9",
        smallest("verification_fluid_taylor_green", "order_in_space", "velocity_slope", 1.9)),
    Bar("fluid: Taylor-Green, order in time", ">= 1.9",
        smallest("verification_fluid_taylor_green", "order_in_time/", "time_slope", 1.9)),
    Bar("fluid: Taylor-Green, order in time on a moving mesh", ">= 1.9",
        smallest("verification_fluid_taylor_green", "order_in_time_on_a_moving_mesh/", "time_slope", 1.9)),
    Bar("fluid: cavity Re 100 against Ghia, u and v", "within 0.01 of the lid's speed", cavity),
    Bar("fluid: uniform flow on a randomly moving mesh, 1000 steps", "kept to 1e-12",
        largest("verification_fluid_exactness", r"UniformFlow\.", "error", 1e-12)),
    Bar("fluid: oscillating box of fluid, u = w(t)", "to 1e-10",
        largest("verification_fluid_exactness", r"OscillatingBox\.", "velocity_error", 1e-10)),
    Bar("fluid: oscillating box of fluid, p = -rho a x", "to 1e-10",
        largest("verification_fluid_exactness", r"OscillatingBox\.", "pressure_error", 1e-10)),
    Bar("ranks: 20 steps of the flap on (1,1,1,1) and (1,3,2,2)", "agree to 1e-7", ranks_agree),
    Bar("start and death: every case ends within 5 s and names the culprit", "all",
        registered("^(launch|kill_in_)", 20, r"^\d+: ok  .*\(\d"), long=True),
    Bar("wrong configurations with their exact message", ">= 30", registered("^cli_wrong_configurations$", 30, r"(\d+) (?:of \d+ )?wrong configurations")),
    Bar("configs/*/case.yaml pass --check", "all", registered("^configs_every_case_is_valid$")),
    Bar("generated reference and schema", "as committed", registered("^docs_are_what_the_programs_say$")),
    Bar("ParaView's reader: times and moved mesh", "as written", registered("^io_series_is_read_by_paraview")),
]
