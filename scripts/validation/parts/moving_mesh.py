# SPDX-License-Identifier: Apache-2.0
"""Measures of meshes that move far and of bodies with prescribed motion."""
import math

import numpy as np

import couplet

PLATE = "configs/moving-mesh/case.yaml"
BEND = ("sin(pi*t*x)/(pi*t) - y*sin(pi*t*x) - x", "(cos(pi*t*x)-1)/(-pi*t) + y*cos(pi*t*x) - y")
MOTIONS = {
    "shift by 0.5": {"translation": ["0", "0.5*t"]}, "turn by 45 degrees": {"angle": "pi/4*t"},
    "turn by 60 degrees": {"angle": "pi/3*t"}, "turn by 90 degrees": {"angle": "pi/2*t"}, "bend to a half circle": {"displacement": BEND}}


def yaml_of(motion):
    return "{" + ", ".join(f"{k}: " + (f'"{v}"' if isinstance(v, str) else "[" + ", ".join(f'"{e}"' for e in v) + "]")
                           for k, v in motion.items()) + "}"


def move(job, name, motion, more=(), steps=50, end=1, timeout=900):
    """Rows of quality.csv of the mover on its own, and whether it came to the end. `motion`: of the plate."""
    def make():
        folder = job.scratch / ("move-" + name.replace(" ", "-"))
        command = [job.build / "bin" / "mesh_mover", job.root / PLATE]
        for key in (f"simulation.output.folder={folder}", f"simulation.end-time={end}", f"simulation.time-step={end / steps}",
                    f"simulation.output.interval={end}", "simulation.max-step-halvings=0", "simulation.checkpoint.interval=0",
                    f"participants.mover.boundaries.plate.motion={yaml_of(motion)}", *more):
            command += ["--set", key]
        result = job.run(command, timeout)
        file = folder / "mover" / "quality.csv"
        if not file.exists():
            raise RuntimeError((result.stderr or result.stdout)[-300:])
        return couplet.read_csv(file), result.returncode == 0, folder / "mover"
    return job.once(("move", name), make)


def keys(method, form, chi, volumes="reference"):
    return [f"participants.mover.{k}={v}" for k, v in
            (("method", method), ("form", form), ("stiffening", chi), ("stiffening-volumes", volumes))]


def end_of(rows):
    return (f"edge ratio {rows['largest edge ratio [1]'][-1]:.2f}, scaled Jacobian {rows['least scaled Jacobian [1]'][-1]:.3f}, "
            f"V/V0 {rows['least volume ratio [1]'][-1]:.3f}, f_A {rows['largest f_A [1]'][-1]:.2f}, f_AR {rows['largest f_AR [1]'][-1]:.2f}")


def plate(job, motion, method, chi, holds=True, form="incremental", volumes="current"):
    """One mesh of the table of the thesis: valid to the end or not."""
    name = f"{motion} {method} {form} {chi} {volumes}"
    rows, valid, _ = move(job, name, MOTIONS[motion], keys(method, form, chi, volumes))
    got = f"all cells valid; {end_of(rows)}" if valid else f"refused at {100 * rows['time [s]'][-1]:.0f} % of the way"
    return got, valid == holds


def last_displacement(folder):
    import h5py
    with h5py.File(next(folder.glob("*.h5"))) as file:
        last = file["steps"][sorted(file["steps"])[-1]]
        return float(np.max(np.abs(last["coordinates"][...] - file["mesh/coordinates"][...])))


def back(job, method, form, chi, limit=None):
    """+0.5 and back by -0.5; the shortest edge is 0.01 m."""
    volumes = "current" if form == "incremental" else "reference"
    rows, valid, folder = move(job, f"return {method} {form} {chi}", {"translation": ["0", "t < 1 ? 0.5*t : 0.5*(2-t)"]},
                               keys(method, form, chi, volumes), steps=100, end=2)
    left = last_displacement(folder) / 0.01 if valid else math.inf
    return f"largest displacement left over the shortest edge {left:.1e}", valid and (limit is None or left <= limit)


def cycles(job, method, form, degrees, n=100, chi=0.5, limit=1e-6):
    """Least scaled Jacobian at the outer ends of the first and the last oscillation."""
    angle = f"{math.radians(degrees)}*sin(2*pi*t)"
    volumes = "current" if form == "incremental" else "reference"
    rows, valid, folder = move(job, f"cycles {method} {form} {degrees}", {"angle": angle}, keys(method, form, chi, volumes),
                               steps=20 * n, end=n, timeout=1800)
    t, j = rows["time [s]"], rows["least scaled Jacobian [1]"]
    if not valid:
        return f"refused after {t[-1]:.2f} cycles", None if limit is None else False
    first, last = j[t < 1.001].min(), j[t > n - 1.001].min()
    return (f"least scaled Jacobian {first:.4f} in the first cycle, {last:.4f} in the last; left at the end "
            f"{last_displacement(folder) / 0.01:.1e} of the shortest edge"), limit is None or abs(last - first) <= limit


def in_space(job, mesh, boundaries, method, chi):
    rows, valid, _ = move(job, f"{mesh} {method}", {}, [
        f"participants.mover.mesh={mesh}.geo", "participants.mover.dimension=3", *keys(method, "total", chi),
        f"participants.mover.boundaries={boundaries}"], steps=10)
    return f"all cells valid; {end_of(rows)}" if valid else f"refused at {100 * rows['time [s]'][-1]:.0f} % of the way", valid


def swinging(job, frame):
    motion = ['participants.fluid.motion={translation: ["-5/(2*pi)*sin(2*pi*0.2*t)", 0]}'] if frame else []
    folder = job.case("oscillating-cylinder", ("simulation.time-step=0.02", *motion)).folder
    return job.beside("configs/oscillating-cylinder/morison.py"), folder / "fluid"


def morison(job, frame):
    module, folder = swinging(job, frame)
    drag, mass = module.averages(folder)
    fitted = module.fit(folder)
    return (f"c_d {drag:.4f}, c_m {mass:.4f} by Fourier averages; {fitted[0]:.4f}, {fitted[1]:.4f} by least squares",
            abs(drag / 2.09 - 1) <= 0.02 and abs(mass / 1.45 - 1) <= 0.02)


def both_frames(job):
    values = []
    for frame in (False, True):
        module, folder = swinging(job, frame)
        values.append(module.averages(folder))
    gaps = [abs(a / b - 1) for a, b in zip(*values)]
    return f"c_d {100 * gaps[0]:.1e} %, c_m {100 * gaps[1]:.1e} % apart", max(gaps) <= 0.01


def pitching(job):
    """Two periods of a plate that pitches through +-60 degrees in a stream."""
    folder = job.case("pitching-plate").folder
    rows = couplet.read_csv(folder / "fluid" / "coefficients.csv")
    t, lift = rows["time [s]"], rows["plate lift [-]"]
    done = bool(t[-1] > 16 - 1e-6 and np.isfinite(lift).all())
    return f"to t = {t[-1]:g} s, lift between {lift[t > 8].min():.2f} and {lift[t > 8].max():.2f} in the second period", done


def pinch(job, with_gap):
    more = () if with_gap else ("participants.fluid.gaps={}",)
    folder = job.case("closing-gap", more).folder
    return couplet.read_csv(folder / "fluid" / "balance.csv"), folder / "fluid"


def closes(job):
    """A channel whose lid comes down to 1 % of the height and goes up again."""
    rows, folder = pinch(job, True)
    gap = couplet.read_csv(folder / "gaps.csv")
    least = float(np.nanmin(gap["slot opening [m]"]))
    t, cells = rows["time [s]"], gap["slot blocked cells [-]"]
    hold = (t > 3.1) & (t < 3.5)
    leak = float(np.max(np.abs(rows["mass defect [m^3/s]"][hold])))
    return (f"least opening {least:.4f} m of 0.5 m, {int(cells.max())} cells blocked, all free at the end: {cells[-1] == 0}; while it is shut the boundaries let in "
            f"and out the same to {leak:.1e} m^3/s", least < 0.0101 * 0.5 and cells[-1] == 0 and bool(t[-1] > 6 - 1e-6) and leak < 1e-6)


def cavity_5000(job):
    """Beside its own extrapolation from 64^2, 96^2 and 128^2."""
    module = job.beside("configs/cavity/extrema.py")
    ghia = {"u_min": -0.43643, "v_max": 0.43648, "v_min": -0.55408}
    found = {}
    for n in (64, 96, 128):
        folder = job.case("cavity", (f"participants.fluid.mesh-parameters={{n: {n}, bump: 0.1}}", "participants.fluid.viscosity=2e-4",
                                                         "simulation.end-time=400", "simulation.time-step=0.1", "simulation.output.interval=400"), timeout=14400).folder
        found[n] = module.extrema(folder / "fluid")
    limit = {k: found[128][k] + (found[128][k] - found[96][k]) / ((128 / 96) ** 2 - 1) for k in ghia}
    off = {k: found[128][k] / limit[k] - 1 for k in ghia}
    return ("; ".join(f"{k} {found[128][k]:.5f} ({100 * off[k]:+.2f} % of {limit[k]:.5f}, Ghia {g})" for k, g in ghia.items()),
            all(abs(v) <= 0.01 for v in off.values()))


def speed(job, n):
    """benchmarks/mover: processor time of a step of mesh motion, without set-up, over that of a step of the fluid (one pressure equation and the predictor)."""
    result = job.done([job.root / "benchmarks/mover", "--build", job.build, "--n", n], timeout=7200)
    seconds = {row.split("|")[0].strip(): float(row.split("|")[1]) for row in result.stdout.splitlines()[1:] if "|" in row}
    fluid = seconds.pop("a step of the fluid")
    return (f"a step of the fluid {fluid:.3f} s; " + "; ".join(f"{k} {v / fluid:.2f} times that" for k, v in seconds.items()),
            seconds["laplacian, total"] < 1.5 * fluid and seconds["pseudo-solid, total"] < 5 * fluid)
