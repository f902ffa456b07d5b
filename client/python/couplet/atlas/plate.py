# SPDX-License-Identifier: Apache-2.0
"""Maps of plate_modal: a mass that bounces 60 times on a seat, by the program itself (rigid modes of a free sheet)."""
import numpy as np

from couplet import series

from .atlas import Axis, Map

SHEET = """Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve {1:4} = 5; Curve Loop(1) = {1:4}; Plane Surface(1) = {1}; Transfinite Surface {1};
Physical Curve("rim") = {1:4}; Physical Surface("sheet") = {1};
"""
CASE = """simulation: {{name: bounce, end-time: {end}, time-step: {dt}, output: {{folder: out}}}}
participants:
  sheet:
    program: plate_modal
    mesh: sheet.geo
    material: {{density: 1000, youngs-modulus: 1e9, poissons-ratio: 0.3}}
    thickness: 0.01
    boundaries: {{rim: {{type: free}}}}
    modes: {{number: 6}}
    gravity: [0, 0, -9.81]
    initial-velocity: [0, 0, 1]
    contact: {{height: "-0.005", stiffness: {kappa}, rule: {rule}}}
"""


def bounce(rule, kappa, dt, runner):
    """Largest energy over that of the start, minus 1. 10 kg/m^2: one contact lasts pi sqrt(10/kappa)."""
    folder = runner.folder("bounce", rule, kappa, dt)
    end = 60 * (2 / 9.81 + np.pi * np.sqrt(10 / kappa))
    code, doubted = runner.alone("plate_modal", folder, {"sheet.geo": SHEET, "case.yaml": CASE.format(
        end=dt * round(end / dt), dt=dt, kappa=kappa, rule=rule)})
    if code != 0:
        return float("nan"), code, doubted
    rows = series.read_csv(folder / "out" / "sheet" / "energies.csv")
    return float(np.max(np.abs(rows["mismatch [J]"])) / 5), code, doubted


KAPPAS = [1e4, 1e5, 1e6, 1e7, 1e8]
MAPS = [
    Map("plate-contact", "Plate: bounces on a seat", "energy that the scheme made or lost in 60 bounces, over the start's",
        Axis("stiffness of the seat [N/m^3]", KAPPAS), Axis("step [s]", [3e-4, 1e-3, 3e-3, 1e-2]), ["conserving", "midpoint"], bounce,
        lambda v: v,
        theory=[(None, "one step a contact", [(k, np.pi * np.sqrt(10 / k)) for k in np.geomspace(1e4, 1e8, 60)])],
        about="""Mechanism: the seat's spring is met and left within a step; a rule that does not know where adds or takes energy each time. The
conserving rule keeps it whatever the step; the midpoint rule wants fifty steps a contact. 1000 bounces of the same: `configs/plate-drop/stability.py`."""),
]
