# SPDX-License-Identifier: Apache-2.0
"""Maps of fluid_solver."""
import numpy as np

from couplet import series

from .atlas import Axis, Map

BOX = """DefineConstant [ n = 16, lean = 0, aspect = 1 ];
h = 1 / aspect; s = lean;
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1 + s * h, h, 0}; Point(4) = {s * h, h, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve {1:4} = n + 1; Curve Loop(1) = {1:4}; Plane Surface(1) = {1}; Transfinite Surface {1}; Recombine Surface {1};
Physical Curve("bottom") = {1}; Physical Curve("right") = {2}; Physical Curve("top") = {3}; Physical Curve("left") = {4};
Physical Surface("fluid") = {1};
"""
CASE = """simulation: {{name: noise, end-time: {end}, time-step: {dt}, output: {{folder: out}}}}
participants:
  fluid:
    program: fluid_solver
    mesh: box.geo
    mesh-parameters: {{n: 16, lean: {lean}, aspect: {aspect}}}
    dimension: 2
    density: 1
    viscosity: {mu}
    viscous: {viscous}
    scheme: {scheme}
    time-step: {dt}
    initial-velocity: {start}
    output: {{energy-budget: true}}
    boundaries:
      left: {{type: periodic, partner: right}}
      right: {{type: periodic, partner: left}}
      bottom: {{type: periodic, partner: top}}
      top: {{type: periodic, partner: bottom}}
"""
PANELS = {"explicit, Adams-Bashforth": ("explicit", "adams-bashforth"), "implicit viscous term": ("implicit", "adams-bashforth"),
          "explicit, Runge-Kutta": ("explicit", "runge-kutta")}
STEPS, H = 300, 1 / 16


def run(runner, key, panel, dt, mu, lean, aspect, start):
    viscous, scheme = PANELS[panel]
    folder = runner.folder(*key)
    code, doubted = runner.alone("fluid_solver", folder, {"box.geo": BOX, "case.yaml": CASE.format(
        end=STEPS * dt, dt=dt, mu=mu, lean=lean, aspect=aspect, viscous=viscous, scheme=scheme, start=start)})
    return code, doubted, folder


def growth(folder):
    rows = series.read_csv(folder / "out" / "fluid" / "energy.csv")
    name = next(k for k in rows if k.startswith("kinetic") or k.startswith("energy"))
    return float(np.max(rows[name]) / rows[name][0])


def diffusion(panel, number, lean, runner):
    """Noise in a viscous fluid at rest, sheared cells, 300 steps: largest kinetic energy over the first."""
    noise = '["1e-3*sin(300*x+170*y)*cos(430*y)", "1e-3*cos(290*x-410*y)"]'
    code, doubted, folder = run(runner, ("diffusion", panel, number, lean), panel, number * H * H / 0.1, 0.1, lean, 1, noise)
    return (growth(folder) if code == 0 else float("nan")), code, doubted


def convection(panel, courant, lean, runner):
    """A shear layer of noise advected by a uniform stream, almost inviscid: largest kinetic energy over the first."""
    start = '["1+0.1*sin(44*y)*cos(19*x)", "0.1*sin(38*x)"]'
    code, doubted, folder = run(runner, ("convection", panel, courant, lean), panel, courant * H / 1.1, 1e-5, lean, 1, start)
    return (growth(folder) if code == 0 else float("nan")), code, doubted


def aspect(panel, ratio, number, runner):
    """Noise in flat cells; the step in terms of the flat side."""
    noise = '["1e-3*sin(30*x)", "1e-3*cos(29*x)"]'
    h = H / ratio
    code, doubted, folder = run(runner, ("aspect", panel, ratio, number), panel, number * h * h / 0.1, 0.1, 0, ratio, noise)
    return (growth(folder) if code == 0 else float("nan")), code, doubted


LEANS = [0, 0.5, 1, 2, 3]
MAPS = [
    Map("fluid-diffusion", "Fluid: viscous step on sheared cells", "largest kinetic energy over the first, noise in 300 steps",
        Axis("nu dt/h^2", [0.05, 0.1, 0.12, 0.15, 0.25, 0.5, 5]), Axis("tangent of the shear angle", LEANS, log=False), list(PANELS), diffusion,
        lambda g: max(0, g - 1),
        theory=[(["explicit, Adams-Bashforth"], "1/(4 (2 + tan^2))", [(1 / (4 * (2 + s * s)), s) for s in np.linspace(0, 3, 61)]),
                (["explicit, Runge-Kutta"], "2.51/(4 (2 + tan^2))", [(2.51 / (4 * (2 + s * s)), s) for s in np.linspace(0, 3, 61)])],
        about="""Mechanism: explicit diffusion beyond the largest eigenvalue, 4 nu (2 + tan^2)/h^2 on cells sheared by that angle: Adams-Bashforth 2 is stable
up to 1, three stages up to 2.51 of it. The energy guard of the fluid ends unstable runs. The implicit term has no limit on these quadrilaterals; on triangles, tetrahedra and prisms it is bounded (theory, oblique cells)."""),
    Map("fluid-convection", "Fluid: Courant number on sheared cells", "largest kinetic energy over the first, 300 steps",
        Axis("Courant number", [0.2, 0.5, 1, 1.5, 2, 3]), Axis("tangent of the shear angle", LEANS[:4], log=False), list(PANELS), convection,
        lambda g: max(0, g - 1),
        about="""Mechanism: Adams-Bashforth 2 grows slowly on the imaginary axis and at once beyond its region; three Runge-Kutta stages are stable up to
1.73 of the sum over the directions. The fluid's energy guard ends what grows."""),
    Map("fluid-aspect", "Fluid: flat cells", "largest kinetic energy over the first, noise in 300 steps",
        Axis("length over height of a cell", [1, 10, 100, 1000]), Axis("nu dt over height squared", [0.1, 0.2, 1, 10]), list(PANELS)[:2], aspect,
        lambda g: max(0, g - 1),
        about="""Mechanism: the flat side alone decides the explicit viscous step (1/4 in one direction); the pressure matrix becomes stiff by the square
of the ratio. The implicit term is stable at any step on these boxes."""),
]
