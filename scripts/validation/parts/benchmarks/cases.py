# SPDX-License-Identifier: Apache-2.0
"""The coupled benchmarks: flags, cavities, lock-in, tube, flap; restart and ranks of every case."""
import dataclasses
import json
import math

import numpy as np

import couplet
from couplet.runs.case import Case
from couplet.runs.job import surroundings
from couplet.runs.process import launch
from couplet.series import find_series
from validation.parts.coupler import PEAK, TUBE


# -- flags ------------------------------------------------------------------------------------------------------------
TUREK_HRON = "configs/turek-hron"
FLAGS = {"fsi1": "fsi1.yaml", "fsi3": "case.yaml"}

variants = []  # in the order of their first run


def run_flag(job, case, *more):
    if more not in variants:
        variants.append(more)
    result = job.coupled_run(job.root / TUREK_HRON / FLAGS[case], f"{case}-{variants.index(more)}", more, timeout=20000)
    return job.beside(f"{TUREK_HRON}/summary.py").summary(result.folder), result.cost


def beside(job, case, name, limit, *more):
    """A value within `limit` of the benchmark's."""
    found, cost = run_flag(job, case, *more)
    wanted = job.beside(f"{TUREK_HRON}/summary.py").reference(case.upper())[name]
    off = found[name] / wanted - 1
    return f"{found[name]:.5g} for {wanted:.5g}: {100 * off:+.2f} % ({cost.cpu / 60:.1f} processor minutes)", abs(off) <= limit


# -- cavity -----------------------------------------------------------------------------------------------------------
MOK = "configs/cavity-flexible-bottom/case.yaml"


def extremes(job, name, *more):
    """Least and largest height of the middle [m] over the last period of 5 s, time between its last two maxima [s]."""
    folder = job.coupled(job.root / MOK, f"mok-{name}", more)
    rows = couplet.read_csv(folder / "membrane" / "probes.csv")
    t, y = rows["time [s]"], rows["middle y [m]"]
    last, before = t > t[-1] - 5, (t > t[-1] - 10) & (t <= t[-1] - 5)
    return y[last].min(), y[last].max(), t[last][y[last].argmax()] - t[before][y[before].argmax()]


def band(job, which, low, high):
    value = extremes(job, "case")[which]
    cost = job.coupled_run(job.root / MOK, "mok-case").cost  # of the run just made
    return f"{value:.4f} ({cost.cpu / 60:.1f} processor minutes)", low <= value <= high


# -- closed -----------------------------------------------------------------------------------------------------------
BOXES = {"closed": "configs/closed-cavity/case.yaml", "nearly closed": "configs/closed-cavity/nearly-closed.yaml"}
MESHES = 8, 16, 32
SCHEMES = {
    "semi-implicit": (),
    "implicit": ("coupling.scheme=implicit",),
    "semi-implicit, Robin": ("coupling.order=structure-first", "participants.fluid.volume-level=none", "participants.fluid.boundaries.lid.surface-density=50"),
}


def run_box(job, kind, n, step, scheme="semi-implicit"):
    opening = f", m: {n // 8}" if kind != "closed" else ""  # an eighth of the side on all meshes
    sets = [f"simulation.time-step={step} ms", "simulation.end-time=0.4 s", "simulation.output.interval=0", *SCHEMES[scheme],
            *(f"participants.{name}.mesh-parameters={{n: {n}{opening if name != 'lid' else ''}}}" for name in ("fluid", "lid", "mover"))]
    return job.coupled_run(job.root / BOXES[kind], f"{kind}-{n}-{step}-{scheme}".replace(" ", "-").replace(",", ""), sets)


def lid(result):
    """Height of the lid's middle at the end [m]."""
    return couplet.read_csv(result.folder / "lid" / "probes.csv")["middle y [m]"][-1]


def extrapolation(job, kind):
    """Mesh and step are halved together: the finest run beside the limit of the three."""
    values = [lid(run_box(job, kind, n, 160 / n)) for n in MESHES]
    first, second = values[1] - values[0], values[2] - values[1]
    ratio = min(max(first / second, 2), 4) if first * second > 0 else 2  # order between 1 and 2
    limit = values[2] + second / (ratio - 1)
    return (f"lid's middle {' '.join(f'{1e3 * v:.4f}' for v in values)} mm on {', '.join(f'{n} x {n}' for n in MESHES)} cells and steps of 20, 10, 5 ms, limit "
            f"{1e3 * limit:.4f} mm: {100 * (values[2] / limit - 1):+.2f} %, order {math.log2(ratio):.1f}"), abs(values[2] / limit - 1) <= 0.02


# -- lock in ----------------------------------------------------------------------------------------------------------
SPRING = "configs/spring-cylinder"
AHN = 0.55  # amplitude over D at 4: Ahn and Kallinderis, J. Comput. Phys. 219 (2006)


def response(job, reduced):
    """Amplitude over D and frequency over that in vacuo, last 30 s of 120 s."""
    return measured(job, reduced)[:2]


def measured(job, reduced):
    """The same, and what the run cost."""
    def make():
        out = job.scratch / f"lock-in-{reduced}"
        out.mkdir()
        stiffness = 2 * (2 * math.pi / reduced) ** 2
        environment = {**job.environment, "COUPLET_BIN": str(job.build / "bin"), "COUPLET_BODY": f"2 0 {stiffness!r} 0.2"}
        cost = launch([job.root / SPRING / "run", "vortices.yaml", "--set", f"simulation.output.folder={out}"], out / "run.log", folder=out,
                      timeout=3600, env=environment)
        t, y = np.loadtxt(out / "body.csv", delimiter=",").T[:2]
        end, series = t > t[-1] - 30, job.beside("configs/cylinder/coefficients.py")
        return series.mean_and_amplitude(t[end], y[end])[1], reduced * series.frequency(t[end], y[end]), cost
    return job.once(("lock-in", reduced), make)


def at_four(job):
    amplitude, ratio, cost = measured(job, 4)
    return f"{amplitude:.3f} D: {100 * (amplitude / AHN - 1):+.1f} %, frequency {ratio:.3f} of that in vacuo ({cost.cpu / 60:.1f} processor minutes)", abs(amplitude / AHN - 1) <= 0.1


def over_range(job):
    return "; ".join("{:g}: {:.3f} D, {:.2f}".format(u, *response(job, u)) for u in (3, 4, 5, 7, 8)), None


def is_locked(amplitude, ratio):
    """The vortices follow the body: it oscillates near its own frequency, by more than a quarter of D."""
    return amplitude > 0.25 and abs(ratio - 1) < 0.2


def bracket(job, locked, free):
    """Locked at one velocity; at the other the body follows the vortices, at a frequency that is not its own."""
    at = {u: response(job, u) for u in (locked, free)}
    text = "; ".join(f"{u:g}: {a:.3f} D, frequency {f:.2f} of that in vacuo" for u, (a, f) in sorted(at.items()))
    return text, is_locked(*at[locked]) and abs(at[free][1] - 1) > 0.2


# -- tube -------------------------------------------------------------------------------------------------------------
STATIONS = {"a": 0.0150, "A": 0.0250, "b": 0.0350}  # m from the inlet: the pulse is over at b before its reflection returns
MOENS_KORTEWEG = math.sqrt(0.3e6 * 1e-3 / (2 * 1000 * 5e-3))
COARSE = ["{n: 5, n_ring: 3, n_z: 40}", "{n: 5, n_wall: 2, n_z: 40}"]  # half the cells along each direction


def pulse(job, name, meshes=(None, None), *more):
    """Times [s] and radial motion [m] at each station."""
    fluid, wall = meshes
    sets = [f"participants.solid.probes={{{', '.join(f'{k}: {{point: [0, 0.005, {z}]}}' for k, z in STATIONS.items())}}}",
            *(f"participants.{part}.mesh-parameters={fluid}" for part in ("fluid", "mover") if fluid),
            *([f"participants.solid.mesh-parameters={wall}"] if wall else []), *more]
    rows = couplet.read_csv(job.coupled(job.root / TUBE, f"pulse-{name}", ["simulation.end-time=10 ms", *sets]) / "solid" / "probes.csv")
    return np.array(rows["time [s]"]), {k: np.array(rows[f"{k} y [m]"]) for k in STATIONS}


def top(t, y):
    """Time and height of the maximum, by the parabola through its three samples."""
    k = int(y.argmax())
    bend, slope = (y[k + 1] - 2 * y[k] + y[k - 1]) / 2, (y[k + 1] - y[k - 1]) / 2
    return t[k] - slope / (2 * bend) * (t[k + 1] - t[k]), y[k] - slope ** 2 / (4 * bend)


def speed(t, y):
    """Distance over the time between the maxima at the outer stations [m/s]."""
    return (STATIONS["b"] - STATIONS["a"]) / (top(t, y["b"])[0] - top(t, y["a"])[0])


def radial(job, name, *how):
    t, y = pulse(job, name, *how)
    at, most = top(t, y["A"])
    cost = job.coupled_run(job.root / TUBE, f"pulse-{name}").cost  # of the run just made
    return f"{most:.3e} m at {1e3 * at:.2f} ms: {100 * (most / PEAK - 1):+.1f} % ({cost.cpu / 60:.1f} processor minutes to 10 ms)", abs(most / PEAK - 1) <= 0.03


def wave(job):
    case, coarse = speed(*pulse(job, "case")), speed(*pulse(job, "coarse", COARSE, "simulation.time-step=0.2 ms"))
    return (f"{case:.3f} m/s on the case's mesh, {coarse:.3f} m/s at twice its cells and step: {100 * (coarse / case - 1):+.1f} %; Moens and Korteweg "
            f"{MOENS_KORTEWEG:.2f}, with 1 - nu^2 {MOENS_KORTEWEG / math.sqrt(0.91):.2f} m/s"), abs(coarse / case - 1) <= 0.02


# -- large flap -------------------------------------------------------------------------------------------------------
FLAP = "configs/perpendicular-flap/case.yaml"
FAST = ["participants.fluid.boundaries.inlet.velocity=[20 m/s, 0 m/s]", "participants.mover.method=barrier", "simulation.end-time=1 s"]


def tip(job, name, *more):
    """Motion of the tip (times, 2) [m], and the folder of the solid."""
    folder = job.coupled(job.root / FLAP, f"flap-20-{name}", [*FAST, *more]) / "solid"
    rows = couplet.read_csv(folder / "probes.csv")
    return np.array([rows["tip x [m]"], rows["tip y [m]"]]).T, folder


def verdict(job):
    (linear, folder), (finite, _) = tip(job, "linear"), tip(job, "finite", "participants.solid.kinematics=finite-strain")
    size = np.hypot(*finite.T).max()
    apart = np.hypot(*(linear - finite).T).max() / size
    share = json.loads((folder / "run.json").read_text())["errors"]["model"]
    text = (f"largest motion of the tip {linear[:, 0].max():.4f} m along the flow linear, {finite[:, 0].max():.4f} m at finite strain; {apart:.3f} of the motion apart "
            f"at most, the linear run's verdict {share:.3f}")
    return text, 1 / 1.5 <= share / apart <= 1.5


# -- gallery ----------------------------------------------------------------------------------------------------------
MONITORS = ("probes.csv", "forces.csv", "volume.csv", "watch.csv")
MIDDLE = 3  # steps before the checkpoint
INNER = 1e-10  # of the pressure equation: the solution of a linear system on other ranks differs by its tolerance
RANKS = {"fluid_solver": 2, "solid_solver": 2}  # of the second run
SPRING_PROGRAM = "client/examples/spring_cylinder.py"


def meshes(text, *participants):
    return [f"participants.{name}.mesh-parameters={text}" for name in participants]


COARSE_FLAP = [*meshes("{n_side: 20, n_tip: 2, growth: 1.35, wall_growth: 1.35, wall_cells: 5}", "fluid", "mover"), *meshes("{n_side: 40, n_tip: 4}", "solid")]
FLAG = [*meshes("{n: 6}", "fluid", "mover"), *meshes("{nx: 30, ny: 5}", "solid")]
COARSE_TUBE = [*meshes("{n: 3, n_ring: 2, n_z: 30}", "fluid", "mover"), *meshes("{n: 3, n_wall: 2, n_z: 30}", "solid")]


@dataclasses.dataclass
class Entry:
    name: str
    file: str            # below configs/
    step: float          # [s]
    coarse: tuple = ()   # settings of the coarse variant
    sets: tuple = ()     # further settings
    steps: int = 5       # the checkpoint is after the third: by then all steps that a scheme looks back to are behind it
    words: dict = dataclasses.field(default_factory=dict)  # external participant: (file below the root, further arguments)


GALLERY = [
    Entry("FSI1", "turek-hron/fsi1.yaml", 0.02, FLAG),
    Entry("FSI3", "turek-hron/case.yaml", 0.002, FLAG),
    Entry("tube", "tube-3d/case.yaml", 1e-4, COARSE_TUBE),
    Entry("flap, linear", "perpendicular-flap/case.yaml", 0.01, COARSE_FLAP),
    Entry("flap, large deflection", "perpendicular-flap/case.yaml", 0.01, COARSE_FLAP,
          ["participants.solid.kinematics=finite-strain", "participants.mover.method=barrier", "participants.fluid.boundaries.inlet.velocity=[20 m/s, 0 m/s]"]),
    Entry("flap in three dimensions", "perpendicular-flap/flap-3d.yaml", 0.01),
    Entry("closed box", "closed-cavity/case.yaml", 0.02, meshes("{n: 8}", "fluid", "lid", "mover")),
    Entry("nearly closed box", "closed-cavity/nearly-closed.yaml", 0.02, meshes("{n: 8}", "fluid", "lid", "mover")),
    Entry("Mok's cavity", "cavity-flexible-bottom/case.yaml", 0.1, meshes("{n: 16}", "fluid", "membrane", "mover")),
    Entry("balloon", "balloon/case.yaml", 0.01),
    Entry("two flaps", "two-flaps/case.yaml", 0.01),
    Entry("chain of three flaps", "two-flaps/three-flaps.yaml", 0.01),
    Entry("cylinder on a spring, at rest", "spring-cylinder/case.yaml", 0.05, words={"body": (SPRING_PROGRAM, "2", "0", "4", "0.01")}),
    Entry("cylinder on a spring, in a stream", "spring-cylinder/vortices.yaml", 0.05, words={"body": (SPRING_PROGRAM, "2", "0", "4.9348", "0.2")}),
]


def run(job, entry, kind, ranks=None, flags=(), coarse=True):
    """The folder of a run; its checkpoint in the middle is kept."""
    folder = job.scratch / f"{entry.name.replace(' ', '-').replace(',', '')}-{kind}"
    folder.mkdir(parents=True)
    case = Case(job.root / "configs" / entry.file, job.build)
    sets = [f"simulation.time-step={entry.step!r}", f"simulation.end-time={entry.steps * entry.step!r}", f"simulation.output.folder={folder}", "simulation.output.interval=0",
            f"simulation.checkpoint={{interval: {MIDDLE * entry.step!r}, keep: 100}}", *entry.sets, *(entry.coarse if coarse else ())]
    sets += [f"participants.{name}.pressure-tolerance={INNER:g}" for name, content in case.participants.items() if content["program"] == "fluid_solver" and coarse]
    guests = {name: ["/usr/bin/python3", job.root / file, name, *more] for name, (file, *more) in entry.words.items()}
    # While a flow starts its error may be as large as itself, which ends a run with code 4; what is compared here is not the answer.
    launch(case.command({}, ranks=ranks, raw=sets, flags=("--accept", "error-estimate", *flags), played_by=guests), folder / "run.log", folder=folder, timeout=1200, env=surroundings())
    return folder


def participants(folder):
    return sorted(f.parent for f in folder.glob("*/run.json") if f.parent.name != "coupler")


def late(file, after):
    """Rows of a monitor beyond a time, as text; body.csv has no heads."""
    rows = [line.split(",") for line in file.read_text().splitlines() if not line.startswith("#")]
    heads = [h.strip() for h in rows[0]]
    at = heads.index("time [s]") if "time [s]" in heads else 0
    return [r for r in rows[0 if file.name == "body.csv" else 1:] if float(r[at]) > after]


def fields(folder):
    """{name: values by the numbers of their cells or points} of a participant at the end; none of a participant without fields."""
    try:
        series = find_series(folder)
    except FileNotFoundError:
        return {}
    last, found = len(series.times) - 1, {}
    order = {False: np.argsort(series.file["mesh/cell-id"][...]), True: np.argsort(series.file["mesh/point-id"][...])}
    for name in series.names(last):
        found[name] = series.field(last, name)[order[series.is_at_points(last, name)]]
    return found


def monitors(folder):
    return [f for place in (*participants(folder), folder / "coupler") for f in map(place.joinpath, MONITORS) if f.exists()] + list(folder.glob("body.csv"))


def continued(job, entry):
    """(what differs between the whole run and the one continued in its middle, how much was compared)"""
    whole = job.once(("gallery", entry.name), lambda: run(job, entry, "whole"))
    again = run(job, entry, "continued", flags=("--restart", whole / "checkpoints" / f"step-{MIDDLE:08d}"))
    after = (MIDDLE + 0.5) * entry.step
    differs, count = [], 0
    for file in monitors(whole):
        rows = late(file, after)
        count += len(rows)
        if not rows or rows != late(again / file.relative_to(whole), after):
            differs.append(str(file.relative_to(whole)))
    for place in participants(whole):
        first, second = fields(place), fields(again / place.name)
        count += sum(v.size for v in first.values())
        differs += [f"{place.name}: {name}" for name in first if not np.array_equal(first[name], second.get(name))]
    return differs, count


def apart(job, entry):
    """Largest difference of a field or a probe between one and two ranks over its maximum, and whose."""
    whole = job.once(("gallery", entry.name), lambda: run(job, entry, "whole"))
    programs = {name: content["program"] for name, content in Case(job.root / "configs" / entry.file, job.build).participants.items()}
    other = run(job, entry, "ranks", {name: RANKS[program] for name, program in programs.items() if program in RANKS})
    found = {}
    for place in participants(whole):
        first, second = fields(place), fields(other / place.name)
        for name in {"pressure", "displacement", *(["velocity"] if "pressure" in first else [])} & set(first):
            found[f"{place.name}'s {name}"] = np.abs(first[name] - second[name]).max() / max(np.abs(first[name]).max(), 1e-300)
    for file in whole.glob("body.csv"):
        a, b = (np.loadtxt(f, delimiter=",")[:, 1] for f in (file, other / "body.csv"))
        found["the body's motion"] = np.abs(a - b).max() / np.abs(a).max()
    return max((gap, name) for name, gap in found.items())


def both(job, name):
    entry = next(e for e in GALLERY if e.name == name)
    tolerance = float(Case(job.root / "configs" / entry.file, job.build).data["coupling"]["convergence"]["relative"])
    differs, count = continued(job, entry)
    gap, whose = apart(job, entry)
    kept = f"continued: {count} numbers equal bit for bit" if not differs else f"continued: differs in {', '.join(differs[:4])}"
    return f"{kept}; on 2 ranks {gap:.1e} apart at most ({whose}), tolerance {tolerance:g}", not differs and count > 0 and gap <= tolerance
