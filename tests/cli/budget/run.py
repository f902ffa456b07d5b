# SPDX-License-Identifier: Apache-2.0
"""Scenes with a known error of their model: the largest part of the budget must be the right one, and its share near the truth, which
is a second run with the effect, or a closed form. Two scenes have an effect that does nothing: the run says what could be omitted.
Usage: run.py BIN CONFIGS quick|all|SCENE"""
import csv
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import mpmd  # noqa: E402

programs, configs, kind = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve(), sys.argv[3]


def run(job, case, sets, folder):
    """`job`: {participant: program}."""
    file = configs / case / "case.yaml"
    more = ["--diagnostics=full", *(f"--set={s}" for s in sets), f"--set=simulation.output.folder={folder}"]
    command = [str(programs / next(iter(job.values()))), str(file), *more]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    if done.returncode not in (0, 4):  # 4: a finding says that the answer is useless, as it may be
        sys.exit(f"FAILED: {case} {sets} ended with exit code {done.returncode}\n{done.stdout[-1500:]}{done.stderr[-1500:]}")
    return pathlib.Path(folder)


def budget(folder, name):
    return json.loads((folder / name / "run.json").read_text())["errors"]


def probe(folder, head, name="solid"):
    with open(folder / name / "probes.csv", newline="") as file:
        rows = list(csv.reader(file))
    at = rows[0].index(head)
    return [float(r[at]) for r in rows[1:]]


SOLID = {"solid": "solid_solver"}
FLUID = {"fluid": "fluid_solver"}
S, F = "participants.solid.", "participants.fluid."
BEAM = S + "mesh-parameters={n_length: 40, n_side: 4}"
DYNAMIC = [S + "analysis=dynamic", BEAM]


def pull(text):
    return S + "boundaries.tip={type: traction, value: %s}" % text


def against(job, case, sets, cure, head, last=True):
    """The share and the truth: what the run with the effect differs by, over the answer of the run without it."""
    def measure(folder):
        without, with_it = run(job, case, sets, folder / "without"), run(job, case, [*sets, *cure], folder / "with")
        a, b = probe(without, head), probe(with_it, head)
        n = min(len(a), len(b))
        pairs = [(a[-1], b[-1])] if last else list(zip(a[:n], b[:n]))
        truth = max(abs(x - y) for x, y in pairs) / max(abs(x) for x, _ in pairs)
        return budget(without, next(iter(job))), truth
    return measure


def closed(job, case, sets, truth):
    def measure(folder):
        return budget(run(job, case, sets, folder), next(iter(job))), truth
    return measure


def together(members, folder, files):
    """A coupled job of (program and its words); the coupler's budget."""
    folder.mkdir(parents=True)
    for name, text in files.items():
        (folder / name).write_text(text)
    environment = {**os.environ, "PYTHONPATH": str(configs.parent / "client/python")}
    done = subprocess.run(mpmd(members), cwd=folder, env=environment, capture_output=True, text=True, timeout=600)
    if done.returncode not in (0, 4):
        sys.exit(f"FAILED: {folder} ended with exit code {done.returncode}\n{done.stdout[-1500:]}{done.stderr[-1500:]}")
    return json.loads((folder / "out/coupler/run.json").read_text())["errors"]


def column(file, at):
    with open(file, newline="") as rows:
        return [float(r[at]) for r in csv.reader(rows) if r and r[0][0] in "-0123456789"]


def apart(without, with_it):
    n = min(len(without), len(with_it))
    return max(abs(a - b) for a, b in zip(without[:n], with_it[:n])) / max(map(abs, without))


# A mass on a spring in a fluid of two thirds of its mass, twenty steps per period.
LIGHT = """simulation: {{end-time: 5 s, time-step: 0.25 s, output: {{folder: out}}, accept: [interface-oscillation]}}
participants:
  fluid: {{program: toy_piston, vertices: 3, added-mass: 1 kg, driving-force: 1 N}}
  solid: {{program: toy_spring, vertices: 3, mass: 1.125 kg, stiffness: 3 N/m}}
coupling:
  scheme: {scheme}
  fluid: {{participant: fluid}}
  structure: {{participant: solid}}
  predictor: {{order: 1}}
  convergence: {{relative: 1e-8, max-iterations: 200}}
"""


def light(folder):
    members = [(programs / "coupler", "case.yaml"), (programs / "tests/toy_piston", "case.yaml"), (programs / "tests/toy_spring", "case.yaml")]
    parts, motion = {}, {}
    for scheme in ("explicit", "implicit"):
        parts[scheme] = together(members, folder / scheme, {"case.yaml": LIGHT.format(scheme=scheme)})
        motion[scheme] = column(folder / scheme / "out/fluid/motion.csv", 1)
    return parts["explicit"], apart(motion["explicit"], motion["implicit"])


def rough(folder):
    """The cylinder on its spring in a viscous fluid (configs/spring-cylinder), let go, with a structure that does not ask for friction."""
    case, client = configs / "spring-cylinder", (configs.parent / "client/examples/spring_cylinder.py").read_text()
    sets = ["--set=simulation.end-time=3 s", "--set=participants.fluid.viscosity=0.1 Pa s"]
    parts, motion = {}, {}
    for word, text in {"without": client.replace('job.takes("viscous-force", "N", "faces")\n', "").replace(' + job.read("viscous-force")[:, 1].sum()', ""), "with": client}.items():
        members = [(programs / p, "case.yaml", *sets) for p in ("coupler", "fluid_solver", "mesh_mover")] + [("/usr/bin/python3", "body.py", "body", 2, 0, 4, 0.01)]
        files = {"case.yaml": (case / "case.yaml").read_text(), "ring.geo": (case / "ring.geo").read_text(), "body.py": text}
        parts[word] = together(members, folder / word, files)
        motion[word] = column(folder / word / "body.csv", 1)
    return parts["without"], apart(motion["without"], motion["with"])


HEAT = [S + "material.conductivity=50 W/(m K)", S + "material.expansion=1.2e-5",
        S + "heat={analysis: steady, boundaries: {root: {type: temperature, value: 20 degC}, tip: {type: temperature, value: 95 degC}, sides: {type: adiabatic}}}"]
CYLINDER = [F + "mesh-parameters={n: 8}", "simulation.end-time=1 s", "simulation.time-step=0.01 s"]
COLUMN = [S + "analysis=static", S + "plane=strain", S + "output={}", S + "mesh-parameters={n: 4, nl: 100}", S + "probes={tip: {point: [1, 0]}}"]

SCENES = {  # what is neglected: how it is measured, the effect that the budget must name
    "hot bar without thermal strain": (against(SOLID, "cantilever", [*HEAT, BEAM, pull("[125, 0, 0]")],
                                               [S + "thermal-expansion={reference-temperature: 20 degC}"], "tip x [m]"), "thermal strain"),
    "fast pull as static": (against(SOLID, "cantilever", [BEAM, pull('[0, "125*sin(10*t)", 0]'), "simulation.end-time=2 s", "simulation.time-step=0.05 s"],
                                    [S + "analysis=dynamic"], "tip y [m]", last=False), "inertia"),
    "large deflection as linear": (against(SOLID, "cantilever", [BEAM, pull("[0, 8333, 0]")], [S + "kinematics=finite-strain"], "tip y [m]"),
                                   "geometric non-linearity"),
    "column at two thirds of its buckling load": (
        against(SOLID, "buckling-column", [*COLUMN, pull('["-3.2 MPa", "100 Pa"]')], [S + "kinematics=finite-strain"], "tip y [m]"), "geometric non-linearity"),
    # Prandtl and Glauert: pressures at Mach 0.4 are larger by 1/sqrt(1 - 0.16).
    "Mach 0.4, incompressible": (closed(FLUID, "cylinder", [*CYLINDER, F + "viscosity=4e-3 Pa s", F + "compressibility={speed-of-sound: 5 m/s, scheme: none}"],
                                        1 / math.sqrt(1 - 0.16) - 1), "compressibility"),
    # Wieselsberger's drag of a cylinder at Re 1e5 is 1.2; a coarse laminar run gives half as much again and more.
    "Re 1e5 without a turbulence model": (closed(FLUID, "cylinder", [*CYLINDER, F + "viscosity=1e-6 Pa s"], 0.5), "turbulence model"),
    "light solid coupled explicitly": (light, "iteration of pressure and structure"),
    "friction forgotten": (rough, "viscous coupling load"),
}
IDLE = {  # an effect that does nothing: what the run says could be omitted
    "slow ramp as dynamic": (SOLID, "cantilever", [*DYNAMIC, pull('[0, "125*t/2000", 0]'), "simulation.end-time=2000 s", "simulation.time-step=40 s"], "inertia"),
    "turbulence model in a laminar channel": (FLUID, "pulsing-channel", [F + "turbulence={model: wale}", F + 'boundaries.inlet={type: inlet, velocity: ["4*y*(1-y)", 0]}', F + 'initial-velocity=["4*y*(1-y)", 0]', "simulation.end-time=0.5 s"], "eddy viscosity in two dimensions"),
}
QUICK = ("hot bar without thermal strain", "large deflection as linear", "slow ramp as dynamic", "turbulence model in a laminar channel")


def chosen(name):
    return name in QUICK if kind == "quick" else kind in ("all", name)


def main():
    bad, near = 0, 0
    with tempfile.TemporaryDirectory(prefix="couplet-budget-") as temporary:
        for i, (name, (measure, effect)) in enumerate(SCENES.items()):
            if not chosen(name):
                continue
            parts, truth = measure(pathlib.Path(temporary) / str(i))
            numbers = {k: v for k, v in parts.items() if k in ("mesh", "step", "linear", "coupling", "model") and v is not None}
            right = max(numbers, key=numbers.get) == "model" and (parts["model-by"] or "").startswith(effect)
            close = 0.5 <= numbers.get("model", 0) / truth <= 2
            bad, near = bad + (not right), near + close
            print("ok    " if right else "FAILED", f"{name}: share {numbers.get('model', math.nan):.3g}, truth {truth:.3g}{' (near)' if close else ''};", numbers, parts["model-by"])
        for i, (name, (job, case, sets, effect)) in enumerate(IDLE.items()):
            if not chosen(name):
                continue
            parts = budget(run(job, case, sets, pathlib.Path(temporary) / f"idle{i}"), next(iter(job)))
            right = (parts["could-be-omitted"] or "").startswith(effect)
            bad += not right
            print("ok    " if right else "FAILED", f"{name}: could be omitted: {parts['could-be-omitted']}", parts)
    print(f"{near} shares within a factor of 2 of the truth")
    return bad > 0


if __name__ == "__main__":
    sys.exit(main())
