# SPDX-License-Identifier: Apache-2.0
"""Measures of the solid's integration in time: case C of the thesis (vibrating cantilever), orders, energies, growth."""
import math

import couplet

SCHEMES = ("euler", "three-point", "trapezoidal", "bathe")
# Table 3.2 of the thesis: period elongation and amplitude decay [%] in the order of SCHEMES.
THESIS = {2: ((12, 10, 3.0, 1.9), (85, 20, 0.019, 0.18)), 1: ((3.0, 3.0, 0.90, 0.18), (62, 3.9, -0.77, 0.21)),
          0.1: ((-0.13, -0.070, 0.056, 0.14), (9.5, 0.30, 0.032, 0.045)),
          0.01: ((0.018, -0.10, None, -0.044), (1.3, 0.074, None, 0.082))}
CONVERGED = 20.03  # s, three-dimensional continuum


def beam(job, scheme, dt, *more, gradient="thesis"):
    """Output folder of a run of case C."""
    sets = [f"simulation.time-step={dt}", "simulation.output.interval=100",
            "participants.solid.solution-method={face-gradient: %s}" % gradient,
            f"participants.solid.time-scheme.type={scheme}", *more]
    folder, _ = job.solve("vibrating-cantilever", sets)
    return folder / "solid"


def vibration(job, folder):
    """(period, decay of the amplitude a period) of the free vibration."""
    module = job.beside("configs/vibrating-cantilever/vibration.py")
    return module.fit(*module.history(folder))[:2]


def undisturbed(job):
    """Period of the same mesh without error in time: the trapezoidal one at 0.1 s less its elongation, which goes with
    the square of the step, from 0.2 s."""
    fine, coarse = (vibration(job, beam(job, "trapezoidal", dt))[0] for dt in (0.1, 0.2))
    return fine - (coarse - fine) / 3


def table(job, dt):
    period = undisturbed(job)
    rows = []
    for i, scheme in enumerate(SCHEMES):
        if THESIS[dt][0][i] is None:
            continue  # grows without bound: see the bar of its own
        got = vibration(job, beam(job, scheme, dt))
        rows.append((f"{scheme} {100 * (got[0] / period - 1):.3f} / {100 * got[1]:.3f}", got))
    return "; ".join(text for text, _ in rows) + f" % (undisturbed period {period:.3f} s)", all(
        math.isfinite(value) for _, got in rows for value in got)


def refined_period(job):
    """On 160x16x16 over two free periods; the elongation of the scheme at this step is below 0.01 %."""
    folder = beam(job, "bathe", 0.1, "simulation.end-time=50",
                  "participants.solid.mesh-parameters={n_length: 160, n_side: 16}")
    period, _ = vibration(job, folder)
    return f"{period:.3f} s ({100 * (period / CONVERGED - 1):+.2f} %)", abs(period / CONVERGED - 1) <= 0.003


def energy_drift(job, gradient, scheme, *more):
    """Kinetic plus strain energy at 100 s over that at 10 s on the mesh of the thesis at 0.01 s."""
    folder = beam(job, scheme, 0.01, "participants.solid.output={energies: true}", *more, gradient=gradient)
    rows = couplet.read_csv(folder / "energies.csv")
    total = rows["kinetic [J]"] + rows["strain [J]"]
    drift = total[-1] / total[abs(rows["time [s]"] - 10).argmin()] - 1
    return f"{100 * drift:+.3f} %", bool(abs(drift) < 0.01)


def spectrum(job, gradient, key):
    test = f"of_the_trapezoidal_rule_is_predicted/{gradient}"
    values, passed = job.recorded("verification_solid_spectrum", test, f"predicted{key}")
    seen, _ = job.recorded("verification_solid_spectrum", test, f"measured{key}")
    return f"predicted {values[0]:.4f} 1/s, seen {seen[0]:.4f} 1/s", passed and abs(seen[0] / values[0] - 1) <= 0.1


def kept(job, gradient, key):
    test, got, met = f"is_removed_by_dissipative_schemes_and_by_a_little_damping/{gradient}", [], True
    beta, _ = job.recorded("verification_solid_spectrum", test, f"beta{key}")
    for what in ("damped", "bathe", "generalised-alpha"):
        values, passed = job.recorded("verification_solid_spectrum", test, f"kept_{what}{key}")
        got.append(f"{what} {100 * (values[0] - 1):+.3f} %")
        met = met and passed and abs(values[0] - 1) < 0.01
    return ", ".join(got) + f" (least damping that stops the growth: beta = {beta[0]:.1e} s)", met


def step_control(job):
    tests, _ = job.gtest("verification_solid_step_control")
    test = next(iter(tests.values()))
    return "; ".join(f"{s}: {test[s + '_steps']} steps, {test[s + '_fixed_steps']} of the shortest"
                     for s in SCHEMES[1:]), test["passed"]
