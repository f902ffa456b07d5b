#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What each error estimator is worth: the estimated error of short runs beside the true one, with all estimators and without each of them.

  ablation.py run [--build BUILD] [--only NAME]   runs that BUILD/ablation.json does not have yet; --only: those whose name holds this
  ablation.py write [--build BUILD]               docs/validation/ablation.md from that file

The programs are linked from copies of some sources in which an environment variable switches one estimator off (SWITCHES); neither the sources
nor the build change. A copy also has a timer per diagnostic, which gives the shares of processor time."""
import argparse
import csv
import dataclasses
import datetime
import hashlib
import json
import math
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs/validation/ablation.md"
PROGRAMS = ("solid_solver", "fluid_solver", "mesh_mover", "plate_modal", "thermocline", "coupler")

# -- switches -----------------------------------------------------------------------------------------------------------
ERROR, STRAIN, FLOW, FRONT = ("solid_solver/diagnostics/error.cpp", "solid_solver/diagnostics/strain_energy.cpp",
                              "fluid_solver/diagnostics/error.cpp", "thermocline/diagnostics/front.cpp")
SWITCHES = {  # program: {estimator: [(file, text, what stands there without it)]}; OFF is the condition
    "solid_solver": {
        "residual of a reconstruction": [(ERROR, "  if (displacement_)\n", "  if (displacement_ && !OFF)\n")],
        "recovered strains": [(STRAIN, "  return body.is_dynamic() || body.seat() || has_finite_strain(body.parameters());",
                               "  return !OFF && (body.is_dynamic() || body.seat() || has_finite_strain(body.parameters()));")],
        "variation within quadrilaterals": [("solid_solver/body/recovered_strain.cpp", "return mesh.dim == 2 && ", "return !OFF && mesh.dim == 2 && ")],
        "errors of the steps": [(ERROR, "parts.step = steps_.over_size();", "parts.step = OFF ? unknown : steps_.over_size();")],
        "residual of the solver": [(ERROR, "parts.linear = body_.is_dynamic()", "parts.linear = OFF ? 0. : body_.is_dynamic()")],
        "quadratics of the neighbors (stress)": [("solid_solver/output/probes.cpp", "body.is_dynamic() ? std::nan", "OFF || body.is_dynamic() ? std::nan")],
    },
    "fluid_solver": {
        "recovered velocity": [(FLOW, "parts.mesh = recovered_difference() / scale;", "parts.mesh = OFF ? 0 : recovered_difference() / scale;")],
        "errors of the steps": [(FLOW, "parts.step = step_part()", "parts.step = OFF ? 0 : step_part()")],
        "vector sum where a clock drives": [(FLOW, "    if (acts) return", "    if (acts && !OFF) return")],
        "residual of the pressure": [(FLOW, "    parts.linear =\n", "    parts.linear = OFF ? 0. :\n")],
    },
    "plate_modal": {
        "corners against means": [("plate_modal/diagnostics/mesh.cpp", "if (!view.parameters.modes_file)", "if (!OFF && !view.parameters.modes_file)")],
        "errors of the steps": [("plate_modal/diagnostics/steps.cpp", "report.errors.step = errors_", "if (!OFF) report.errors.step = errors_")],
    },
    "thermocline": {
        "spreading of the profile": [(FRONT, "    report.errors = spread_profile();", "    if (!OFF) report.errors = spread_profile();")],
        "bed left unused": [(FRONT, "if (const double unused = unused_by_spreading(1); ", "if (const double unused = unused_by_spreading(1); !OFF && ")],
        "way of the front": [(FRONT, "{ return std::min(1., seen_->flow", "{ return OFF ? 1. : std::min(1., seen_->flow")],
    },
    "coupler": {
        "contraction of the iteration": [("coupler/diagnostics/iteration.cpp", "      report.errors.coupling = std::fmax", "      if (!OFF) report.errors.coupling = std::fmax")],
    },
}
# Each diagnostic has a timer of its own.
TIMERS = [("common/diagnostics/diagnostics.cpp", f"one.diagnostic->{call}(report);",
           f'{{ const auto begin_ = std::chrono::steady_clock::now(); one.diagnostic->{call}(report); log::timers().add(one.name_of_timer(), '
           'std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count()); }') for call in ("observe", "look", "conclude")]
PROLOGUE = """#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string_view>
namespace { [[maybe_unused]] bool is_off_(std::string_view name) { const char* off = std::getenv("COUPLET_WITHOUT"); return off && name == off; } }
"""
# Why one that moves the coverage by less than three points stays.
KEPT = {
    "solid_solver: recovered strains": "the only estimate for dynamic runs, with a contact seat and at large strain",
    "solid_solver: variation within quadrilaterals": "no reconstruction includes this error: the estimate for the ring is 1.2 instead of 0.17 times the true error",
    "solid_solver: errors of the steps": "the only estimate of this part",
    "solid_solver: residual of the solver": "the only estimate of this part",
    "solid_solver: quadratics of the neighbors (stress)": "the only estimate of this part",
    "fluid_solver: residual of the pressure": "the only estimate of this part; it is based on the last step alone, which is too little for flows that start",
    "plate_modal: corners against means": "the only estimate of this part",
    "plate_modal: errors of the steps": "the only estimate of this part",
    "coupler: contraction of the iteration": "the only estimate of this part",
}


def text_of(*command, **options):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, check=True, **options).stdout


def altered():
    """Returns {file: its text with the switches}."""
    texts = {}
    edits = [(file, old, new.replace("OFF", f'is_off_("{program}: {name}")')) for program, some in SWITCHES.items() for name, list_ in some.items() for file, old, new in list_]
    edits += [(file, old, new.replace("one.name_of_timer()", '"diagnostic: " + one.name')) for file, old, new in TIMERS]
    for file, old, new in edits:
        text = texts.setdefault(file, (ROOT / file).read_text())
        if text.count(old) < 1:
            sys.exit(f"'{old}' is not in {file}")
        texts[file] = text.replace(old, new)
    return texts


def link(build, folder):
    """Programs with the switches, in `folder`: their batches of sources are compiled again from the altered texts, and linked before the libraries."""
    texts, objects = altered(), {}
    for line in text_of("ninja", "-C", build, "-t", "commands").splitlines():
        if " -c " not in line:
            continue
        source = pathlib.Path(line.rsplit(" -c ", 1)[1])
        batch = [m for m in re.findall(r'#include "(.*)"', source.read_text())] if "Unity" in source.parts else [str(source)]
        mine = [f for f in batch if pathlib.Path(f).is_relative_to(ROOT) and str(pathlib.Path(f).relative_to(ROOT)) in texts]
        if not mine:
            continue
        parts = []
        for f in batch:
            copy = folder / "sources" / pathlib.Path(f).relative_to(ROOT) if f in mine else pathlib.Path(f)
            if f in mine:
                copy.parent.mkdir(parents=True, exist_ok=True)
                copy.write_text(texts[str(pathlib.Path(f).relative_to(ROOT))])
            parts.append(f'#include "{copy}"\n')
        new = folder / f"{len(objects)}.cpp"
        new.write_text(PROLOGUE + "".join(parts))
        words = shlex.split(line)
        library = next(w for w in words if ".dir/" in w).split(".dir/")[0].split("/")[-1]
        for option in ("-MT", "-MF"):
            del words[words.index(option):words.index(option) + 2]
        words = [w for w in words if w != "-MD" and not w.endswith("ccache")]
        made = new.with_suffix(".o")
        words[words.index("-o") + 1], words[words.index("-c") + 1] = str(made), str(new)
        print("compiles", library, *(pathlib.Path(f).name for f in mine), flush=True)
        text_of(*words, cwd=build)
        objects[made] = f"lib{library}.a"
    (folder / "bin").mkdir()
    for program in PROGRAMS:
        words = [w for w in shlex.split(text_of("ninja", "-C", build, "-t", "commands", program).splitlines()[-1]) if w not in (":", "&&")]
        libraries = {pathlib.Path(w).name for w in words}
        words[words.index("-o") + 1] = str(folder / "bin" / program)
        first = next(k for k, w in enumerate(words) if w.endswith(".a"))
        words[first:first] = [str(o) for o, library in objects.items() if library in libraries]
        text_of(*words, cwd=build)
    return folder / "bin"


# -- runs ---------------------------------------------------------------------------------------------------------------
@dataclasses.dataclass
class Run:
    """A run whose error is known. `value` reads numbers from its results; the truth is their distance from `reference` over the size of that: numbers,
    settings of a finer run, or nothing if the values are errors. `part`: part of the budget that the truth is about; `all` stands for all but the model's."""
    name: str
    case: str
    sets: list
    value: object
    reference: object
    part: str = "all"

    def programs(self):
        return re.findall(r"program: (\w+)", (ROOT / "configs" / self.case).read_text()) + (["coupler"] if "coupling:" in (ROOT / "configs" / self.case).read_text() else [])


def launch(binaries, case, sets, folder, without=""):
    command = [sys.executable, "-m", "couplet", "run", "-q", "--bin", str(binaries), "--set", f"simulation.output.folder={folder}"]
    for one in sets:
        command += ["--set", one]
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "client/python"), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "COUPLET_WITHOUT": without}
    done = subprocess.run([*command, str(ROOT / "configs" / case)], env=environment, capture_output=True, text=True, timeout=300, check=False)
    if done.returncode not in (0, 3, 4):
        raise RuntimeError(f"{case} {sets}: exit code {done.returncode}: {(done.stdout + done.stderr)[-800:]}")
    return {r.parent.name: json.loads(r.read_text()) for r in pathlib.Path(folder).glob("*/run.json")}


def rows_of(file):
    with open(file, newline="") as rows:
        return [row for row in csv.reader(rows) if row and not row[0].startswith("#")]


def probe(*columns, participant="solid", history=False):
    """Numbers of the columns of probes.csv that begin so: of the last row, or of all rows by their time."""
    def value(folder):
        head, *rows = rows_of(pathlib.Path(folder) / participant / "probes.csv")
        at = [i for i, name in enumerate(head) if name.startswith(columns)]
        return [float(row[i]) for row in rows[-1:] for i in at] if not history else {f"{float(row[0]):.9g}": [float(row[i]) for i in at] for row in rows}
    return value


def drag(folder):
    head, *rows = rows_of(pathlib.Path(folder) / "fluid/forces.csv")
    return [500 * sum(float(v) for name, v in zip(head, rows[-1]) if name.startswith(("cylinder pressure x", "cylinder viscous x")))]


def profile(n):
    """The filler's temperature, as the means of n parts of the height, less its mean."""
    def value(folder):
        rows = [[float(v) for v in row] for row in rows_of(pathlib.Path(folder) / "tank/bed.csv")[1:]]
        t = [row[3] for row in rows if row[0] == rows[-1][0]]
        k = len(t) // n
        means = [sum(t[k * i:k * i + k]) / k for i in range(n)]
        return [m - sum(means) / n for m in means]
    return value


def efficiency(folder):
    return [float(row[2]) for row in rows_of(pathlib.Path(folder) / "tank/summary.csv") if row[0] == "eta_th"]


def distance(value, right):
    """Relative distance: root mean square, over the times that both have the largest over the largest size."""
    norm = lambda numbers: math.sqrt(sum(v * v for v in numbers) / len(numbers))
    if isinstance(value, dict):
        common = [t for t in value if t in right]
        return max(norm([a - b for a, b in zip(value[t], right[t])]) for t in common) / max(norm(right[t]) for t in common)
    if not right:
        return norm(value)
    return norm([a - b for a, b in zip(value, right)]) / norm(right)


S, F, T, P = "participants.solid.", "participants.fluid.", "participants.tank.", "participants.plate."


def mesh(text, who=S):
    return f"{who}mesh-parameters={{{text}}}"


def bodies():
    """Static solids: the displacement at a point, from closed forms, published values or a fine mesh."""
    for shape in (0, 1):
        for n in (4, 8, 16):
            yield Run(f"Cook, {n} cells, shape {shape}", "cook/case.yaml", [mesh(f"n: {n}, shape: {shape}")], probe("corner y"), [0.0323007])
        for r in (4, 8):
            yield Run(f"ring, {r} cells, shape {shape}", "lame-cylinder/case.yaml", [mesh(f"nr: {r}, nt: {3 * r // 2}, shape: {shape}")], probe("inside x"), [0.111956])
            yield Run(f"orthotropic bar, {r} cells, shape {shape}", "off-axis-bar/case.yaml", [mesh(f"n: {r}, shape: {shape}")], probe("tip y"), [mesh("n: 64, shape: 0")])
        tip = S + "probes={tip: {point: [10, 0.5, 0.5]}}"
        for n, nl in ((1, 10), (2, 20)):
            yield Run(f"beam, {n} x {nl} cells, shape {shape}", "slender-beam/case.yaml", [mesh(f"n: {n}, nl: {nl}, L: 10, shape: {shape}"), tip], probe("tip y"),
                      [mesh("n: 6, nl: 80, L: 10, shape: 0"), tip])
        yield Run(f"plate with a hole, 6 cells, shape {shape}", "elliptic-plate/case.yaml", [mesh(f"nr: 6, nt: 9, nz: 4, shape: {shape}")], probe("hole-top z"),
                  [mesh("nr: 24, nt: 36, nz: 18, shape: 0")])
    for r in (4, 8):
        yield Run(f"LE1, {r} cells", "le1/case.yaml", [mesh(f"nr: {r}, nt: {3 * r // 2}")], probe("D x"), [-1.02207e-4])
    for h in (0.01, 0.006):
        yield Run(f"bracket of tetrahedra, {h} m", "filleted-bracket/case.yaml", [mesh(f"h: {h}")], probe("tip y"), [mesh("h: 0.003")])
    yield Run("LE1, 8 cells, gradient thesis", "le1/case.yaml",
              [mesh("nr: 8, nt: 12"), S + "solution-method.face-gradient=thesis"], probe("D x"), [-1.02207e-4])


LARGE = [S + "material.law=saint-venant-kirchhoff", S + "boundaries.tip.value=[14418.3776*t, 14418.3776*t, 0]"]
COLUMN = [S + "analysis=static", S + "plane=strain", S + "output={}", S + "kinematics=finite-strain", S + "probes={tip: {point: [1, 0]}}",
          S + 'boundaries.tip={type: traction, value: ["-3.2 MPa", "100 Pa"]}']
PULLED = [mesh("n_length: 20, n_side: 2"), S + "material.poissons-ratio=0", S + "boundaries.tip={type: traction, value: [1.25e-3, 0, 0]}"]


def others():
    """Solids with large strain, heat and motion; a loose solver; a linear body that should have been a non-linear one."""
    for n in (2, 4):
        yield Run(f"bent beam, large strain, {n} cells", "bent-beam/case.yaml", [*LARGE, mesh(f"n: {n}, m: {10 * n}")],
                  lambda folder: [math.hypot(*probe("tip x", "tip y")(folder)) / 2], [0.431338])
        yield Run(f"column near its buckling load, {n} cells", "buckling-column/case.yaml", [*COLUMN, mesh(f"n: {n}, nl: {25 * n}")], probe("tip y"), [*COLUMN, mesh("n: 12, nl: 300")])
    cook = lambda n: [S + "kinematics=finite-strain", S + "boundaries.loaded.value=[0, 1.5e6]", mesh(f"n: {n}, shape: 0")]
    for n in (4, 8):
        yield Run(f"Cook, large strain, {n} cells", "cook/case.yaml", cook(n), probe("corner y"), cook(48))
    for n in (5, 10):
        yield Run(f"heated cylinder, {n} cells", "heated-cylinder/case.yaml", [mesh(f"nr: {n}")], probe("inside x"), [mesh("nr: 40")])
    for n in (1, 2):
        yield Run(f"LE11, {n}", "le11/case.yaml", [mesh(f"refine: {n}")], probe("A x"), [mesh("refine: 6")])
    for n, step, seconds in ((2, 0.1, 20), (4, 0.5, 20), (4, 2, 20), (2, 0.1, 80), (4, 0.1, 80)):
        end = [f"simulation.end-time={seconds} s", f"simulation.output.interval={seconds} s"]
        yield Run(f"vibrating beam, {n} cells, {seconds} s in steps of {step} s", "vibrating-cantilever/case.yaml",
                  [mesh(f"n_length: {10 * n}, n_side: {n}"), f"simulation.time-step={step} s", *end], probe("tip y", history=True),
                  [mesh("n_length: 60, n_side: 6"), "simulation.time-step=0.1 s", *end])
    for n in (2, 4):  # a sudden load: it swings on
        struck = [S + "boundaries.tip={type: traction, value: [0, -60, 0]}", "simulation.time-step=0.2 s", "simulation.end-time=80 s", "simulation.output.interval=80 s"]
        yield Run(f"struck beam, {n} cells, 80 s", "vibrating-cantilever/case.yaml", [mesh(f"n_length: {10 * n}, n_side: {n}"), *struck], probe("tip y", history=True),
                  [mesh("n_length: 60, n_side: 6"), *struck])
    swings = [S + "boundaries.tip={type: traction, value: [0, -60, 0]}", "simulation.time-step=0.5 s", "simulation.end-time=800 s", "simulation.output.interval=800 s",
              S + "time-scheme.type=trapezoidal"]
    for n in (2, 3):
        yield Run(f"beam that swings 40 times, {n} cells", "vibrating-cantilever/case.yaml", [mesh(f"n_length: {10 * n}, n_side: {n}"), *swings], probe("tip y", history=True),
                  [mesh("n_length: 50, n_side: 5"), *swings], "mesh")
    warm = lambda steps: [mesh("n_length: 40, n_side: 4"), "simulation.end-time=4e6 s", f"simulation.time-step={4e6 / steps} s", S + "analysis=static",
                          S + "material.conductivity=50 W/(m K)", S + "material.specific-heat=500 J/(kg K)", S + "material.expansion=1.2e-5",
                          S + "thermal-expansion={reference-temperature: 20 degC}", S + "boundaries.tip={type: free}",
                          S + "heat={analysis: transient, initial-temperature: 20 degC, boundaries: {root: {type: temperature, value: 20 degC}, "
                          "tip: {type: temperature, value: 95 degC}, sides: {type: adiabatic}}}"]
    for steps in (10, 40):
        yield Run(f"bar that is heated, {steps} steps", "cantilever/case.yaml", warm(steps), probe("tip x"), warm(320), "step")
    yield Run("pulled bar, loose solver", "cantilever/case.yaml", [*PULLED, S + "solution-method={type: segregated, relative-tolerance: 1e-3}"], probe("tip x"), PULLED, "linear")
    beam = [mesh("n_length: 40, n_side: 4"), S + "boundaries.tip={type: traction, value: [0, 8333, 0]}", "simulation.diagnostics=full"]
    yield Run("large deflection as linear", "cantilever/case.yaml", beam, probe("tip y"), [*beam, S + "kinematics=finite-strain"], "model")
    for case, sets, column, truth in (("le1", "nr: 8, nt: 12", "D stress-yy", 92.66e6), ("le1", "nr: 16, nt: 24", "D stress-yy", 92.66e6), ("le11", "refine: 2", "A stress-zz", -105.67e6),
                                      ("le11", "refine: 3", "A stress-zz", -105.67e6)):
        yield Run(f"stress of {case} {{{sets}}}", f"{case}/case.yaml", [mesh(sets)], probe(column), [truth], "stress")
    hole = S + "probes={hole: {point: [0, 0.5], fields: [stress]}}"
    for n in (6, 12):
        yield Run(f"stress at a hole, {n} cells", "kirsch-hole/case.yaml", [mesh(f"n: {n}, nr: {4 * n // 3}, growth: 10, shape: 1"), hole], probe("hole stress-xx"), [3e6], "stress")


PLACES = [(0.98175, 2.15984), (2.94524, 0.19635), (4.90874, 3.33794)]  # centers of cells of 16 in 2 pi


def flows():
    grid = F + "probes={%s}" % ", ".join(f"p{i}{j}: {{point: [{x}, {y}]}}" for i, x in enumerate((0.25, 0.5, 0.75)) for j, y in enumerate((0.25, 0.5, 0.75, 0.9)))
    for n, step in ((16, 0.1), (32, 0.1)):
        decay = math.exp(-2 * 0.05 * 2)
        right = [v for x, y in PLACES for v in (math.sin(x) * math.cos(y) * decay, -math.cos(x) * math.sin(y) * decay)]
        places = F + "probes={%s}" % ", ".join(f"p{i}: {{point: [{x}, {y}]}}" for i, (x, y) in enumerate(PLACES))
        if n == 16:
            yield Run(f"Taylor-Green, {n} cells", "taylor-green-2d/case.yaml", [mesh(f"n: {n}", F), f"simulation.time-step={step} s", places],
                      probe(*(f"p{i} {a}" for i in range(3) for a in ("x", "y", "velocity x", "velocity y")), participant="fluid"), right)
        yield Run(f"Taylor-Green, {n} cells, steps of {2 * step} s", "taylor-green-2d/case.yaml", [mesh(f"n: {n}", F), f"simulation.time-step={2 * step} s", places],
                  probe("p", participant="fluid"), [mesh(f"n: {n}", F), f"simulation.time-step={step / 8} s", places], "step")
    cavity = lambda n: [mesh(f"n: {n}", F), f"simulation.time-step={1.28 / n} s", grid]
    velocity = probe(*(f"p{i}{j} {a}" for i in range(3) for j in range(4) for a in ("x", "y", "velocity x", "velocity y")), participant="fluid")
    for n in (8, 16):
        yield Run(f"cavity, {n} cells", "cavity/case.yaml", cavity(n), velocity, cavity(64))
    loose = F + "pressure-tolerance={}"
    points = F + "probes={a: {point: [0.3, 0.2, 0.3]}, b: {point: [0.5, 0.25, 0.5]}, c: {point: [0.2, 0.3, 0.8]}}"
    for name, case, sets in (("cavity, 64 cells", "cavity", [grid]), ("cavity, 16^3 cells", "cavity-3d", [mesh("n: 16", F), "simulation.time-step=0.05 s", points]),
                             ("cylinder", "cylinder", [mesh("n: 16", F), "simulation.time-step=0.01 s", points.replace("0.3]", "0]").replace("0.5]", "0]").replace("0.8]", "0]")])):
        sets = [*sets, "simulation.end-time=1 s", "simulation.output.interval=1 s"]
        yield Run(f"{name}, pressure to 1e-2", f"{case}/case.yaml", [*sets, loose.format(1e-2)], velocity if case == "cavity" else probe("a", "b", "c", participant="fluid"),
                  [*sets, loose.format(1e-9)], "linear")
    channel = [F + 'boundaries.inlet.velocity=["1.2*y*(0.41-y)/0.41^2", 0]', "simulation.end-time=8 s", "simulation.output.interval=8 s"]
    for n in (8, 12):
        yield Run(f"cylinder 2D-1, {n} cells", "cylinder/case.yaml", [*channel, mesh(f"n: {n}", F), f"simulation.time-step={0.8 / n} s"], drag, [5.57953523384])
    for alpha, steps in ((3, 40), (10, 40), (1, 5)):
        def pulse(n, alpha=alpha):
            nu = 0.5 * math.pi / alpha ** 2
            return [F + "boundaries={inlet: {type: periodic, partner: outlet}, outlet: {type: periodic, partner: inlet}, walls: {type: no-slip}}", mesh("n: 16", F),
                    F + f"viscosity={nu} Pa s", F + 'body-force=["0.2 + cos(2*pi*t)", 0]', F + "probes={a: {point: [2, 0.03]}, b: {point: [2, 0.2]}, c: {point: [2, 0.5]}}",
                    F + "output={}", "simulation.end-time=8 s", "simulation.output.interval=8 s", f"simulation.time-step={1 / n} s"]
        # The step's error of a flow that repeats is that of its last period.
        late = lambda folder: {t: v for t, v in probe("a", "b", "c", participant="fluid", history=True)(folder).items() if float(t) > 7}
        yield Run(f"Womersley {alpha}, {steps} steps a period", "pulsing-channel/case.yaml", pulse(steps), late, pulse(8 * steps), "step")


def plates():
    for n in (8, 16):
        yield Run(f"clamped plate, {n} cells", "plate-square/case.yaml", [mesh(f"n: {n}", P)], probe("middle z", participant="plate"), [mesh("n: 64", P)])
    struck = [P + "analysis=dynamic", "simulation.end-time=0.02 s", P + "load={lower-pressure: 1000}"]
    for step in (5e-4, 2e-3):
        yield Run(f"struck plate, steps of {step} s", "plate-square/case.yaml", [*struck, f"simulation.time-step={step} s"], probe("middle z", participant="plate", history=True),
                  [*struck, "simulation.time-step=6.25e-05 s"], "step")
    yield Run("struck plate, one mode", "plate-square/case.yaml", [*struck, "simulation.time-step=1e-4 s", P + "modes.number=1", P + 'load={lower-pressure: "1000*(x < 0.3)"}'],
              probe("middle z", participant="plate", history=True), [*struck, "simulation.time-step=1e-4 s", P + "modes.number=40", P + 'load={lower-pressure: "1000*(x < 0.3)"}'], "model")


def tanks():
    bed = lambda n, scheme, end, *more: [T + f"bed.cells={n}", T + f"bed.advection={scheme}", f"simulation.end-time={end} s", f"simulation.time-step={end} s", *more]
    for n, scheme, end in ((100, "upwind", 4050), (200, "upwind", 4050), (200, "upwind", 200), (100, "tvd", 4050)):
        yield Run(f"Schumann's bed, {scheme}, {n} cells, {end} s", "schumann/case.yaml", bed(n, scheme, end), profile(n), bed(3200, "tvd", end))
    yield Run("Schumann's bed, implicit, steps of 60 s", "schumann/case.yaml", bed(800, "implicit", 4050, T + "exchange-step=60 s"), profile(200), bed(3200, "tvd", 4050))
    days = ["simulation.end-time=5 day", "simulation.output.interval=5 day", T + "report.run-in=1 day", T + "bed.courant=0.5"]
    for n, scheme in ((100, "upwind"), (200, "upwind"), (100, "tvd")):
        yield Run(f"tank with a plant, {scheme}, {n} cells", "thermocline-andasol/case.yaml", [*days, T + f"bed.cells={n}", T + f"bed.advection={scheme}"], profile(50),
                  [*days, T + "bed.cells=800", T + "bed.advection=tvd"])
    rock = lambda n, step: [T + f"bed.cells={n}", f"simulation.time-step={step} s", "simulation.output.interval=5 day"]
    for n in (50, 100, 200):
        yield Run(f"rock bed with a plant, {n} cells: its efficiency", "thermocline-rock-air/case.yaml", rock(n, 10), efficiency, rock(1200, 2.5))


def coupled():
    def flap(n, step, end, tolerance, *more):
        sizes = "n_side: %d, n_tip: %d, growth: 1.35, wall_growth: 1.35, wall_cells: 5" % (n, n // 10)
        return [mesh(sizes, F), mesh(sizes, "participants.mover."), mesh(f"n_side: {2 * n}, n_tip: {n // 5}"), f"simulation.time-step={step} s", f"simulation.end-time={end} s",
                f"simulation.output.interval={end} s", f"coupling.convergence.relative={tolerance}", *more]
    loose = ("coupling.predictor.order=0", "coupling.acceleration={type: constant, initial-relaxation: 0.1}")
    for step in (0.04, 0.08):
        yield Run(f"flap, steps of {step} s", "perpendicular-flap/case.yaml", flap(10, step, 0.4, 1e-5), probe("tip x", history=True), flap(10, 0.005, 0.4, 1e-5), "step")
    for tolerance, words in ((0.9, loose), (1e-2, ())):
        yield Run(f"flap, coupled to {tolerance}", "perpendicular-flap/case.yaml", flap(10, 0.02, 0.2, tolerance, *words), probe("tip x", history=True), flap(10, 0.02, 0.2, 1e-7), "coupling")
    yield Run("flap, coarse mesh", "perpendicular-flap/case.yaml", flap(10, 0.02, 0.2, 1e-5), probe("tip x", history=True), flap(20, 0.02, 0.2, 1e-5), "mesh")


def all_runs():
    return [run for some in (bodies, others, flows, plates, tanks, coupled) for run in some()]


def estimated(reports, part):
    """The largest of each part over the participants, as the job adds them up; of a stress its own."""
    if part == "stress":
        return next((f["number"] for r in reports.values() for f in r["findings"] if f["id"] == "stress-error" and "probe" in f["sentence"]), None)
    largest = lambda name: max((r["errors"][name] for r in reports.values() if r["errors"].get(name) is not None), default=None)
    found = [largest(name) for name in (("mesh", "step", "linear", "coupling") if part == "all" else (part,))]
    known = [v for v in found if v is not None]
    return sum(known) if known else None


def spent(reports):
    """Seconds of the run without waiting for others, of all diagnostics and of each, all by the same clock, so that other processes change no ratio."""
    phases = {}
    for report in reports.values():
        for name, seconds in report["phases"].items():
            phases[name] = phases.get(name, 0) + seconds
    return {"run": sum(r["wall"] for r in reports.values()) - phases.get("waiting for the coupler", 0), "diagnostics": phases.get("diagnostics", 0),
            **{name: s for name, s in phases.items() if name.startswith("diagnostic: ")}}


def measure(args):
    results = args.build / "ablation.json"
    found = json.loads(results.read_text()) if results.is_file() else {}
    with tempfile.TemporaryDirectory(prefix="couplet-ablation-") as name:
        scratch = pathlib.Path(name)
        binaries = args.binaries or link(args.build.resolve(), scratch)
        for number, run in enumerate(all_runs()):
            if run.name in found or args.only not in run.name:
                continue
            folder, right = scratch / str(number), run.reference
            reports = launch(binaries, run.case, run.sets, folder / "all")
            if any(isinstance(r, str) for r in right):
                fine = scratch / ("fine-" + hashlib.sha256(repr((run.case, right)).encode()).hexdigest()[:12])
                if not fine.exists():
                    launch(binaries, run.case, right, fine)
                right = run.value(fine)
            one = {"programs": sorted(set(run.programs())), "part": run.part, "truth": distance(run.value(folder / "all"), right), "with": estimated(reports, run.part),
                   "time": spent(reports), "without": {}}
            for program in one["programs"]:
                for switch in SWITCHES.get(program, {}):
                    if ("(stress)" in switch) != (run.part == "stress") and "(stress)" in switch:
                        continue
                    reports = launch(binaries, run.case, run.sets, folder / "without", f"{program}: {switch}")
                    one["without"][f"{program}: {switch}"] = [estimated(reports, run.part), spent(reports)["diagnostics"]]
            found[run.name] = one
            ratio = (one["with"] or math.nan) / one["truth"] if one["truth"] else math.nan
            print(f"{run.name}: {one['with']} for {one['truth']:.3g} ({ratio:.2f})", flush=True)
            results.write_text(json.dumps(found, indent=0) + "\n")



# -- the page -----------------------------------------------------------------------------------------------------------
def is_near(estimate, truth, factor=2):
    return estimate is not None and truth / factor <= estimate <= factor * truth


def coverage(found, without=None):
    return sum(is_near(*(one["without"].get(without, [one["with"]])[:1]), one["truth"]) for one in found)


def least(found, without=None):
    """Smallest estimate over its truth; none if one is unknown."""
    ratios = [(one["without"][without][0] if without else one["with"]) for one in found]
    return "unknown" if None in ratios else f"{min(r / one['truth'] for r, one in zip(ratios, found)):.2g}"


def too_large(found, without=None):
    """Estimates of more than four times the truth."""
    return sum(((one["without"].get(without, [one["with"]])[0]) or 0) > 4 * one["truth"] for one in found)


def speaks(one, switch):
    other = one["without"][switch][0]
    return (other is None) != (one["with"] is None) or other is not None and abs(other - one["with"]) > 1e-3 * one["with"]


def estimators(found):
    every = list(found.values())
    lines = ["| estimator | runs that it could change, that it changes | runs within a factor of 2: with, without it | difference [points] | smallest ratio of estimate to true error "
             "in the changed runs: with, without it | runs above 4 times the true error: with, without it | share of the time | reason to keep it if below three points |", "|---|---|---|---|---|---|---|---|"]
    for program, switches in SWITCHES.items():
        for switch in switches:
            name = f"{program}: {switch}"
            mine = [one for one in every if name in one["without"]]
            changed = [one for one in mine if speaks(one, name)]
            if not mine:
                lines.append(f"| {name} | 0, 0 | - | - | - | - | - | - |")
                continue
            kept, left = coverage(every), coverage(every, name)
            saved = sum(one["time"]["diagnostics"] - one["without"][name][1] for one in mine) / sum(one["time"]["run"] for one in mine)
            lines.append(f"| {name} | {len(mine)}, {len(changed)} | {kept}, {left} | {100 * (left - kept) / len(every):+.1f} | "
                         f"{least(changed) + ', ' + least(changed, name) if changed else '-'} | {too_large(every)}, {too_large(every, name)} | {max(0, 100 * saved):.1f} % | {KEPT.get(name, '-')} |")
    return lines


def shares(found):
    """Returns the share of each diagnostic over all runs, and the run in which it is largest."""
    spent_on, whole, most = {}, {}, {}
    for run, one in found.items():
        for key, seconds in one["time"].items():
            if key in ("run", "diagnostics"):
                continue
            name = f"{one['programs'][-1] if len(one['programs']) == 1 else 'coupled'}: {key.removeprefix('diagnostic: ')}"
            spent_on[name] = spent_on.get(name, 0) + seconds
            whole[name] = whole.get(name, 0) + one["time"]["run"]
            most[name] = max(most.get(name, (0, "")), (seconds / one["time"]["run"], run))
    lines = ["| diagnostic | share of the time of its runs | largest share, and the run |", "|---|---|---|"]
    return lines + [f"| {n} | {100 * spent_on[n] / whole[n]:.1f} % | {100 * most[n][0]:.1f} %, {most[n][1]} |" for n in sorted(spent_on, key=lambda n: -spent_on[n] / whole[n])
                    if most[n][0] > 0.01]


def findings():
    """Lists the cases of tests/golden/golden.json in which each finding appears, by severity, and then the findings that never appear."""
    golden, spoken, silent = json.loads((ROOT / "tests/golden/golden.json").read_text()), [], []
    for program, rows in re.findall(r"^    // (\w+)\n((?:    (?!//).*\n)+)", (ROOT / "common/diagnostics/ids.cpp").read_text(), flags=re.M):
        for name in re.findall(r'FindingId\{\w+,\s*"([^"]+)"', rows):
            cases = {s: {case for case, one in golden.items() for p in one["participants"].values() for i, severity, _ in p["findings"] if (i, severity) == (name, s)}
                     for s in ("note", "warning", "wrong")}
            if any(cases.values()):
                spoken.append(f"| {name} | {program} | {len(cases['note'])} | {len(cases['warning'])} | {len(cases['wrong'])} |")
            else:
                silent.append(name)
    return len(golden), "\n".join(["| finding | declared in | cases with a note | cases with a warning | cases with `wrong` |", "|---|---|---|---|---|", *spoken]), ", ".join(silent)


def write(args):
    found = json.loads((args.build / "ablation.json").read_text())
    every = list(found.values())
    unknown = [name for name, one in found.items() if one["with"] is None]
    n_golden, spoken, silent = findings()
    version = text_of("git", "-C", ROOT, "rev-parse", "--short=8", "HEAD").strip()
    runs = ["| run | part | estimated error | true error | ratio |", "|---|---|---|---|---|"]
    runs += [f"| {name} | {one['part']} | {one['with'] if one['with'] is None else format(one['with'], '.3g')} | {one['truth']:.3g} | "
             f"{'-' if one['with'] is None else format(one['with'] / one['truth'], '.2f')} |" for name, one in found.items()]
    PAGE.write_text(f"""# Validation: ablation of the error estimators

**Measured on {datetime.date.today()}.** This page was written by `benchmarks/ablation.py` (programs of {version}) from {len(found)} runs of {len({p for one in every for p in one['programs']})} programs. Each run takes fractions of a second, and its true error is known
from closed forms, published values, or the same case with a fine mesh or step. The estimated error is the sum of the mesh, step, solver and coupling parts of a run, or the part named in
the last table. Each estimator was switched off in all runs of its program. {coverage(every)} of {len(every)} estimates are within a factor of 2 of the true error, and {sum(is_near(one['with'], one['truth'], 3) for one in every)} are within a factor of 3.

The true error is that of a displacement, drag or profile, whereas the estimate is a norm over the whole field. A constant factor between the two is therefore expected; the table shows what
an estimator adds. Special situations have two or three runs each, so fewer estimates are within a factor of 2 than in the [studies](studies/README.md), and few estimators change this share
by three points (three runs). Those that do not are the only ones of their part, as the last column says. {len(unknown)} runs have no estimate: {'; '.join(unknown)}. The times were measured
while other processes ran and are accurate to one or two percentage points.

## Estimators

{chr(10).join(estimators(found))}

## Time of the diagnostics

Runs this short spend much of their time on starting; the shares for ten usual cases are a row of [source-metrics](source-metrics.md). Diagnostics that take at most 1 % in every run are omitted.

{chr(10).join(shares(found))}

## Findings in the shipped cases

These are the findings in the first steps of the {n_golden} shipped cases, as recorded in tests/golden. The one that is `wrong` is the start of cavity-flexible-bottom. The findings of whole runs
are listed with their reasons in [findings](../findings.md#findings-of-the-shipped-cases).

{spoken}

The following findings appear in none of these cases: {silent}.

## Runs

{chr(10).join(runs)}
""")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("task", choices=["run", "write", "link"])
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    parser.add_argument("--binaries", type=pathlib.Path, help="programs that an earlier `link` made; for link: the folder to make them in")
    parser.add_argument("--only", default="")
    args = parser.parse_args()
    if args.task == "link":
        link(args.build.resolve(), args.binaries)
        args.binaries = args.binaries / "bin"
        measure(args)
    elif args.task == "run":
        measure(args)
    else:
        write(args)


if __name__ == "__main__":
    main()
