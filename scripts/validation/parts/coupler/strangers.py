# SPDX-License-Identifier: Apache-2.0
"""Measures of programs of other people: a cylinder on a spring against Stokes and in a stream, a flap of FEniCSx."""
import os

import numpy as np

from validation.parts.main_job import FLAP
from validation.parts.coupler.runs import flap, tips

CYLINDER = "configs/spring-cylinder"


def cylinder(job, case, *sets):
    """(time, place) of the cylinder, run by the case's own script."""
    def make():
        folder = job.scratch / case
        folder.mkdir()
        options = [f"--set={s}" for s in (f"simulation.output.folder={folder / 'out'}", *sets)]
        job.environment["COUPLET_BIN"] = str(job.build / "bin")
        job.done([job.root / CYLINDER / "run", case, *options], 3600, cwd=folder)
        return np.loadtxt(folder / "body.csv", delimiter=",", usecols=(0, 1), unpack=True)
    return job.once(("cylinder", case, sets), make)


def stokes(job, which):
    time, y = cylinder(job, "case.yaml")
    decay = job.beside(f"{CYLINDER}/decay.py")
    wanted = decay.stokes(2, 4, 1, 0.01)
    late = time > 2 * np.pi / wanted[0]
    got = decay.fitted(time[late], y[late], *wanted)
    return f"{got[which]:.5f}, Stokes {wanted[which]:.5f}: {100 * (got[which] / wanted[which] - 1):+.2f} %", bool(abs(got[which] / wanted[which] - 1) <= 0.02)


def vortices(job):
    time, y = cylinder(job, "vortices.yaml")
    late = y[time > 0.75 * time[-1]]
    crossings = np.flatnonzero((y[1:] >= 0) & (y[:-1] < 0) & (time[1:] > 0.75 * time[-1]))
    period = np.diff(time[crossings]).mean()
    return f"amplitude {(late.max() - late.min()) / 2:.3f} D (0.55), period {period:.3f} s", None


def fenicsx(job):
    """Tip of the flap with DOLFINx's structure over solid_solver's, the same steps."""
    guest = "participants.solid={program: flap_fenicsx}"
    folder = job.scratch / "fenicsx"
    folder.mkdir()
    end = 0.2 if job.quick else 0.8
    options = [f"--set=simulation.end-time={end}", f"--set=simulation.output.folder={folder / 'out'}", f"--set={guest}"]
    command = ["mpirun", "--oversubscribe"]
    for program in ("coupler", "fluid_solver", "mesh_mover"):
        command += ["-n", "1", job.build / "bin" / program, job.root / FLAP, *options, ":"]
    command += ["-n", "1", "/usr/bin/python3", job.root / "client/examples/flap_fenicsx.py", "solid"]
    job.environment["PYTHONPATH"] = os.pathsep.join([str(job.root / "client/python"), os.environ.get("PYTHONPATH", "")])
    job.done(command, 3600, cwd=folder)
    theirs = np.loadtxt(folder / "solid.csv", delimiter=",")[:, 1]
    ours = tips(flap(job, "default"))
    n = min(len(theirs), len(ours))
    gap = np.abs(theirs[:n] - ours[:n]).max() / np.abs(ours[:n]).max()
    return f"{100 * gap:.3f} % of the largest motion apart at most, to {n / 100:g} s", bool(gap <= 0.03)
