# SPDX-License-Identifier: Apache-2.0
"""Light structures in viscous fluids: flaps, the tube, walls of closed fluids."""
import pathlib
import re
import resource
import zlib

import numpy as np

import atlas
import couplet
from couplet.runs.process import RunFailed


# -- tube -------------------------------------------------------------------------------------------------------------
TUBE = "configs/tube-3d/case.yaml"
ROBIN_TUBE = ("coupling.order=structure-first", "participants.fluid.boundaries.wall.impedance=structure",
         "participants.solid.interface={surface-density: true}")
IQN, AITKEN = ("coupling.acceleration.type=iqn-ils",), ("coupling.acceleration={type: aitken}",)
CHOICES = {"Robin": ("semi-implicit", ROBIN_TUBE + IQN), "implicit Aitken": ("implicit", AITKEN), "implicit IQN-ILS": ("implicit", IQN)}


def tube(job, choice):
    """Passes of each step and cpu seconds of all programs for 20 steps of 0.1 ms."""
    scheme, more = CHOICES[choice]
    run = job.coupled_run(job.root / TUBE, "tube-" + choice.replace(" ", "-"), [
        "simulation.end-time=2 ms", "simulation.output.interval=0", "simulation.checkpoint.interval=0", f"coupling.scheme={scheme}", *more])
    rows = couplet.read_csv(run.folder / "coupler" / "residuals.csv")
    return np.unique(rows["step"], return_counts=True)[1], run.cost.cpu, rows


def passes(job):
    counts, _, rows = tube(job, "Robin")
    number, residual = (np.array(rows[name]) for name in ("iteration", "relative residual"))
    guess, last = residual[number == 1], residual[np.cumsum(counts) - 1]
    factor = np.mean(np.log10(last / guess) / (counts - 1))
    return (f"{counts.mean():.2f} on average, {counts.max()} at most, {len(counts)} steps; the guess leaves {np.median(guess):.2g} of the load, and a "
            f"pass takes {-factor:.2f} decades off"), bool(counts.mean() <= 4.5)


def cheaper(job, than, times):
    (few, seconds, _), (many, other, _) = tube(job, "Robin"), tube(job, than)
    return f"{other / seconds:.2f} times ({other:.1f} and {seconds:.1f} cpu s; {many.mean():.1f} and {few.mean():.1f} passes per step)", \
        bool(other >= times * seconds)


# -- flap -------------------------------------------------------------------------------------------------------------
FLAP = "configs/perpendicular-flap/case.yaml"
END = 0.2  # s; long rows go on to 0.6 s


def flap(job, rho, mu, scheme="auto", dt=0.01, end=END, more=()):
    """One rung: tip displacements, coupling iterations per step, cpu seconds of all programs, which hold about 0.5 s of start-up (not
    known of a run that failed), and where it ended if the mesh did not allow more."""
    def make():
        name = f"ladder-{rho}-{mu}-{scheme}-{dt}-{end}-{zlib.crc32(' '.join(more).encode())}"  # runs are kept by their folder
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        arguments = [
            f"simulation.end-time={end}", f"simulation.time-step={dt}", "simulation.max-step-halvings=0",
            f"simulation.output.interval={end}", "simulation.checkpoint.interval=0",
            "participants.fluid.boundaries.inlet.ramp=0.4", "participants.fluid.pressure-tolerance=1e-8", f"participants.fluid.viscosity={mu}",
            f"participants.solid.material.density={rho}", f"coupling.scheme={scheme}",
            "coupling.convergence.max-iterations=100", *more]
        ended = ""
        try:
            job.coupled(job.root / FLAP, name, arguments)
        except RunFailed as failure:
            found = re.search(r"from t = ([\d.e-]+) s makes cell \d+ at \([^)]*\) intersect itself", str(failure))
            if not found:
                raise
            ended = f"to {found[1]} s, where the mesh crosses itself: "
        folder = job.scratch / name
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        tip = couplet.read_csv(folder / "solid" / "probes.csv")["tip x [m]"]
        passes = len(couplet.read_csv(folder / "coupler" / "residuals.csv")["iteration"])
        return tip, passes / len(tip), after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, ended
    return job.once(("flap", rho, mu, scheme, dt, end, more), make)


def zigzag(tip):
    """rms third difference over rms first difference of the last 8 steps: below 0.1 smooth, above 1 a two-step oscillation."""
    last = tip[-9:]
    return float(np.sqrt(np.mean(np.diff(last, 3) ** 2) / np.mean(np.diff(last) ** 2)))


def rung(job, rho, mu, dt=0.01, end=END):
    tip, passes, seconds, ended = flap(job, rho, mu, dt=dt, end=end)
    value = zigzag(tip)
    # Beyond the short rows' end the bar asks for 0.6 s or what the mesh allows.
    far = len(tip) == round(end / dt) or (ended and end > END and len(tip) * dt >= END)
    return f"{ended}{len(tip)} steps, tip {tip[-1]:.5f} m, {passes:.1f} passes, {'' if ended else f'{seconds:.1f} cpu s, '}zigzag {value:.3f}", bool(far and value < 0.15)


def beside_implicit(job, rho, mu):
    """Tip within 1 % of implicit at a quarter of the step, cpu beside implicit at the same step."""
    tip, _, seconds, ended = flap(job, rho, mu)
    fine, _, _, fine_ended = flap(job, rho, mu, "implicit", 0.0025)
    same, _, other, same_ended = flap(job, rho, mu, "implicit")
    if ended or fine_ended or same_ended:  # the tips are of different times
        return f"default {ended or 'to the end'}; implicit {same_ended or 'to the end'}; implicit at 0.0025 s {fine_ended or 'to the end'}", False
    gap, ratio = abs(tip[-1] / fine[-1] - 1), seconds / other
    return f"tips {tip[-1]:.5f} m and {fine[-1]:.5f} m, {100 * gap:.2f} % apart (implicit at 0.01 s: {same[-1]:.5f} m); cpu {ratio:.2f} of implicit's", \
        gap <= 0.01 and ratio <= 0.7


COARSE = ["participants.solid.mesh-parameters={n_side: 40, n_tip: 4}", *(
    f"participants.{name}.mesh-parameters={{n_side: 20, n_tip: 2, growth: 1.3, wall_growth: 1.3, wall_cells: 5}}" for name in ("fluid", "mover"))]


def order(job, mu, more=(), mesh=()):
    """Mean slope of the successive differences of the tip over four steps."""
    tips = [flap(job, 3000, mu, dt=dt, more=(*mesh, *more, "coupling.convergence.relative=1e-7"))[0][-1]
            for dt in (0.01, 0.005, 0.0025, 0.00125)]
    gaps = np.abs(np.diff(tips))
    slope = np.log2(gaps[0] / gaps[-1]) / 2
    return f"{slope:.2f}, differences {', '.join(f'{g:.1e}' for g in gaps)} m", slope >= 1.8


# -- flap 3d ----------------------------------------------------------------------------------------------------------
FLAP_3D = "configs/perpendicular-flap/flap-3d.yaml"
ROBIN_FLAP = ("coupling.order=structure-first", "participants.fluid.boundaries.flap.impedance=structure",
         "participants.solid.interface={surface-density: true}")


def flap_3d(job, rho, *more):
    """Tip at the end of each step and passes of each."""
    name = f"flap-3d-{rho}-{len(more)}-{'-'.join(m.split('=')[0].split('.')[-1] for m in more)}"
    folder = job.coupled(job.root / FLAP_3D, name, [f"participants.solid.material.density={rho}", *more])
    tip = couplet.read_csv(folder / "solid" / "probes.csv")["tip x [m]"]
    return tip, np.unique(couplet.read_csv(folder / "coupler" / "residuals.csv")["step"], return_counts=True)[1]


def rung_3d(job, rho):
    tip, passes = flap_3d(job, rho)
    value = zigzag(tip)
    return f"{len(tip)} steps, tip {tip[-1]:.5f} m, {passes.mean():.1f} passes, zigzag {value:.3f}", len(tip) == 20 and value < 0.15


def beside_implicit_3d(job):
    tip, fine = flap_3d(job, 10)[0], flap_3d(job, 10, "coupling.scheme=implicit", *IQN, "simulation.time-step=0.0025")[0]
    same = flap_3d(job, 10, "coupling.scheme=implicit", *IQN)[0]
    gap = abs(tip[-1] / fine[-1] - 1)
    return f"tips {tip[-1]:.5f} m and {fine[-1]:.5f} m, {100 * gap:.2f} % apart (implicit at 0.01 s: {same[-1]:.5f} m)", gap <= 0.01


def robin_3d(job):
    tip, passes = flap_3d(job, 10, *ROBIN_FLAP, *IQN)
    other, without = flap_3d(job, 10, *IQN)
    gap = np.abs(tip - other).max() / np.abs(other).max()
    return f"{gap:.1e} apart; {passes.mean():.2f} passes per step, {without.mean():.2f} without Robin", len(tip) == 20 and gap <= 1e-3


# -- walls ------------------------------------------------------------------------------------------------------------
def case(job, name, overrides=()):
    """The coupler's tables of a whole run of configs/<name>."""
    def make():
        run = job.case_run(job.root / "configs" / name / "case.yaml", job.scratch / f"{name}-{len(overrides)}", list(overrides), {}, 3000)
        return run.folder / "coupler", run.cost
    folder, _ = job.once(("walls", name, tuple(overrides)), make)
    return couplet.read_csv(folder / "volume.csv"), couplet.read_csv(folder / "residuals.csv")


def volume_of_a_step(job, name, fluid, bound, overrides=()):
    volume, passes = case(job, name, overrides)
    change, inflow = (np.diff(volume[f"{fluid} {what} [m^3]"], prepend=0) for what in ("volume change", "inflow"))
    worst = float(np.max(np.abs(change - inflow)) / np.max(np.abs(inflow)))
    total = float(np.max(np.abs(volume[f"{fluid} volume error [m^3]"])) / np.max(np.abs(volume[f"{fluid} inflow [m^3]"])))
    return f"{worst:.1e}, of the whole inflow {total:.1e}, {len(change)} steps", max(worst, total) <= bound


def nearly_closed(job, kind, most=None):
    """Passes per step of the box with an opening of one cell, in boxes of 8, 16 and 32 cells per side, 10 steps."""
    found = []
    for n in (8, 16, 32):
        sets = [f"participants.{name}.mesh-parameters={{n: {n}}}" for name in ("fluid", "lid", "mover")]
        run = job.case_run(job.root / "configs" / "closed-cavity" / "nearly-closed.yaml", job.scratch / f"nearly-{kind}-{n}",
                           [*sets, "simulation.end-time=0.2", f"coupling.acceleration.type={kind}"], {}, 600)
        rows = couplet.read_csv(run.folder / "coupler" / "residuals.csv")
        found.append(float(np.unique(rows["step"], return_counts=True)[1].mean()))
    return ", ".join(f"{passes:.1f}" for passes in found), None if most is None else max(found) <= most


def passes_of_a_step(job, name, overrides=()):
    _, rows = case(job, name, overrides)
    counts = np.unique(rows["step"], return_counts=True)[1]
    return f"{counts.mean():.2f} on average, {counts.max()} at most", counts.mean() <= 6


def robin(job, panel, most, inverses):
    """Largest mean number of passes over mass ratios and two decades of steps."""
    runner = atlas.Runner(job.build, pathlib.Path(job.scratch) / f"robin-{panel.replace(' ', '-')}")
    values = {(i, dt): atlas.maps()["strong-robin"].run(panel, i, dt, runner)[0] for i in inverses for dt in (1e-4, 1e-3, 1e-2)}
    worst = max(values, key=lambda key: values[key] if np.isfinite(values[key]) else np.inf)
    return f"{values[worst]:.2f} at most, for {worst[0]:g} and steps of {worst[1]:g} s", \
        all(np.isfinite(v) for v in values.values()) and values[worst] <= most
