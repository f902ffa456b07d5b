# SPDX-License-Identifier: Apache-2.0
"""Maps of solid_solver."""
import numpy as np

from couplet import series
from couplet.places import ROOT

from .atlas import Axis, Map

BEAM = """DefineConstant [ n = 20, m = 2, lean = 0 ];
Point(1) = {0, 0, 0}; Point(2) = {5 - lean, 0, 0}; Point(3) = {10, 0, 0};
Point(4) = {10, 1, 0}; Point(5) = {5 + lean, 1, 0}; Point(6) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 1}; Line(7) = {2, 5};
Transfinite Curve {1, 2, 4, 5} = n / 2 + 1; Transfinite Curve {3, 6, 7} = m + 1;
Curve Loop(1) = {1, 7, 5, 6}; Plane Surface(1) = {1}; Curve Loop(2) = {2, 3, 4, -7}; Plane Surface(2) = {2};
Transfinite Surface {1, 2}; Recombine Surface {1, 2};
Physical Curve("root") = {6}; Physical Curve("tip") = {3}; Physical Curve("sides") = {1, 2, 4, 5};
Physical Surface("beam") = {1, 2};
"""
CASE = """simulation: {{name: beam, end-time: {end}, time-step: {dt}, output: {{folder: out}}}}
participants:
  solid:
    program: solid_solver
    mesh: beam.geo
    mesh-parameters: {{n: {n}, m: {m}, lean: {lean}}}
    dimension: 2
    analysis: {analysis}
    material: {{density: 1, youngs-modulus: 1, poissons-ratio: {nu}}}
    solution-method: {{face-gradient: {gradient}}}
    boundaries:
      root: {{type: fixed-displacement, value: [0, 0]}}
      tip: {{type: {tip}}}
      sides: {{type: free}}
    probes: {{tip: {{point: [10, 0.5]}}}}
    {more}
"""
GRADIENTS = ["thesis", "corrected", "symmetric"]
SHARED = "symmetric, volume-strain: shared"  # as the case's solution-method reads it
STEPS, CELL = 2000, 0.5


def energy(panel, courant, lean, runner):
    """Free oscillation of a beam: largest energy in 2000 steps over that of the start, minus 1."""
    scheme, gradient = panel.split(", ")
    dt = courant * CELL / np.sqrt(1.35)  # c^2 = (lambda + 2 mu)/rho, nu 0.3, plane strain
    folder = runner.folder("energy", scheme, gradient, courant, lean)
    more = f"time-scheme: {{type: {scheme}}}\n    initial-velocity: ['0', '1e-5*x^2']\n    output: {{energies: true}}"
    code, doubted = runner.alone("solid_solver", folder, {
        "beam.geo": BEAM, "case.yaml": CASE.format(end=STEPS * dt, dt=dt, n=20, m=2, lean=lean, analysis="dynamic", nu=0.3,
                                                   gradient=gradient, tip="free", more=more)})
    if code != 0:
        return float("nan"), code, doubted
    rows = series.read_csv(folder / "out" / "solid" / "energies.csv")
    kinetic, work = rows["kinetic [J]"], rows["internal work [J]"]
    first = kinetic[0] + rows["strain [J]"][0] + rows["lost by the scheme [J]"][0]  # at the start: what is lost is so defined
    # Where the operator is not symmetric its work is no energy: the smaller of work and strain energy counts.
    held = kinetic + np.maximum(0, np.minimum(work, rows["strain [J]"]))
    return float(np.max(held) / first - 1), code, doubted


def deflection(runner, gradient, n, m, nu):
    """Displacement of the tip under a small shear there, cells n along and m across."""
    folder = runner.folder("static", gradient, n, m, nu)
    code, doubted = runner.alone("solid_solver", folder, {
        "beam.geo": BEAM, "case.yaml": CASE.format(end=1, dt=1, n=n, m=m, lean=0, analysis="static", nu=nu,
                                                   gradient=gradient, tip="traction, value: [0, 1e-6]", more="")})
    if code != 0:
        return float("nan"), code, doubted
    return float(series.read_csv(folder / "out" / "solid" / "probes.csv")["tip y [m]"][-1]), code, doubted


def stretch(gradient, aspect, across, runner):
    """Tip deflection over that of the fine mesh; cells `aspect` times as long as high."""
    along = max(2, 2 * round(10 * across / aspect / 2))
    reference, _, _ = runner.once(0.3, lambda: deflection(runner, "symmetric", 160, 16, 0.3))
    value, code, doubted = deflection(runner, gradient, along, int(across), 0.3)
    return value / reference, code, doubted


def poisson(gradient, nu, across, runner):
    """Tip deflection over that of the fine mesh of the symmetric gradient, square cells."""
    reference, _, _ = runner.once(nu, lambda: deflection(runner, "symmetric", 160, 16, nu))
    value, code, doubted = deflection(runner, gradient, 10 * int(across), int(across), nu)
    return value / reference, code, doubted


COLUMN = """simulation: {{name: column, end-time: 1, time-step: 1, output: {{folder: out}}}}
participants:
  solid:
    program: solid_solver
    mesh: column.geo
    mesh-parameters: {{n: {n}, nl: 100}}
    dimension: 2
    plane: {plane}
    analysis: static
    kinematics: {kinematics}
    material: {{density: 7800, youngs-modulus: 210e9, poissons-ratio: 0}}
    boundaries:
      root: {{type: fixed-displacement, value: [0, 0]}}
      tip: {{type: traction, value: [{push}, 100]}}
      sides: {{type: free}}
    probes: {{tip: {{point: [1, 0]}}}}
"""
EULER = np.pi ** 2 * 210e9 / 12 / 4 * 0.01 ** 2  # load that buckles a column clamped at one end, over its section [Pa]
KINEMATICS = {"linear": "small-strain", "large strain": "finite-strain"}


def pushed(panel, share, across, runner):
    """A column 100 times as long as thick under a share of its buckling load and a small load across: deflection over the beam column's."""
    folder = runner.folder("column", panel, share, across)
    code, doubted = runner.alone("solid_solver", folder, {
        "column.geo": (ROOT / "configs/buckling-column/column.geo").read_text(),
        "case.yaml": COLUMN.format(n=int(across), plane="strain", kinematics=KINEMATICS[panel], push=-share * EULER)})
    if code != 0:
        return float("nan"), code, doubted
    u = np.pi / 2 * np.sqrt(share)
    exact = 100 * 0.01 / (3 * 210e9 * 0.01 ** 3 / 12) * 3 * (np.tan(u) - u) / u ** 3
    return float(series.read_csv(folder / "out" / "solid" / "probes.csv")["tip y [m]"][-1]) / exact, code, doubted


MAPS = [
    Map("solid-energy", "Solid: energy of a free oscillation", "growth of the energy in 2000 steps",
        Axis("elastic Courant number", [0.1, 1, 10, 100]), Axis("lean of the cells (45 degrees at 0.5)", [0, 0.25, 0.5, 1, 2], log=False),
        ["trapezoidal, thesis", "trapezoidal, corrected", "trapezoidal, symmetric", "bathe, thesis", "bathe, corrected",
         "generalised-alpha, corrected"],
        energy, lambda g: max(0, g),
        about="""Mechanism: an operator that is not symmetric on oblique cells has eigenvalues off the axis; a time scheme without damping lets such
modes grow. Criterion: energy (kinetic, and the smaller of strain energy and work of the
stresses) beyond that of the start. The program warns from 0.1 on (tenfold energy ends the run); a few per cent are the difference of work and strain energy. The symmetric gradient comes from an energy: the
trapezoidal rule keeps it on every mesh. Damping schemes hide the others' growth where the step does not resolve the mode."""),
    Map("solid-stretch", "Solid: long cells", "tip deflection of a bent beam over the converged one",
        Axis("length over height of a cell", [1, 2, 5, 10, 20]), Axis("cells across", [1, 2, 4, 8]), [*GRADIENTS, SHARED], stretch,
        lambda r: abs(r - 1),
        about="""Mechanism: face gradients from differences along the long side miss the bending between two cells: too stiff (least squares), or too
soft and, far enough, of the wrong sign (the corrected one on few, long cells). `auto` takes what errs less, and the run's own energies and
its estimated error judge it (warned)."""),
    Map("solid-nu", "Solid: near incompressibility", "tip deflection of a bent beam over the converged one",
        Axis("Poisson's ratio", [0.3, 0.4, 0.45, 0.49, 0.499, 0.4999], log=False), Axis("cells across", [1, 2, 4, 8]), [*GRADIENTS, SHARED], poisson,
        lambda r: abs(r - 1),
        about="""Mechanism: a volume strain at every face asks for more conditions than there are unknowns as nu goes to 1/2: the mesh locks, or the
operator loses its sign. The symmetric gradient takes one volume strain per cell from nu = 0.4 up. `volume-strain: shared` leaves a tenth of the bulk
modulus, at most a third of the shear modulus, with the faces: it does not lock either and errs least in plane strain; its failing neighbour is the
three-dimensional bar with two cells across, 4.3 % too soft (docs/theory.md)."""),
    Map("solid-buckling", "Solid: load near the one that buckles", "tip deflection of a column over that of a beam column",
        Axis("load over the buckling load", [0.03, 0.1, 0.3, 0.5, 0.7, 0.9], log=False), Axis("cells across", [2, 4, 8]), list(KINEMATICS), pushed,
        lambda r: abs(r - 1),
        about="""Mechanism: a linear run does not know that a load along a column bends it further; the deflection across grows by 1/(1 - share).
The run itself estimates the load that buckles and how much of the deflection is of that shape, and warns where what is neglected is over 0.2 of
it. At large strain two or four long cells across are too stiff, which the load makes far worse: the estimated error does so, too. The truth is 3 (tan u - u)/u^3, u = pi/2 sqrt(share), of the deflection without load."""),
]
