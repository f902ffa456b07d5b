# SPDX-License-Identifier: Apache-2.0
"""Measures of vibration by vortices: an undamped cylinder on a spring, Re 150, m = 2 rho D^2, over reduced velocities U / (f_n D)."""
import math

import numpy as np

from couplet.runs.process import launch

HERE = "configs/spring-cylinder"
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
        cost = launch([job.root / HERE / "run", "vortices.yaml", "--set", f"simulation.output.folder={out}"], out / "run.log", folder=out,
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
