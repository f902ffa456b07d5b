# SPDX-License-Identifier: Apache-2.0
"""The coupled benchmarks: flags, cavities, lock-in, tube, flap; restart and ranks of every case."""
import math

import numpy as np

import couplet
from couplet.runs.process import launch
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


# -- gallery ----------------------------------------------------------------------------------------------------------


def meshes(text, *participants):
    return [f"participants.{name}.mesh-parameters={text}" for name in participants]


def participants(folder):
    return sorted(f.parent for f in folder.glob("*/run.json") if f.parent.name != "coupler")
