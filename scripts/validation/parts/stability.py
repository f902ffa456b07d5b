# SPDX-License-Identifier: Apache-2.0
"""Limits of stability between runs that hold and runs that do not; vortices that are not resolved."""

import numpy as np

import atlas
import couplet


# -- limits, by runs of the atlas's maps -------------------------------------------------------------------------------
def structure(job, name, scheme, gradient, courant, steps, most=None):
    """Growth of the energy of the oscillating beam."""
    growth, code, *_ = job.once(
        ("swing", name),
        lambda: atlas.maps()["solid-energy"].run(
            "trapezoidal, symmetric",
            courant,
            0.5,
            atlas.Runner(job.build, job.scratch / name),
            scheme=scheme,
            gradient=gradient,
            steps=steps,
        ),
    )
    return f"{growth:+.2e}, exit code {code}", None if most is None else code == 0 and growth <= most


def limit(job, panel, factor):
    """The viscous limit of the program between the last step that holds and the first that does not, or that the
    program halves and says so, on square cells: bisection by runs to 1 %; theory: nu dt/h^2 = factor/8."""
    runner, low, high = (
        atlas.Runner(job.build, job.scratch / f"limit-{panel.split()[-1]}"),
        0.9 * factor / 8,
        1.1 * factor / 8,
    )
    for _ in range(6):
        middle = (low + high) / 2
        growth, code, doubtful, *_ = atlas.maps()["fluid-diffusion"].run(panel, middle, 0.0, runner)
        low, high = (middle, high) if code == 0 and growth < 1.05 and not doubtful else (low, middle)
    return (
        f"{low:.5f} to {high:.5f}, theory {factor / 8:.5f}",
        abs(low / (factor / 8) - 1) <= 0.02 or abs(high / (factor / 8) - 1) <= 0.02,
    )


def added_mass_limit(job):
    """Largest added mass over mass with which explicit coupling is bounded, by bisection with the programs; theory:
    1."""
    runner, low, high = atlas.Runner(job.build, job.scratch / "added-mass"), 0.7, 1.5
    for _ in range(6):
        middle = (low * high) ** 0.5
        number, code, *_ = atlas.maps()["coupling-mass"].run("explicit, predictor 1", middle, 0.1, runner, steps=200)
        low, high = (low, middle) if code == 0 and number < 3 else (middle, high)
    return f"bounded from mass over added mass {low:.4f} to {high:.4f}, theory 1", abs((low * high) ** 0.5 - 1) <= 0.05


def implicit_range(job):
    """Implicit, Aitken, mass over added mass 0.01 to 100."""
    runner, ratios = atlas.Runner(job.build, job.scratch / "implicit"), (0.01, 0.1, 1, 10, 100)
    runs = {ratio: atlas.maps()["coupling-mass"].run("implicit, Aitken", ratio, 0.1, runner) for ratio in ratios}
    failed = [ratio for ratio, (number, code, *_) in runs.items() if code != 0 or not number < 3]
    return f"{len(ratios) - len(failed)} of {len(ratios)} hold" + (f"; not {failed}" if failed else ""), not failed


# -- cases ------------------------------------------------------------------------------------------------------------
TURNOVERS = 20
PERIODIC = (("left", "right"), ("front", "back"), ("bottom", "top"))


def vortices(job, reynolds):
    """Kinetic energy of the vortices of Taylor and Green on 32^3 hexahedra, by step, and the exit code."""

    def make():
        folder = job.scratch / f"vortices-{reynolds:.0e}"
        folder.mkdir()
        sides = ", ".join(f"{a}: {{type: periodic, partner: {b}}}" for pair in PERIODIC for a, b in (pair, pair[::-1]))
        (folder / "case.yaml").write_text(
            f"simulation: {{end-time: {TURNOVERS}, time-step: 0.1, output: {{folder: out, interval:"
            f" {TURNOVERS}}}}}\nparticipants: {{fluid: {{program: fluid_solver, mesh:"
            f" {job.root / 'configs/taylor-green-3d/box.geo'}, mesh-parameters: {{n: 32}}, dimension: 3, density: 1,"
            f" viscosity: {1 / reynolds:g}, pressure-tolerance: 1e-4, initial-velocity: ['sin(x)*cos(y)*cos(z)',"
            f" '-cos(x)*sin(y)*cos(z)', 0], output: {{energy-budget: true}}, boundaries: {{{sides}}}}}}}\n"
        )
        result = job.run([job.build / "bin/fluid_solver", "case.yaml"], 3600, cwd=folder)
        file = folder / "out/fluid/energy.csv"
        return (
            couplet.read_csv(file)["kinetic energy [J]"] if file.exists() else np.array([np.nan])
        ), result.returncode

    return job.once(("vortices", reynolds), make)


def bounded(job, reynolds):
    energy, code = vortices(job, reynolds)
    gain = float(np.max(energy[1:] / energy[:-1]) - 1) if len(energy) > 1 else float("nan")
    return (
        (
            f"energy never grows by more than {max(gain, 0):.1e} a step, {energy[-1] / energy[0]:.3g} of it left at the"
            f" end, exit code {code}"
        ),
        code == 0 and len(energy) > TURNOVERS and gain < 1e-3 and energy[-1] < energy[0],
    )
