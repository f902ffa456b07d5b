# SPDX-License-Identifier: Apache-2.0
"""Measures of the first coupled job."""
import re

import numpy as np

import couplet


FLAP = "configs/perpendicular-flap/case.yaml"


# -- set-up -----------------------------------------------------------------------------------------------------------
def fresh_clone(job, script, sign):
    clone = job.once("clone", lambda: job.scratch / "clone")
    if not clone.exists():
        job.done(["git", "clone", "-q", job.root, clone])
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


# -- start, death, configuration, readers -----------------------------------------------------------------------------
