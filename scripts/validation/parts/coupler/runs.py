# SPDX-License-Identifier: Apache-2.0
"""Measures of the coupler: schedules, several bodies, ranks, scale, programs of other people."""
import csv
import resource

import numpy as np

import couplet
from validation.parts.main_job import FLAP, steps_of


def flap(job, name, *sets, ranks=(1, 1, 1, 1)):
    end = "simulation.end-time=0.2" if job.quick else "simulation.end-time=1"
    return job.coupled(job.root / FLAP, f"coupler-{name}", [end, *sets], ranks)


def length(job):
    """The row of a quick run states what it omits."""
    return "to 0.2 s" if job.quick else "to 1 s"


def tips(folder):
    probes = couplet.read_csv(folder / "solid" / "probes.csv")
    return np.array(probes["tip x [m]"])


def jacobi_against_gauss_seidel(job):
    acceleration = ("coupling.scheme=implicit", "coupling.acceleration.type=iqn-ils", "coupling.convergence.relative=1e-7")
    one = flap(job, "serial", *acceleration)
    other = flap(job, "parallel", *acceleration, "coupling.order=parallel")
    gap = np.abs(tips(one) - tips(other)).max() / np.abs(tips(one)).max()
    counts = [steps_of(f)[:, 0].mean() for f in (one, other)]
    return f"{gap:.1e} apart; {counts[0]:.2f} and {counts[1]:.2f} passes per step, {length(job)}", bool(gap <= 1e-4)


def coupler_ranks(job):
    one = flap(job, "ranks-1")
    gaps = []
    for n in (2, 3):
        gaps.append(np.abs(tips(one) - tips(flap(job, f"ranks-{n}", ranks=(n, 1, 1, 1)))).max() / np.abs(tips(one)).max())
    return f"{max(gaps):.1e} apart, {length(job)}", bool(max(gaps) <= 1e-10)


def participants(folder):
    """Rows of the steps but the first."""
    with open(folder / "coupler" / "participants.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))[1:]


def own_share(job):
    """Processor seconds of the coupler outside its waiting, beside those of all programs of the job."""
    def make():
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        folder = flap(job, "own-share")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return participants(folder), after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    rows, everybody = job.once("own share", make)
    own = sum(float(r["coupler working [s]"]) for r in rows)
    return f"{100 * own / everybody:.2f} %: {1e3 * own / len(rows):.2f} ms of a step's {1e3 * everybody / len(rows):.0f} ms, {length(job)}", \
        bool(rows and 0 < own < 0.03 * everybody)


def beside_work(job):
    """Wall clock of the steps less what fluid and structure, one after the other, worked: the coupler, and all waiting for the machine."""
    rows = participants(flap(job, "ranks-1"))
    wall = sum(float(r["wall clock [s]"]) for r in rows)
    worked = sum(float(r[f"{name} working [s]"]) for r in rows for name in ("fluid", "solid"))
    return f"{100 * (1 - worked / wall):.1f} % of {len(rows)} steps", None


def refused(job, *sets):
    """Runs a flap that cannot hold; gives steps until it was refused and the words."""
    command = ["mpirun", "--oversubscribe"]
    out = job.scratch / f"coupler-refused-{abs(hash(sets))}"
    options = [f"--set={s}" for s in (f"simulation.output.folder={out}", "simulation.end-time=0.6", *sets)]
    for i, program in enumerate(("coupler", "fluid_solver", "solid_solver", "mesh_mover")):
        command += [":"] * (i > 0) + ["-n", "1", job.build / "bin" / program, job.root / FLAP, *options]
    result = job.run(command, 600)
    text = result.stdout + result.stderr
    steps = len(couplet.read_csv(out / "coupler" / "balance.csv")["time [s]"])
    return result.returncode, steps, text


def explicit_heavy(job):
    folder = flap(job, "explicit", "coupling.scheme=explicit")
    gap = np.abs(tips(folder) - tips(flap(job, "default"))).max() / np.abs(tips(folder)).max()
    return f"holds; tip {gap:.1e} from the semi-implicit one", bool(gap < 1e-2)


def explicit_light(job):
    code, steps, text = refused(job, "coupling.scheme=explicit", "participants.solid.material.density=42")
    named = "added-mass instability" in text
    return f"exit code {code} after {steps} steps, {'named' if named else 'not named'}", code == 1 and named and steps <= 10


def viscous_swing(job):
    code, steps, text = refused(job, "participants.solid.material.density=1", "participants.fluid.boundaries.inlet.ramp=0.4")
    named = "wall shear at the predicted velocity" in text
    return f"exit code {code} after {steps} steps, {'named' if named else 'not named'}", code == 0 or (code == 1 and named)


def exchanged(job, kind, times):
    """A pass of two dummies with 1e5 vectors of three each way, without their own work, over MPI's own time; the best of three runs. On the machine where preCICE
    was measured MPI alone took 0.3117 ms (15.4 GB/s of messages of 2 MiB)."""
    def make():
        dummies = job.beside("benchmarks/exchange/exchange.py")
        return [dummies.measure(100000, job.build / "bin") for _ in range(3)]
    runs = job.once("exchange", make)
    passes, ms = min((found[kind] for found, _ in runs), key=lambda f: f[1])
    plain = min(p for _, p in runs)
    return f"{ms:.2f} ms per pass, {passes:.1f} passes per step; MPI alone {plain:.2f} ms there and back: {ms / plain:.1f} times", ms <= times * plain
