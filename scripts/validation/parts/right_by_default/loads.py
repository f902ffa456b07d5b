# SPDX-License-Identifier: Apache-2.0
"""Loads by their total: resultants, motions and meshes of CalculiX, by the shipped program with default settings."""
import math

import couplet
from validation.parts.right_by_default.scenes import beam_theory, probe, warnings

S = "participants.solid."
B = f"{S}boundaries."
# CalculiX 2.20, 15 240 C3D15, *DISTRIBUTING coupling: configs/eye-bar/README.md [m]
EYE = {"x": 2.61935e-5, "y": -4.24706e-5}
PIN, WEIGHT = 20e3, -200.0
BEAM = ("participants.solid.mesh-parameters={n: 2, nl: 20, L: 10, shape: 1}", f"{S}probes.tip.point=[10, 0.5, 0.5]")


def last(run, name):
    return {key: values[-1] for key, values in couplet.read_csv(run.folder / "solid" / name).items()}


def remote(point, force, moment=(0, 0, 0)):
    return "%stip={type: remote-load, point: %s, force: %s, moment: %s}" % (B, list(point), list(force), list(moment))


def eye_resultant(job, *sets):
    r = last(job.alone("eye-bar", sets), "reactions.csv")
    load = math.hypot(r["load x [N]"] - PIN, r["load y [N]"] - WEIGHT, r["load z [N]"]) / PIN
    held = math.hypot(*(r[f"clamp {a} [N]"] + r[f"load {a} [N]"] for a in "xyz")) / PIN
    return f"load {load:.1e}, reaction {held:.1e}", load <= 1e-12 and held <= 1e-9


def eye_ranks(job):
    one, *more = (job.alone("eye-bar", (f"{S}solution-method.relative-tolerance=1e-12",), n) for n in (1, 2, 3))
    worst = max(abs(probe(run, f"end {a} [m]") - probe(one, f"end {a} [m]")) for run in more for a in "xy") / abs(EYE["y"])
    return f"{worst:.1e}", worst <= 1e-8


def rigid_end(job):
    """The same where the tip moves as a rigid body; its centre moves with the load by the same theory."""
    arm = 5
    right = beam_theory(10) + 100 * arm * 10**2 / (2 * 210e9 / 12)
    tip = "%stip={type: remote-load, point: [%g, 0.5, 0.5], force: [0, 100, 0], coupling: rigid}" % (B, 10 + arm)
    run = job.alone("slender-beam", (*BEAM, tip))
    r = last(run, "reactions.csv")
    error, held = probe(run, "tip y [m]") / right - 1, abs(r["root y [N]"] / 100 + 1)
    return f"{100 * error:+.2f} %, reaction {held:.1e}, {len(warnings(run))} warnings", abs(error) <= 0.03 and held <= 1e-6 and not warnings(run)


def dam(job):
    """Water against the side of an upright wall of 10 m, 3 cells of which a level of 7.3 m cuts: rho g h^2 / 2 on 1 m."""
    level, weight = 7.3, 1000 * 9.81
    run = job.alone("slender-beam", (
        *BEAM, f"{B}tip={{type: free}}",
        "%ssides={type: free, parts: [{where: y < 1e-9, type: hydrostatic-pressure, density: 1000, gravity: [-9.81, 0, 0], level: %g}]}"
        % (B, level)))
    r, wanted = last(run, "reactions.csv"), weight * level**2 / 2
    error = math.hypot(r["load y [N]"] - wanted, r["load x [N]"], r["load z [N]"]) / wanted
    return f"{error:.1e}", error <= 1e-12


DECK = """*HEADING
a bar of 2 x 1 x 1
*NODE, NSET=NALL
%s*ELEMENT, TYPE=C3D8R, ELSET=EALL
%s*NSET, NSET=root
%s*SURFACE, NAME=tip
%s*SOLID SECTION, ELSET=EALL, MATERIAL=steel
*STEP
*END STEP
"""


def deck(n):
    """A skewed bar of n x n x 2n C3D8, clamped side as a set of nodes, pulled side as a surface."""
    m = 2 * n
    number = {}
    lines = ""
    for i in range(m + 1):
        for j in range(n + 1):
            for k in range(n + 1):
                number[i, j, k] = len(number) + 1
                bend = 0.04 * math.sin(7 * i + 3 * j + k) if 0 < i < m and 0 < j < n and 0 < k < n else 0
                lines += f"{number[i, j, k]}, {2 * i / m + bend!r}, {j / n + bend!r}, {k / n - bend!r}\n"
    elements, tip = "", ""
    cells = [(i, j, k) for i in range(m) for j in range(n) for k in range(n)]
    for e, (i, j, k) in enumerate(cells, 1):
        corners = [(i, j, k), (i + 1, j, k), (i + 1, j + 1, k), (i, j + 1, k)]
        nodes = [number[c] for c in corners] + [number[a, b, c + 1] for a, b, c in corners]
        elements += f"{e}, {', '.join(map(str, nodes))}\n"
        tip += f"{e}, S4\n" if i == m - 1 else ""
    root = "".join(f"{v}\n" for (i, _, _), v in number.items() if i == 0)
    return DECK % (lines, elements, root, tip)


PULLED = """simulation: {name: pulled, end-time: 1 s, time-step: 1 s, output: {folder: out}}
participants:
  solid:
    program: solid_solver
    mesh: bar.inp
    dimension: 3
    analysis: static
    material: {density: 7850, youngs-modulus: 210 GPa, poissons-ratio: 0.3}
    boundaries:
      root: {type: fixed-displacement, value: [0, '-3e-6*y', '-3e-6*z']}
      tip: {type: force, value: [2.1 MN, 0 N, 0 N]}
      rest: {type: free}
    probes: {tip: {point: [2, 0, 0]}, inside: {point: [1.0, 0.5, 0.5]}}
    solution-method: {relative-tolerance: 1e-13}
"""


def calculix_mesh(job):
    """A linear field on a mesh in a .inp: E eps = 2.1 MPa along x, and across -nu times it."""
    folder = job.scratch / "inp"
    folder.mkdir(exist_ok=True)
    (folder / "bar.inp").write_text(deck(3))
    (folder / "case.yaml").write_text(PULLED)
    run = job.case_run(folder / "case.yaml", folder / "out", (), {"solid": 1}, 600)
    wanted = {"tip x [m]": 2e-5, "inside x [m]": 1e-5, "inside y [m]": -1.5e-6, "inside z [m]": -1.5e-6}
    worst = max(abs(probe(run, key) - u) for key, u in wanted.items()) / 2e-5
    return f"{worst:.1e}", worst <= 1e-9
