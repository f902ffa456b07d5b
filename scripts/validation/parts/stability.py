# SPDX-License-Identifier: Apache-2.0
"""Limits of stability between runs that hold and runs that do not; vortices that are not resolved."""
import re

import numpy as np

from couplet import series


# -- limits -----------------------------------------------------------------------------------------------------------
# -- effects ----------------------------------------------------------------------------------------------------------


# -- two dimensions against one cell of three --------------------------------------------------------------------------
def component_ratio(job, which, most, method=""):
    """Processor seconds of the same scene in 2-D and one cell thick in 3-D, the less of three each, turn by turn."""
    geo = """DefineConstant [ n = 96 ]; lc = 1;
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve {1:4} = n + 1; Curve Loop(1) = {1:4}; Plane Surface(1) = {1}; Transfinite Surface {1}; Recombine Surface {1};
"""
    flat = geo + 'Physical Curve("bottom") = {1}; Physical Curve("right") = {2}; Physical Curve("top") = {3}; Physical Curve("left") = {4};\n' \
        'Physical Surface("body") = {1};\n'
    thick = geo + 'o() = Extrude {0, 0, 1 / n} { Surface {1}; Layers {1}; Recombine; };\nPhysical Surface("bottom") = {o(2)};\n' \
        'Physical Surface("right") = {o(3)}; Physical Surface("top") = {o(4)}; Physical Surface("left") = {o(5)};\n' \
        'Physical Surface("sides") = {1, o(0)}; Physical Volume("body") = {o(1)};\n'
    seconds = {}
    for turn in range(3):
        for dim, text in ((2, flat), (3, thick)):
            folder = job.scratch / f"component-{which}-{method[:5]}-{dim}-{turn}"
            folder.mkdir()
            (folder / "mesh.geo").write_text(text)
            (folder / "case.yaml").write_text(scene_of(which, dim, method))
            result = job.done([job.build / "bin" / f"{which}_solver", folder / "case.yaml"], 900, cwd=folder)
            part = result.stdout[result.stdout.index(f"time of '{which}'"):]
            spent = float(re.search(r"^solve\s+([\d.]+)\s", part, flags=re.M).group(1))
            seconds[dim] = min(seconds.get(dim, spent), spent)
    ratio = seconds[2] / seconds[3]
    return f"{seconds[2]:.2f} s against {seconds[3]:.2f} s: {ratio:.2f}", ratio <= most


def scene_of(which, dim, method=""):
    zero = "[0, 0]" if dim == 2 else "[0, 0, 0]"
    if which == "solid":
        pull = "[0, 1e3]" if dim == 2 else "[0, 1e3, 0]"
        sides = "      sides: {type: symmetry}\n" if dim == 3 else ""
        return f"""simulation: {{end-time: 1e-4, time-step: 1e-6, output: {{folder: out}}}}
participants:
  solid:
    program: solid_solver
    mesh: mesh.geo
    dimension: {dim}
    analysis: dynamic
    {f"solution-method: {{type: {method}}}" if method else ""}
    material: {{density: 1000, youngs-modulus: 1e9, poissons-ratio: 0.3}}
    boundaries:
      left: {{type: fixed-displacement, value: {zero}}}
      right: {{type: traction, value: {pull}}}
      top: {{type: free}}
      bottom: {{type: free}}
{sides}"""
    lid = "[1, 0]" if dim == 2 else "[1, 0, 0]"
    sides = "      sides: {type: symmetry}\n" if dim == 3 else ""
    return f"""simulation: {{end-time: 0.5, time-step: 0.005, output: {{folder: out}}}}
participants:
  fluid:
    program: fluid_solver
    mesh: mesh.geo
    dimension: {dim}
    density: 1
    viscosity: 0.01
    boundaries:
      left: {{type: no-slip}}
      right: {{type: no-slip}}
      bottom: {{type: no-slip}}
      top: {{type: moving-wall, velocity: {lid}}}
{sides}"""


# -- structure: energies over many steps --------------------------------------------------------------------------------
def swing(job, name, scheme, gradient, courant, steps, lean=0.5, method=""):
    """Growth of the energy of the atlas's oscillating beam."""
    from couplet.atlas import solid
    from couplet.atlas.atlas import Runner

    def make():
        kept, solid.STEPS, solid.CASE = (solid.STEPS, solid.CASE), steps, solid.CASE.replace("{gradient}", "{gradient}" + method)
        try:
            return solid.energy(f"{scheme}, {gradient}", courant, lean, Runner(job.build, job.scratch / name))
        finally:
            solid.STEPS, solid.CASE = kept
    return job.once(("swing", name), make)


def structure(job, name, scheme, gradient, courant, steps, most=None, method=""):
    growth, code, doubted = swing(job, name, scheme, gradient, courant, steps, method=method)
    return f"{growth:+.2e}, exit code {code}", None if most is None else code == 0 and growth <= most


# -- maps ----------------------------------------------------------------------------------------------------------------


def limit(job, panel, factor):
    """The viscous limit of the program between the last step that holds and the first that does not, on the square cells of the atlas:
    bisection by runs to 1 %; theory: nu dt/h^2 = factor/8."""
    from couplet.atlas import fluid
    from couplet.atlas.atlas import Runner
    runner = Runner(job.build, job.scratch / f"limit-{panel[:9]}")
    low, high = 0.9 * factor / 8, 1.1 * factor / 8
    for _ in range(6):
        middle = (low + high) / 2
        growth, code, _ = fluid.diffusion(panel, middle, 0.0, runner)
        low, high = (middle, high) if code == 0 and growth < 1.05 else (low, middle)
    return f"{low:.5f} to {high:.5f}, theory {factor / 8:.5f}", abs(low / (factor / 8) - 1) <= 0.02 or abs(high / (factor / 8) - 1) <= 0.02


def added_mass_limit(job):
    """Largest added mass over mass with which explicit coupling is bounded, by bisection with the programs; theory: 1."""
    from couplet.atlas import coupling
    from couplet.atlas.atlas import Runner
    kept, coupling.STEPS = coupling.STEPS, 200
    try:
        runner, low, high = Runner(job.build, job.scratch / "added-mass"), 0.7, 1.5
        for _ in range(6):
            middle = (low * high) ** 0.5
            number, code, _ = coupling.run("explicit, predictor 1", middle, 0.1, runner)
            low, high = (low, middle) if code == 0 and number < 3 else (middle, high)
    finally:
        coupling.STEPS = kept
    return f"bounded from mass over added mass {low:.4f} to {high:.4f}, theory 1", abs((low * high) ** 0.5 - 1) <= 0.05


def implicit_range(job):
    """Implicit, Aitken, mass over added mass 0.01 to 100."""
    from couplet.atlas import coupling
    from couplet.atlas.atlas import Runner
    runner, failed = Runner(job.build, job.scratch / "implicit"), []
    ratios = (0.01, 0.1, 1, 10, 100)
    for ratio in ratios:
        number, code, _ = coupling.run("implicit, Aitken", ratio, 0.1, runner)
        if code != 0 or not number < 3:
            failed.append(ratio)
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
            f"simulation: {{end-time: {TURNOVERS}, time-step: 0.1, output: {{folder: out, interval: {TURNOVERS}}}}}\n"
            f"participants: {{fluid: {{program: fluid_solver, mesh: {job.root / 'configs/taylor-green-3d/box.geo'}, mesh-parameters: {{n: 32}}, "
            f"dimension: 3, density: 1, viscosity: {1 / reynolds:g}, projection: incremental, pressure-tolerance: 1e-4, "
            "initial-velocity: ['sin(x)*cos(y)*cos(z)', '-cos(x)*sin(y)*cos(z)', 0], output: {energy-budget: true}, "
            f"boundaries: {{{sides}}}}}}}\n")
        result = job.run([job.build / "bin/fluid_solver", "case.yaml"], 3600, cwd=folder)
        file = folder / "out/fluid/energy.csv"
        return (series.read_csv(file)["kinetic energy [J]"] if file.exists() else np.array([np.nan])), result.returncode
    return job.once(("vortices", reynolds), make)


def bounded(job, reynolds):
    energy, code = vortices(job, reynolds)
    gain = float(np.max(energy[1:] / energy[:-1]) - 1) if len(energy) > 1 else float("nan")
    return (f"energy never grows by more than {max(gain, 0):.1e} a step, {energy[-1] / energy[0]:.3g} of it left at the end, exit code {code}",
            code == 0 and len(energy) > TURNOVERS and gain < 1e-3 and energy[-1] < energy[0])
