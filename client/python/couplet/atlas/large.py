# SPDX-License-Identifier: Apache-2.0
"""Maps of solid_solver at large strain."""
from couplet import series

from .atlas import Axis, Map
from .solid import BEAM

CASE = """simulation: {{name: beam, end-time: {end}, time-step: {dt}, output: {{folder: out}}, max-step-halvings: {halvings}}}
participants:
  solid:
    program: solid_solver
    mesh: beam.geo
    mesh-parameters: {{n: {n}, m: {m}}}
    dimension: 2
    analysis: {analysis}
    kinematics: finite-strain
    material: {{density: 1, youngs-modulus: 1, poissons-ratio: {nu}, law: {law}}}
    solution-method: {{{method}}}
    boundaries:
      root: {{type: fixed-displacement, value: [0, 0]}}
      tip: {{type: {tip}}}
      sides: {{type: free}}
    probes: {{tip: {{point: [10, 0.5]}}}}
    {more}
"""
SEGREGATED = "type: segregated, acceleration: anderson, max-iterations: 20000, relative-tolerance: 1e-6"
LOAD = 1 / 12 / 100  # of K = 1: E I / L^2 for a unit of depth


def bent(runner, key, K, step, **what):
    """Deflection of the tip under K t, t to 1, over the length; exit code; warnings."""
    given = dict(end=1, dt=step, halvings=10, n=20, m=2, analysis="static", nu=0.3, law="neo-hookean", method="type: auto",
                 tip=f"traction, value: ['0', '{K * LOAD!r}*t']", more="")
    folder = runner.folder("bent", *key)
    code, doubted = runner.alone("solid_solver", folder, {"beam.geo": BEAM, "case.yaml": CASE.format(**{**given, **what})})
    if code != 0:
        return float("nan"), code, doubted
    return float(series.read_csv(folder / "out" / "solid" / "probes.csv")["tip y [m]"][-1]) / 10, code, doubted


NU = {"one volume ratio per cell": "volume-strain: cells", "one per face": "volume-strain: faces", "segregated, least-squares gradient": SEGREGATED}


def poisson(panel, nu, across, runner):
    """Over the deflection of the fine mesh, K = 2, nearly incompressible neo-Hookean law."""
    law = "nearly-incompressible-neo-hookean"
    fine = dict(n=160, m=16, law=law, nu=nu, halvings=4, method="volume-strain: cells")
    reference, _, _ = runner.once(nu, lambda: bent(runner, ("fine", nu), 2, 0.5, **fine))
    value, code, doubted = bent(runner, (panel, nu, across), 2, 0.25, n=10 * int(across), m=int(across), law=law, nu=nu,
                                method=NU[panel])
    return value / reference, code, doubted


SCHEMES = {"trapezoidal": "time-scheme: {type: trapezoidal}", "energy-momentum": "energy-momentum: true", "bathe": "time-scheme: {type: bathe}",
           "generalised-alpha": "time-scheme: {type: generalised-alpha}", "euler": "time-scheme: {type: euler}"}
PERIOD, PERIODS = 62.0, 50  # of the first bending vibration, linear: 2 pi L^2 / (1.8751^2 sqrt(E I / rho A))


def swing(scheme, steps, speed, runner):
    """Largest relative change of the energy of a free oscillation over 50 periods."""
    dt = PERIOD / steps
    folder = runner.folder("swing", scheme, steps, speed)
    more = f"{SCHEMES[scheme]}\n    initial-velocity: ['0', '{speed!r}*x^2/100']\n    output: {{energies: true}}"
    code, doubted = runner.alone("solid_solver", folder, {
        "beam.geo": BEAM, "case.yaml": CASE.format(end=PERIODS * PERIOD, dt=dt, halvings=10, n=10, m=1, analysis="dynamic", nu=0.3,
                                                   law="neo-hookean", method="type: auto", tip="free", more=more)})
    if code != 0:
        return float("nan"), code, doubted
    rows = series.read_csv(folder / "out" / "solid" / "energies.csv")
    held = rows["kinetic [J]"] + rows["strain [J]"]
    first = held[0] + rows["lost by the scheme [J]"][0]
    strays = held / first - 1
    return float(strays[abs(strays).argmax()]), code, doubted


LAWS = {"neo-Hookean, Newton": dict(), "Saint Venant-Kirchhoff, Newton": dict(law="saint-venant-kirchhoff"),
        "neo-Hookean, segregated": dict(method=SEGREGATED)}


def cut_back(panel, step, halvings, runner):
    """Deflection at K = 10 over that of forty load steps; the whole load is stepped by K `step`."""
    reference, _, _ = runner.once(panel, lambda: bent(runner, ("small steps", panel), 10, 0.025, halvings=4, **LAWS[panel]))
    value, code, doubted = bent(runner, (panel, step, halvings), 10, step / 10, halvings=int(halvings), **LAWS[panel])
    return value / reference, code, doubted


MAPS = [
    Map("large-nu", "Large strain: near incompressibility", "tip deflection at K = 2 over the converged one",
        Axis("Poisson's ratio", [0.3, 0.4, 0.45, 0.49, 0.499, 0.4999], log=False), Axis("cells across", [1, 2, 4, 8]), list(NU), poisson,
        lambda r: abs(r - 1),
        about="""Mechanism: as at small strain: one volume ratio per face locks as nu approaches 1/2; one per cell does not, with its pressures as
unknowns of Newton's method from nu = 0.48. The neighbours: one per face, and the least-squares gradient with the segregated method, whose iterations also stop
converging. A beam 10:1 bent to 0.4 of its length. Locking at large strain is stable but too stiff."""),
    Map("large-swing", "Large strain: energy of free oscillations over 50 periods", "largest change of the energy in parts of the first",
        Axis("steps per period", [10, 20, 40, 80]), Axis("first velocity of the tip", [0.05, 0.2, 0.5]), list(SCHEMES), swing,
        abs,
        about="""Mechanism: a scheme that conserves the energy of linear bodies need not conserve that of a nonlinear law: the trapezoidal rule
gains or loses energy with large rotations in long steps, until Newton's method fails or the energy guard ends the run. The energy-momentum stress
(`energy-momentum: true`) conserves it to the solver's tolerance; Bathe, generalised-alpha and Euler dissipate. Beam 10:1 of ten cells."""),
    Map("large-load", "Large strain: load step and cut-back", "tip deflection at K = 10 over that of small load steps",
        Axis("load step in parts of K", [0.5, 1, 2, 5, 10]), Axis("halvings that are allowed", [0, 1, 2, 4, 8], log=False), list(LAWS), cut_back,
        lambda r: abs(r - 1),
        about="""Mechanism: from too far away Newton's method inverts cells; a failed step is halved up to
`simulation.max-step-halvings` times. Without halving a long load step fails; with it the same result is found: equilibria do not depend on the path.
The segregated method's answer depends on the load steps a little, since its geometry is updated after each."""),
]
