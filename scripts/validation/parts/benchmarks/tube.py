# SPDX-License-Identifier: Apache-2.0
"""Measures of the elastic tube in three dimensions: radial motion, speed of the wave, order in time."""
import math

import numpy as np

import couplet
from validation.parts.coupler.tubes import PEAK, TUBE

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


def order(job):
    """Root mean square of the radial motion of A from 4 to 10 ms, between neighbouring steps."""
    runs = [pulse(job, f"step-{step}", COARSE, f"simulation.time-step={step} ms") for step in (0.05, 0.025, 0.0125)]
    times = np.arange(4e-3, 10e-3 - 1e-9, 1e-4)
    values = [np.interp(times, t, y["A"]) for t, y in runs]
    first, second = (np.sqrt(np.mean((a - b) ** 2)) / PEAK for a, b in zip(values, values[1:]))
    found = math.log2(first / second)
    return f"{100 * first:.2f} % between 0.05 and 0.025 ms, {100 * second:.2f} % between 0.025 and 0.0125 ms: order {found:.2f}", found >= 1.8
