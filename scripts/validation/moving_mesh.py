# SPDX-License-Identifier: Apache-2.0
"""Bars of meshes that move far and of bodies with prescribed motion."""
import math
import re

import numpy as np

import couplet
from validation.job import Bar
from validation.parts.fluid.speed import ratio, second_core

SOURCES = ("common/base", "common/parallel", "common/linalg", "common/mesh", "common/fv", "common/elasticity", "mesh_mover",
           "fluid_solver", "configs/moving-mesh", "configs/oscillating-cylinder", "configs/cylinder", "configs/closing-gap",
           "configs/backward-step", "configs/pitching-plate", "configs/cavity", "configs/taylor-couette")
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


def plate(motion, method, chi, holds=True, form="incremental", volumes="current"):
    """One mesh of the table of the thesis: valid to the end or not."""
    def measure(job):
        name = f"{motion} {method} {form} {chi} {volumes}"
        rows, valid, _ = move(job, name, MOTIONS[motion], keys(method, form, chi, volumes))
        got = f"all cells valid; {end_of(rows)}" if valid else f"refused at {100 * rows['time [s]'][-1]:.0f} % of the way"
        return got, valid == holds
    return measure


def third(motion):
    """The third method beside the two others, all from the reference mesh."""
    def measure(job):
        least, said = {}, []
        for method, chi in (("rotations", 0.5), ("laplacian", 1), ("pseudo-solid", 1)):
            rows, valid, _ = move(job, f"{motion} {method} total {chi} reference", MOTIONS[motion], keys(method, "total", chi))
            least[method] = rows["least scaled Jacobian [1]"][-1] if valid else -1
            said.append(f"{method} " + (f"{least[method]:.3f}, edge ratio {rows['largest edge ratio [1]'][-1]:.2f}" if valid
                                        else f"refused at {100 * rows['time [s]'][-1]:.0f} % of the way"))
        best = max(least.values())
        return "scaled Jacobian: " + "; ".join(said), 0 < best == least["rotations"]
    return measure


def f_ar(job):
    values = {chi: move(job, f"shift by 0.5 pseudo-solid incremental {chi} current", MOTIONS["shift by 0.5"],
                        keys("pseudo-solid", "incremental", chi, "current"))[0] for chi in (0, 1, 2)}
    at = min(v["time [s]"][-1] for v in values.values())
    got = {chi: float(v["largest f_AR [1]"][np.argmin(abs(v["time [s]"] - at))]) for chi, v in values.items()}
    return f"at {at:.2f} of the way {got[0]:.2f} (chi 0), {got[1]:.2f} (1), {got[2]:.2f} (2)", got[1] < got[0] and got[2] < got[0]


def last_displacement(folder):
    import h5py
    with h5py.File(next(folder.glob("*.h5"))) as file:
        last = file["steps"][sorted(file["steps"])[-1]]
        return float(np.max(np.abs(last["coordinates"][...] - file["mesh/coordinates"][...])))


def back(method, form, chi, limit=None):
    """+0.5 and back by -0.5; the shortest edge is 0.01 m."""
    def measure(job):
        volumes = "current" if form == "incremental" else "reference"
        rows, valid, folder = move(job, f"return {method} {form} {chi}", {"translation": ["0", "t < 1 ? 0.5*t : 0.5*(2-t)"]},
                                   keys(method, form, chi, volumes), steps=100, end=2)
        left = last_displacement(folder) / 0.01 if valid else math.inf
        return f"largest displacement left over the shortest edge {left:.1e}", valid and (limit is None or left <= limit)
    return measure


def cycles(method, form, degrees, n=100, chi=0.5, limit=1e-6):
    """Least scaled Jacobian at the outer ends of the first and the last oscillation."""
    def measure(job):
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
    return measure


def in_space(mesh, boundaries, method, chi):
    def measure(job):
        rows, valid, _ = move(job, f"{mesh} {method}", {}, [
            f"participants.mover.mesh={mesh}.geo", "participants.mover.dimension=3", *keys(method, "total", chi),
            f"participants.mover.boundaries={boundaries}"], steps=10)
        return f"all cells valid; {end_of(rows)}" if valid else f"refused at {100 * rows['time [s]'][-1]:.0f} % of the way", valid
    return measure


SPHERE = '{walls: {type: fixed}, sphere: {type: moving, motion: {translation: ["t", "0", "0"]}}}'
FLAP = ('{flap: {type: moving, motion: {displacement: ["(1-cos(pi/8*t*y))/(pi/8*t) + (x-2)*(cos(pi/8*t*y)-1)", '
        '"sin(pi/8*t*y)/(pi/8*t) - y - (x-2)*sin(pi/8*t*y)", "0"]}}, floor: {type: fixed}, '
        'front: {type: slip}, back: {type: slip}, lid: {type: slip}, ends: {type: slip}}')


def tested(executable, pattern):
    def measure(job):
        tests, _ = job.gtest(executable, pattern)
        return f"{sum(t['passed'] for t in tests.values())} of {len(tests)} tests passed", all(t["passed"] for t in tests.values())
    return measure


def ranks(pattern):
    def measure(job):
        passed, total, _, _ = job.ctest(pattern)
        return f"{passed} of {total} passed", total >= 3 and passed == total
    return measure


def swinging(job, frame):
    motion = ['participants.fluid.motion={translation: ["-5/(2*pi)*sin(2*pi*0.2*t)", 0]}'] if frame else []
    folder, _ = job.solve("fluid_solver", "oscillating-cylinder", ("simulation.time-step=0.02", *motion))
    return job.beside("configs/oscillating-cylinder/morison.py"), folder / "fluid"


def morison(frame):
    def measure(job):
        module, folder = swinging(job, frame)
        drag, mass = module.averages(folder)
        fitted = module.fit(folder)
        return (f"c_d {drag:.4f}, c_m {mass:.4f} by Fourier averages; {fitted[0]:.4f}, {fitted[1]:.4f} by least squares",
                abs(drag / 2.09 - 1) <= 0.02 and abs(mass / 1.45 - 1) <= 0.02)
    return measure


def both_frames(job):
    values = []
    for frame in (False, True):
        module, folder = swinging(job, frame)
        values.append(module.averages(folder))
    gaps = [abs(a / b - 1) for a, b in zip(*values)]
    return f"c_d {100 * gaps[0]:.1e} %, c_m {100 * gaps[1]:.1e} % apart", max(gaps) <= 0.01


def steady_coefficients(job):
    """2D-1 by output.coefficients on 5.5 k cells."""
    cell = "{cylinder: {patches: [cylinder], speed: 0.2, area: 0.1, centre: [0.2, 0.2, 0], length: 0.1}}"
    folder, _ = job.solve("fluid_solver", "cylinder", (
        "participants.fluid.mesh-parameters.n=24", "participants.fluid.boundaries.inlet.velocity=[\"1.2*y*(0.41-y)/0.41^2\", 0]",
        "simulation.end-time=8", "simulation.output.interval=8", "simulation.time-step=0.032",
        f"participants.fluid.output.coefficients={cell}"))
    rows = couplet.read_csv(folder / "fluid" / "coefficients.csv")
    drag, lift = rows["cylinder drag [-]"][-1], rows["cylinder lift [-]"][-1]
    return f"c_d {drag:.4f}, c_l {lift:.5f}", abs(drag / 5.57953523 - 1) <= 0.005 and abs(lift / 0.010618948 - 1) <= 0.1


def pulse(job):
    """2D-3: one pulse of the inlet."""
    cell = "{cylinder: {patches: [cylinder], speed: 1, area: 0.1}}"
    folder, _ = job.solve("fluid_solver", "cylinder", (
        "participants.fluid.mesh-parameters={n: 30, wake: 4, growth_wake: 1.009, side: 0.45}", "participants.fluid.boundaries.inlet.velocity=[\"6*y*(0.41-y)/0.41^2*sin(pi*t/8)\", 0]",
        "simulation.end-time=8", "simulation.output.interval=8", "simulation.time-step=0.004",
        f"participants.fluid.output.coefficients={cell}"))
    rows, probes = couplet.read_csv(folder / "fluid" / "coefficients.csv"), couplet.read_csv(folder / "fluid" / "probes.csv")
    lift, drag = float(np.max(rows["cylinder lift [-]"])), float(np.max(rows["cylinder drag [-]"]))
    difference = float((probes["front pressure [Pa]"] - probes["back pressure [Pa]"])[-1])
    return (f"largest lift {lift:.4f} ({100 * (lift / 0.47795 - 1):+.1f} %), drag {drag:.4f} (2.95092), dp(8 s) {difference:.4f} (-0.1116)",
            abs(lift / 0.47795 - 1) <= 0.03)


FRAME = ("participants.fluid.rotating-frame={speed: 1 rad/s}", "participants.fluid.boundaries={inner: {type: no-slip}, outer: {type: moving-wall, rotation: {speed: -1 rad/s}}}")


def torques(job, more=()):
    """On the two circles of configs/taylor-couette, with coefficients whose rho/2 U^2 A L is 1 N m; du/dr alone gives 1.047 on the inner one."""
    folder, _ = job.solve("fluid_solver", "taylor-couette", more)
    rows, exact = couplet.read_csv(folder / "fluid" / "coefficients.csv"), 16 * np.pi * 0.1 / 3
    inner, outer = -rows["inner moment [-]"][-1], rows["outer moment [-]"][-1]
    return (f"{inner:.4f} N m on the inner ({100 * (inner / exact - 1):+.2f} %), {outer:.4f} on the outer circle ({100 * (outer / exact - 1):+.2f} %)",
            abs(inner / exact - 1) <= 0.005 and abs(outer / exact - 1) <= 0.005)


def least_squares(job):
    module, folder = swinging(job, False)
    drag, mass = module.fit(folder)[:2]
    fourier = module.averages(folder)[0]
    return (f"c_d {drag:.4f} ({100 * (drag / 2.09 - 1):+.1f} %), c_m {mass:.4f} by least squares; c_d {fourier:.4f} ({100 * (fourier / 2.09 - 1):+.1f} %) "
            "by Fourier averages of the same force", abs(drag / 2.09 - 1) <= 0.02 and abs(mass / 1.45 - 1) <= 0.02)


def pitching(job):
    """Two periods of a plate that pitches through +-60 degrees in a stream."""
    folder, _ = job.solve("fluid_solver", "pitching-plate")
    rows = couplet.read_csv(folder / "fluid" / "coefficients.csv")
    t, lift = rows["time [s]"], rows["plate lift [-]"]
    done = bool(t[-1] > 16 - 1e-6 and np.isfinite(lift).all())
    return f"to t = {t[-1]:g} s, lift between {lift[t > 8].min():.2f} and {lift[t > 8].max():.2f} in the second period", done


def pinch(job, with_gap):
    more = () if with_gap else ("participants.fluid.gaps={}",)
    folder, _ = job.solve("fluid_solver", "closing-gap", more)
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


def saves(job):
    with_gap, without = pinch(job, True)[0], pinch(job, False)[0]
    shut = [r["sub-steps [-]"][(r["time [s]"] > 2.9) & (r["time [s]"] < 3.5)].mean() for r in (with_gap, without)]
    iterations = [r["pressure iterations so far [-]"][-1] for r in (with_gap, without)]
    return f"{shut[0]:.1f} sub-steps per step while it is shut, {shut[1]:.1f} without; {iterations[0]:.0f} iterations of the pressure, {iterations[1]:.0f} without", None


def hard_mesh(test):
    """A channel's parabola on it, with explicit and implicit viscous term: root mean square of the error over the largest velocity."""
    def measure(job):
        errors, passed = job.recorded("stability_fluid_step_sizes", test, "error")
        return f"error {', '.join(f'{e:.2e}' for e in errors)} of the largest velocity", passed
    return measure


def behind_step(n, judged):
    def measure(job):
        module = job.beside("configs/backward-step/lengths.py")
        folder, _ = job.solve("fluid_solver", "backward-step", (f"participants.fluid.mesh-parameters.n={n}",))
        found = module.lengths(folder / "fluid")
        off = {k: found[k] / v - 1 for k, v in module.GARTLING.items()}
        return ("; ".join(f"{k} {found[k]:.3f} ({100 * off[k]:+.1f} %)" for k in off),
                all(abs(v) <= 0.01 for v in off.values()) if judged else None)
    return measure


def cavity_5000(job):
    """Beside its own extrapolation from 64^2, 96^2 and 128^2."""
    module = job.beside("configs/cavity/extrema.py")
    ghia = {"u_min": -0.43643, "v_max": 0.43648, "v_min": -0.55408}
    found = {}
    for n in (64, 96, 128):
        folder, _ = job.solve("fluid_solver", "cavity", (f"participants.fluid.mesh-parameters={{n: {n}, bump: 0.1}}", "participants.fluid.viscosity=2e-4",
                                                         "simulation.end-time=400", "simulation.time-step=0.1", "simulation.output.interval=400"), timeout=14400)
        found[n] = module.extrema(folder / "fluid")
    limit = {k: found[128][k] + (found[128][k] - found[96][k]) / ((128 / 96) ** 2 - 1) for k in ghia}
    off = {k: found[128][k] / limit[k] - 1 for k in ghia}
    return ("; ".join(f"{k} {found[128][k]:.5f} ({100 * off[k]:+.2f} % of {limit[k]:.5f}, Ghia {g})" for k, g in ghia.items()),
            all(abs(v) <= 0.01 for v in off.values()))


def speed(n):
    """benchmarks/mover: processor time of a step of mesh motion, without set-up, over that of a step of the fluid (one pressure equation and the predictor)."""
    def measure(job):
        result = job.run([job.root / "benchmarks/mover", "--build", job.build, "--n", n], timeout=7200)
        if result.returncode != 0:
            raise RuntimeError((result.stderr or result.stdout)[-300:])
        seconds = {row.split("|")[0].strip(): float(row.split("|")[1]) for row in result.stdout.splitlines()[1:] if "|" in row}
        fluid = seconds.pop("a step of the fluid")
        return (f"a step of the fluid {fluid:.3f} s; " + "; ".join(f"{k} {v / fluid:.2f} times that" for k, v in seconds.items()),
                seconds["laplacian, total"] < 1.5 * fluid and seconds["pseudo-solid, total"] < 5 * fluid)
    return measure


def instructions(n):
    """The same in instructions (callgrind), which the load of a machine does not change: the equations alone, and whole steps of the mover."""
    def measure(job):
        result = job.run([job.root / "benchmarks/mover", "--build", job.build, "--n", n, "--instructions"], timeout=3600)
        if result.returncode != 0:
            raise RuntimeError((result.stderr or result.stdout)[-300:])
        rows = {line.split("|")[0].strip(): [float(v) for v in line.split("|")[1:]] for line in result.stdout.splitlines()[1:] if "|" in line}
        pressure = rows.pop("a step of the fluid")[1]
        return (f"the pressure equation {pressure:.0f} million; " + "; ".join(
            f"{name} {equation / pressure:.2f} times that ({step / pressure:.2f} with geometry, guard and quality.csv)"
            for name, (step, equation) in rows.items()),
            rows["laplacian, total"][1] < 1.5 * pressure and rows["pseudo-solid, total"][1] < 5 * pressure)
    return measure


EFFECTS = r"couplet::(?:fluid::|fv::|mesh::)?(PrescribedMotion::\w+|swept_volumes|Gaps<2>::\w+|GapPockets<2>::\w+|Sample::\w+|PlaceSearch::\w+|PointValues<2>::\w+|Fluid<2>::place|set_turn)\b"


def off_is_nothing(job):
    """Functions of motion, gaps and samples that callgrind sees in two steps of the pinch valve, and in the same channel without the three."""
    called = {}
    for name, more in (("with", ()), ("without", ("participants.fluid.motion=null", "participants.fluid.gaps={}", "participants.fluid.output.samples={}",
                                                  "participants.fluid.boundaries.lid={type: no-slip}"))):
        folder = job.scratch / f"callgrind-{name}"
        folder.mkdir()
        command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/counts", job.build / "bin" / "fluid_solver",
                   job.root / "configs/closing-gap/case.yaml"]
        for key in (f"simulation.output.folder={folder}", "simulation.end-time=0.04", "simulation.time-step=0.02", *more):
            command += ["--set", key]
        result = job.run(command)
        if result.returncode != 0:
            raise RuntimeError((result.stderr or result.stdout)[-300:])
        called[name] = set(re.findall(EFFECTS, (folder / "counts").read_text()))
    return (f"{len(called['with'])} functions of motion, gaps and samples run with them, {len(called['without'])} without",
            len(called["with"]) >= 8 and not called["without"])


STATED = ("E of the volumes that cells have now, V^n of [thesis], on the mesh of the last step: form incremental, "
          "stiffening-volumes current")
BARS = [
    *(Bar(f"plate in a square, {motion}: pseudo-solid, chi {chi}", "all cells valid in 50 steps", plate(motion, "pseudo-solid", chi))
      for motion in ("shift by 0.5", "bend to a half circle", "turn by 45 degrees", "turn by 90 degrees") for chi in (1, 2)),
    *(Bar(f"plate in a square, {motion}: {method}, chi {chi}", "refused: the mesh turns over", plate(motion, method, chi, False))
      for motion, method, chi in (("shift by 0.5", "pseudo-solid", 0), ("shift by 0.5", "laplacian", 0),
                                  ("bend to a half circle", "laplacian", 2), ("bend to a half circle", "pseudo-solid", 0),
                                  ("turn by 90 degrees", "laplacian", 2), ("turn by 90 degrees", "pseudo-solid", 0))),
    *(Bar(f"plate in a square, shift by 0.5: laplacian, chi {chi}", "all cells valid in 50 steps", plate("shift by 0.5", "laplacian", chi))
      for chi in (1, 2)),
    *(Bar(f"plate in a square, {motion}: rotations", "all cells valid in 50 steps, total form",
          plate(motion, "rotations", 1, form="total", volumes="reference"))
      for motion in ("turn by 45 degrees", "turn by 60 degrees", "turn by 90 degrees")),
    Bar("plate in a square, shift by 0.5: f_AR of the pseudo-solid", "chi 1 and 2 below chi 0, where all three are valid", f_ar),
    *(Bar(f"plate, +0.5 and back: {method}, total form", "every vertex to 1e-10 of the edge", back(method, "total", 0.5, 1e-10),
          but="chi 0.5, with which the total form holds that far") for method in ("laplacian", "pseudo-solid")),
    Bar("plate, +0.5 and back: pseudo-solid, incremental form", "reported", back("pseudo-solid", "incremental", 1)),
    *(Bar(f"plate, 100 cycles of +-{degrees} degrees: rotations, total form", "scaled Jacobian of the last cycle within 1e-6 of the first",
          cycles("rotations", "total", degrees)) for degrees in (30, 60)),
    Bar("plate, 100 cycles of +-30 degrees: pseudo-solid, total form", "scaled Jacobian of the last cycle within 1e-6 of the first",
        cycles("pseudo-solid", "total", 30, chi=1), long=True),
    Bar("plate, 10 cycles of +-30 degrees: pseudo-solid, incremental form", "reported",
        cycles("pseudo-solid", "incremental", 30, n=10, chi=1, limit=None), long=True),
    Bar("sphere moved by its radius in tetrahedra: pseudo-solid, total form", "all cells valid", in_space("sphere", SPHERE, "pseudo-solid", 0.5)),
    Bar("bending flap in 3-D, tip turned by 22.5 degrees: pseudo-solid, total form", "all cells valid", in_space("flap", FLAP, "pseudo-solid", 1)),
    Bar("swept volumes are the change of volume", "to 1e-14 x domain, tests pass", tested("verification_mover_motion", "*swept*")),
    Bar("every method on 1, 2 and 3 ranks, and from a checkpoint", "tests pass", ranks("^verification_mover_ranks")),
    Bar("limits of the guard", "tests pass", tested("verification_mover_motion", "Guard*")),
    Bar("oscillating cylinder, mesh follows: Morison coefficients", "within 2 % of c_d 2.09, c_m 1.45", morison(False),
        but="by Fourier averages; those of a least-squares fit stand beside them"),
    Bar("oscillating cylinder, the whole mesh moves", "within 2 % of c_d 2.09, c_m 1.45", morison(True),
        but="by Fourier averages; those of a least-squares fit stand beside them"),
    Bar("oscillating cylinder, the two meshes", "coefficients within 1 % of each other", both_frames),
    Bar("force coefficients of 2D-1 by output.coefficients", "c_d within 0.5 % of 5.57954, c_l within 10 % of 0.010619", steady_coefficients),
    *(Bar(f"step of mesh motion to 1e-5, {n ** 3} hexahedra, refilled and warm", "laplacian under 1.5, pseudo-solid under 5 times a pressure solve to 1e-6",
          speed(n), long=True, but="beside a whole step of the fluid: the pressure equation and an explicit predictor" + more)
      for n, more in ((32, "; on a smaller mesh"), (100, ""))),
    Bar("equation of mesh motion to 1e-5 beside the pressure equation to 1e-6, 32768 hexahedra, warm, by instructions",
        "laplacian under 1.5, pseudo-solid under 5 times a pressure solve", instructions(32), long=True,
        but="instructions in place of time; on a smaller mesh; geometry, guard and monitors, which a step needs besides, stand in brackets"),
    Bar("2D-3 on 11 k cells: largest lift", "within 3 % of 0.47795", pulse, long=True,
        but="10 772 cells, of which more lie along the wake than in the case's mesh, whose 10 880 are 5.0 % off"),
    Bar("oscillating cylinder: Morison coefficients by least squares", "within 2 % of c_d 2.09, c_m 1.45", least_squares),
    Bar("a plate that pitches through +-60 degrees in a stream", "completes two periods", pitching),
    Bar("a channel closes by 99 % without remeshing and opens again", "completes; shut, the boundaries let in what they let out to 1e-6 m^3/s", closes),
    Bar("a channel that closes by 99 %: what blocking saves", "reported", saves),
    Bar("torque between two circles of which one turns", "within 0.5 % of 16 pi mu/3 = 1.6755 N m on both", torques),
    Bar("torque between two circles from the frame of the inner one, 24 cells across", "within 0.5 % of 16 pi mu/3 = 1.6755 N m on both",
        lambda job: torques(job, (*FRAME, "participants.fluid.mesh-parameters.n=24", "simulation.end-time=20"))),
    Bar("a frame that turns against a mesh that turns and exact flows, 1, 2 and 3 ranks", "tests pass", ranks("^verification_fluid_rotating_frame")),
    Bar("periodic patches of the mover: sides alike, refusals, checkpoint, 1, 2 and 3 ranks", "tests pass", ranks("^verification_mover_periodic")),
    Bar("walls that turn: checkpoint, friction, 1, 2 and 3 ranks", "tests pass", ranks("^verification_fluid_turning_walls")),
    *(Bar(f"plate in a square, {motion}: the third method beside the others, total form", "all cells valid, and the largest scaled Jacobian of the three",
          third(motion)) for motion in ("turn by 45 degrees", "turn by 90 degrees")),
    Bar("closing gaps: flow, volume, checkpoint, 1, 2 and 3 ranks", "tests pass", ranks("^verification_fluid_gaps")),
    Bar("effects: no instruction of motion, gaps and samples in a run without them (callgrind)", "none", off_is_nothing),
    Bar("cells sheared by 55, 70 and 75 degrees, needles, slivers, aspect 1000", "solved, or refused by name: tests pass",
        tested("stability_fluid_step_sizes", "*HardMeshes*")),
    *(Bar(f"{what}: channel flow", "solved, error printed", hard_mesh(test), but=but) for what, test, but in (
        ("cells sheared by 60 degrees", "sheared_by_sixty", ""),
        ("wall cells of aspect 1e5", "hundred_thousand", "implicit viscous term alone: the other's stable step is 3e-10 s"),
        ("tetrahedra with vertices moved by a third of an edge", "slivers", "for tetrahedra that no mesher optimised"))),
    Bar("backward step, Re 800, 48 cells over the height", "reported", behind_step(48, False), long=True),
    Bar("backward step, Re 800, 80 cells over the height", "within 1 % of 6.10, 4.85, 10.48 (Gartling)", behind_step(80, True), long=True),
    Bar("cavity, Re 5000, 128^2 stretched", "extrema within 1 % of their own extrapolation", cavity_5000, long=True,
        but="cells at the walls about a tenth of those in the middle, chosen for this row; with the case's own quarter 1.64 % off"),
    *(Bar(f"speed: {what}", f">= {wanted} times", ratio(only, wanted), long=True, but=but) for what, only, wanted, but in (
        ("cavity 128^2 against icoFoam, one core", "cavity-2d", 13, ""), ("cavity 64^3 against icoFoam, one core", "cavity-3d", 5, ""),
        ("24 000 cells around an oscillating cylinder against pimpleFoam, one core", "moving-cylinder", 8,
         "by a test program, fluid and mover in one process"))),
    Bar("speed: second core on 64^3", ">= 1.7 times", second_core(1.7), long=True),
]
