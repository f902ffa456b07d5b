# SPDX-License-Identifier: Apache-2.0
"""Measures of strong coupling: light structures in viscous fluids."""
import re
import resource
import zlib

import numpy as np

import couplet
from couplet.runs.process import RunFailed

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


def zigzag_of_implicit(job, rho, mu, end):
    """What of the zigzag is the flap itself: that of the implicit scheme with the same step."""
    tip, passes, seconds, ended = flap(job, rho, mu, "implicit", end=end, more=("coupling.acceleration.type=iqn-ils",))
    return f"{ended}{len(tip)} steps, tip {tip[-1]:.5f} m, {passes:.1f} passes, {'' if ended else f'{seconds:.1f} cpu s, '}zigzag {zigzag(tip):.3f}", None


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


def renewals(job, rho):
    """A heavy flap never repeats the fluid's first part: counted, since its cost is below what a busy machine resolves."""
    folder = job.scratch / "heavy"
    result = job.run(["mpirun", "--oversubscribe"] + sum(
        ([":"] * (i > 0) + ["-n", "1", job.build / "bin" / program, job.root / FLAP,
                            f"--set=simulation.output.folder={folder}", "--set=simulation.end-time=0.3",
                            f"--set=participants.solid.material.density={rho}"]
         for i, program in enumerate(("coupler", "fluid_solver", "solid_solver", "mesh_mover"))), []))
    sentence = next((l for l in result.stdout.splitlines() if "friction was recomputed" in l), "")
    words = sentence.split(" in ", 1)[-1].split(";")[0]
    return words or "silent", result.returncode == 0 and words.startswith("0 of 30")


COARSE = ["participants.solid.mesh-parameters={n_side: 40, n_tip: 4}", *(
    f"participants.{name}.mesh-parameters={{n_side: 20, n_tip: 2, growth: 1.3, wall_growth: 1.3, wall_cells: 5}}" for name in ("fluid", "mover"))]


def order(job, mu, more=(), mesh=()):
    """Mean slope of the successive differences of the tip over four steps."""
    tips = [flap(job, 3000, mu, dt=dt, more=(*mesh, *more, "coupling.convergence.relative=1e-7"))[0][-1]
            for dt in (0.01, 0.005, 0.0025, 0.00125)]
    gaps = np.abs(np.diff(tips))
    slope = np.log2(gaps[0] / gaps[-1]) / 2
    return f"{slope:.2f}, differences {', '.join(f'{g:.1e}' for g in gaps)} m", slope >= 1.8


def implicit_at_its_edge(job, on_guess, judged=True):
    folder = job.scratch / f"edge-{on_guess}"
    arguments = [
        "simulation.end-time=0.15", "simulation.max-step-halvings=0", "simulation.output.interval=0.15", "simulation.checkpoint.interval=0",
        "participants.fluid.boundaries.inlet.ramp=0.4", "participants.fluid.pressure-tolerance=1e-8", "participants.fluid.viscosity=10",
        "participants.solid.material.density=1", "coupling.scheme=implicit", "coupling.convergence.max-iterations=100",
        f"coupling.mesh-on-guess={'true' if on_guess else 'false'}"]
    try:
        job.case_run(job.root / FLAP, folder, arguments, {}, 3000)
    except RunFailed:
        pass  # how far it came is the answer
    tip = couplet.read_csv(folder / "solid" / "probes.csv")["tip x [m]"]
    value = f"{len(tip)} of 15 steps, zigzag {zigzag(tip):.3f}" if len(tip) > 9 else f"{len(tip)} of 15 steps"
    return value, len(tip) == 15 if judged else None
