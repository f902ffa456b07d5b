# SPDX-License-Identifier: Apache-2.0
"""Maps of strong coupling: the Robin interface over an elastic wall (tests/coupling/string), closed fluids under a lid
(configs/closed-cavity)."""
import math
import re

from couplet.places import ROOT
from couplet import series

from .atlas import Axis, Map

MU = 5 / (math.pi * math.tanh(0.1 * math.pi))  # added mass of the wall's first mode [m]


def changed(text, *pairs):
    for old, new in pairs:
        text, count = re.subn(old, new, text, count=1, flags=re.M)
        if count == 0:
            raise ValueError(f"nothing in the case matches {old}")
    return text


def accelerated(kind, relaxation):
    return f"acceleration: {{type: {kind}, initial-relaxation: {relaxation}, filter: 1e-5}}"


WALL = {"Aitken": ("aitken", 0), "Robin, IQN-ILS": ("iqn-ils", 1), "Robin, no acceleration": ("constant", 1),
        "Robin, mass 4 times too large, no acceleration": ("constant", 4), "IQN-ILS": ("iqn-ils", 0)}
WALL_STEPS = 8


def wall(panel, inverse, dt, runner):
    """Passes per step."""
    kind, share = WALL[panel]
    folder = runner.folder("wall", panel, inverse, dt)
    here = ROOT / "tests" / "coupling" / "string"
    text = changed((here / "case.yaml").read_text(), (r"end-time: .*", f"end-time: {WALL_STEPS * dt}"), (r"time-step: .*", f"time-step: {dt}"),
                   (r"  max-step-halvings: 0\n", ""), (r"pulse-duration: .*", f"pulse-duration: {WALL_STEPS * dt}"), (r"surface-density: .*", f"surface-density: {MU * inverse}"),
                   (r"scheme: implicit", "scheme: semi-implicit"), (r"order: 1", "order: 2"), (r"on-divergence: warn", "on-divergence: stop"),
                   (r"acceleration: .*", accelerated(kind, 1 if share else inverse / (1 + inverse))))
    if share:
        text = changed(text, (r"\{type: interface\}", f"{{type: interface, surface-density: {share * MU * inverse}}}"),
                       (r"scheme: semi-implicit", "scheme: semi-implicit\n  order: structure-first"))
    code, doubted = runner.job(["coupler", "fluid_solver", "toy_wall"], folder,
                               {"case.yaml": text, "channel.geo": (here / "channel.geo").read_text()})
    return (series.passes_a_step(folder / "out") if code == 0 else math.nan), code, doubted


LID = {"level, IQN-ILS": ("structure", "iqn-ils"), "level, Aitken": ("structure", "aitken"), "without a level": ("none", "iqn-ils")}
LID_STEPS = 8


def lid(panel, modulus, dt, runner):
    """Passes per step; the error is that of the volume."""
    level, kind = LID[panel]
    folder = runner.folder("lid", panel, modulus, dt)
    case = ROOT / "configs" / "closed-cavity"
    text = changed((case / "case.yaml").read_text(), (r"end-time: .*", f"end-time: {LID_STEPS * dt}"),
                   (r"time-step: .*", f"time-step: {dt}"), (r"youngs-modulus: [^,]*", f"youngs-modulus: {modulus}"),
                   (r"0\.15 \* sin\(2 \* pi \* t\)", f"0.001 / {dt} * sin(2 * pi * t / {16 * dt})"), (r"volume-level: \w+", f"volume-level: {level}"),
                   (r"acceleration: .*", accelerated(kind, 0.5)), (r"mesh: fluid.geo", "mesh: fluid.geo\n    mesh-parameters: {n: 8}"),
                   (r"mesh: lid.geo", "mesh: lid.geo\n    mesh-parameters: {n: 8}"),
                   (r"(mover:\n    program: mesh_mover\n    mesh: fluid.geo)", r"\1\n    mesh-parameters: {n: 8}"))
    files = {"case.yaml": text, **{f: (case / f).read_text() for f in ("fluid.geo", "lid.geo")}}
    code, doubted = runner.job(["coupler", "fluid_solver", "solid_solver", "mesh_mover"], folder, files)
    if code != 0:
        return math.nan, code, doubted
    volume = series.read_csv(folder / "out" / "coupler" / "volume.csv")
    return series.passes_a_step(folder / "out"), code, doubted, float(abs(volume["fluid volume error [m^3]"]).max() / volume["fluid inflow [m^3]"].max())


MAPS = [
    Map("strong-robin", "Strong coupling: Robin interface, mass of the wall and step", "passes per step",
        Axis("rho_s h / (rho_f mu_1)", [0.05, 0.3, 1, 5, 20]), Axis("step [s]", [1e-4, 1e-3, 1e-2]), list(WALL)[:4], wall,
        lambda k: 0 if k <= 4.5 else 0.1,
        about="""Mechanism: the pressure equation foresees what the wall will answer, with its mass per area; what is left over is what springs and neighbours
change in that. The neighbours: Aitken without it, whose passes grow with the added mass, and a mass that is given four times too large: above the true
one the error is thrown over, and with much added mass it grows. Pale squares hold but take over 4.5 passes; first steps, with nothing learnt, count; each step converged."""),
    Map("strong-cavity", "Strong coupling: closed box, stiffness of its lid and step", "passes per step",
        Axis("Young's modulus of the lid [Pa]", [1e5, 1e7, 1e9]), Axis("step [s]", [2e-3, 2e-2, 2e-1]), list(LID), lid,
        about="""Mechanism: nothing but the lid can give way to what is pumped in. The pressure level that makes it do so is found from its answer to a pressure;
what is iterated then keeps the volume (colours: its error over the inflow). Without the level the fluid refuses to start."""),
]
