# SPDX-License-Identifier: Apache-2.0
"""The coupler: added mass, acceleration, maps, schemes, programs of others."""
import json
import os
import re
import sys

import numpy as np

import couplet
from validation.parts.flagship import FLAP, steps_of


# -- added mass -------------------------------------------------------------------------------------------------------
RAMP = ["participants.fluid.boundaries.inlet.ramp=0.4"]
LIGHT = [*RAMP, "participants.solid.material.density=1", "simulation.output.interval=1", "simulation.checkpoint.interval=10"]


def tip(folder):
    probes = couplet.read_csv(folder / "solid" / "probes.csv")
    return probes["time [s]"], probes["tip x [m]"]


# -- added mass: two analytic participants, 40 modes ------------------------------------------------------------------
def added_mass(job, test, keys):
    """Recorded properties of one test: {key: text} and whether it passed."""
    tests, _ = job.gtest("coupling_added_mass")
    found = next(v for k, v in tests.items() if test in k)
    return {k: v for k, v in found.items() if re.match(keys, k)}, found["passed"]


def explicit_growth(job):
    found, passed = added_mass(job, "grows_by_the_mass_ratio", "growth_")
    off = [abs(float(v) * float(k.split("_")[1]) - 1) for k, v in found.items()]
    return f"{100 * max(off):.2f} % off at most, {len(off)} runs", passed and len(off) >= 4 and max(off) <= 0.02


def explicit_bounded(job):
    found, passed = added_mass(job, "is_bounded_below", "amplitude_")
    return ", ".join(f"{k.split('_')[1]}: {v}" for k, v in found.items()) + " of the bound", passed and len(found) == 2


def contraction(job):
    found, passed = added_mass(job, "plain_iteration_contracts", "contraction_")
    off = [abs(float(v) / float(k.split("_")[1]) - 1) for k, v in found.items()]
    return f"{100 * max(off):.3f} % off at most", passed and max(off) <= 0.02


def iterations(job, method, most):
    found, _ = added_mass(job, "iterations_of", method + "_")
    numbers = {float(k.split("_")[1]): v.split() for k, v in found.items()}
    met = all(int(numbers[r][1]) <= bound for r, bound in zip((0.5, 5, 50), most))
    return "; ".join(f"r {r:g}: {numbers[r][1]} at most, {numbers[r][0]} on average" for r in sorted(numbers)), met


def very_light(job):
    found, passed = added_mass(job, "holds_at_a_hundredth", "ils_100")
    mean, most = found["ils_100"].split()
    return f"{most} at most, {mean} on average", passed and int(most) <= 30


# -- added mass: the finite-volume fluid under an elastic wall ---------------------------------------------------------
def string(job, pattern, wanted):
    """Numbers of tests/coupling/string/string.py by their claim; met if that many were found and none failed."""
    def make():
        file = job.scratch / "string.json"
        job.run([sys.executable, job.root / "tests/coupling/string/string.py", job.build / "bin", job.build / "bin/tests", file], 3600)
        return json.loads(file.read_text())
    result = job.once("string", make)
    found = {k: v for k, v in result["numbers"].items() if re.search(pattern, k)}
    return "; ".join(f"{k}: {v:.5g}" for k, v in found.items()), len(found) >= wanted and not set(found) & set(result["failed"])


# -- acceleration on the flap -----------------------------------------------------------------------------------------
def light_flap(job, scheme, kind, end=0.6):
    return job.coupled(job.root / FLAP, f"flap-light-{scheme}-{kind}", [
        *LIGHT, f"simulation.end-time={end}", f"coupling.scheme={scheme}", f"coupling.acceleration.type={kind}",
        "coupling.acceleration.initial-relaxation=0.2"])


def light_iterations(job):
    steps = steps_of(light_flap(job, "implicit", "iqn-ils"))
    mean = steps[:, 0].mean()
    return f"{mean:.2f} on average, {steps[:, 0].max():.0f} at most, {len(steps)} steps", bool(mean <= 4 and len(steps) >= 60)


# -- mapping ----------------------------------------------------------------------------------------------------------
def finer_solid(job, factor, kind, shift=0.0):
    """The flap with `factor` of the solid's faces along one of the fluid's, to the first maximum."""
    geo = (job.root / "configs/perpendicular-flap/solid.geo").read_text()
    side, across = {2: (160, 16), 3: (240, 24), 1: (80, 8)}[factor]
    if shift:
        side, across = 147, 15
    geo = re.sub(r"n_side = \d+;", f"n_side = {side};", re.sub(r"n_tip = \d+;", f"n_tip = {across};", geo))
    mesh = job.scratch / f"solid-{side}.geo"
    mesh.write_text(geo)
    return job.coupled(job.root / FLAP, f"flap-{side}-{kind}", [
        "simulation.end-time=0.8", "simulation.output.interval=1", "simulation.checkpoint.interval=10",
        f"participants.solid.mesh={mesh}", f"coupling.mapping.type={kind}"])


def non_matching(job, factor, shift=0.0):
    wanted = max(tip(finer_solid(job, 2, "nearest"))[1])
    gaps = {kind: max(tip(finer_solid(job, factor, kind, shift))[1]) / wanted - 1 for kind in ("projection", "rbf")}
    return ", ".join(f"{kind} {100 * gap:+.2f} %" for kind, gap in gaps.items()), all(abs(g) <= 0.01 for g in gaps.values())


# -- tubes ------------------------------------------------------------------------------------------------------------
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


def tube_iterations(job):
    steps = steps_of(tube(job, "implicit", "coupling.scheme=implicit"))
    return f"{steps[:, 0].mean():.2f} on average, {steps[:, 0].max():.0f} at most, {len(steps)} steps", bool(steps[:, 0].mean() <= 9.1 and len(steps) == 85)


def peak(job):
    found = {s: radial(tube(job, s, f"coupling.scheme={s}")) for s in ("semi-implicit", "implicit")}
    off = {s: y.max() / PEAK - 1 for s, (_, y) in found.items()}
    text = "; ".join(f"{s}: {y.max():.3e} m at {1e3 * t[y.argmax()]:.1f} ms, {100 * off[s]:+.1f} %" for s, (t, y) in found.items())
    return text, max(map(abs, off.values())) <= 0.03


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


# -- runs -------------------------------------------------------------------------------------------------------------
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


# -- strangers --------------------------------------------------------------------------------------------------------
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
