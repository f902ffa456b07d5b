# SPDX-License-Identifier: Apache-2.0
"""Measures of the elastic tubes: coupling error in one dimension, iterations, peak and step in three."""
import re

import numpy as np

import couplet
from validation.parts.main_job import steps_of

TUBE = "configs/tube-3d/case.yaml"
PEAK = 1.585e-4  # m, backward differences of second order extrapolated to step 0 (solids4foam's benchmark data)


def tube_1d(job):
    """Coupled pressure in the middle of the tube against the monolithic one, all 100 steps."""
    folder = job.scratch / "tube-1d"
    folder.mkdir()
    job.environment["COUPLET_BIN"] = str(job.build / "bin")
    job.done([job.root / "configs/tube-1d/run", f"--set=simulation.output.folder={folder / 'out'}"], 900, cwd=folder)
    got = np.loadtxt(folder / "tube.csv", delimiter=",")[:, 1]
    wanted = job.beside("configs/tube-1d/tube.py").monolithic()[:, 1]
    off = np.abs(got - wanted).max() / np.abs(wanted).max()
    return f"{off:.1e} of the largest pressure, {wanted.max():.2f} (preCICE's plot 223.5)", len(got) == 100 and bool(off < 1e-4)


def tube(job, name, *sets):
    return job.coupled(job.root / TUBE, f"tube-{name}", ["simulation.end-time=8.5 ms", *sets])


def radial(folder):
    """(time, radial motion of A) [s], [m]"""
    probes = couplet.read_csv(folder / "solid" / "probes.csv")
    return np.array(probes["time [s]"]), np.array(probes["A y [m]"])


def iterations(job):
    steps = steps_of(tube(job, "implicit", "coupling.scheme=implicit"))
    return f"{steps[:, 0].mean():.2f} on average, {steps[:, 0].max():.0f} at most, {len(steps)} steps", bool(steps[:, 0].mean() <= 9.1 and len(steps) == 85)


def peak(job):
    found = {s: radial(tube(job, s, f"coupling.scheme={s}")) for s in ("semi-implicit", "implicit")}
    off = {s: y.max() / PEAK - 1 for s, (_, y) in found.items()}
    text = "; ".join(f"{s}: {y.max():.3e} m at {1e3 * t[y.argmax()]:.1f} ms, {100 * off[s]:+.1f} %" for s, (t, y) in found.items())
    return text, max(map(abs, off.values())) <= 0.03


def euler(job):
    t, y = radial(tube(job, "euler", "participants.solid.time-scheme={type: euler}"))
    return f"{y.max():.3e} m at {1e3 * t[y.argmax()]:.1f} ms (anchor, Euler in the fluid, too: 1.19e-4)", None


def step(job):
    t, y = radial(tube(job, "semi-implicit", "coupling.scheme=semi-implicit"))
    fine, z = radial(tube(job, "fine", "simulation.time-step=0.025 ms", "simulation.end-time=4 ms"))
    half, h = radial(tube(job, "half", "simulation.time-step=0.05 ms", "simulation.end-time=4 ms"))
    then = [i for i, at in enumerate(t) if 3e-3 - 1e-9 <= at <= 4e-3 + 1e-9]
    at = [np.array([values[np.abs(times - t[i]).argmin()] for i in then]) for times, values in ((t, y), (half, h), (fine, z))]
    gap = np.abs(at[0] - at[2]).max()
    first, second = (100 * np.sqrt(np.mean((a - b) ** 2)) / y.max() for a, b in zip(at, at[1:]))
    return (f"{100 * gap / y.max():.2f} % of the largest motion apart at most, {len(then)} times; root mean square of 0.1 to 0.05 ms {first:.2f} %, "
            f"of 0.05 to 0.025 ms {second:.2f} %: order {np.log2(first / second):.2f}. The wave that runs ahead in the wall, 8 steps per period, "
            "lags by the second-order error of the step"), len(then) == 11 and bool(gap <= 0.01 * y.max())


def hours(job):
    run = job.coupled_run(job.root / TUBE, "tube-semi-implicit", ["simulation.end-time=8.5 ms", "coupling.scheme=semi-implicit"])
    took = re.search(r"steps, \d+ halvings in ([\d.]+) s", run.log)
    return f"{float(took[1]) * 4 / 3600:.3f} core-hours for 85 steps on 4 processes (waiting counted)", None


def finer(job, part):
    """The file of fluid or solid with 104 x 26 faces on the wall."""
    geo = (job.root / f"configs/tube-3d/{part}.geo").read_text()
    mesh = job.scratch / f"finer-{part}.geo"
    mesh.write_text(geo.replace("n = 10,", "n = 13,").replace("n_z = 80", "n_z = 104"))
    return mesh


def unequal(job):
    """A finer wall in the fluid's mesh as it is, against the same wall in a fluid that matches it: so that only the interface differs."""
    end = "simulation.end-time=7.5 ms"
    wall, fluid = f"participants.solid.mesh={finer(job, 'solid')}", finer(job, "fluid")
    matching = tube(job, "matching", end, wall, f"participants.fluid.mesh={fluid}", f"participants.mover.mesh={fluid}")
    wanted = radial(matching)[1].max()
    gaps = {kind: radial(tube(job, kind, end, wall, f"coupling.mapping.type={kind}"))[1].max() / wanted - 1 for kind in ("projection", "rbf")}
    return ", ".join(f"{k} {100 * g:+.2f} %" for k, g in gaps.items()) + f" of {wanted:.3e} m (largest radial motion of A)", max(map(abs, gaps.values())) <= 0.01
