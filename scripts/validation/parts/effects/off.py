# SPDX-License-Identifier: Apache-2.0
"""An effect that is off executes none of its own code (callgrind); what one that is on costs is effects_cost.py's.
Small scenes, a square of N x N cells, so that every number repeats to the last digit on any machine that runs the same build."""
import dataclasses
import itertools
import re
import subprocess

from couplet.runs import environment
from validation.job import Bar

BASES = {  # program: (words of the participant, programs of the job)
    "fluid_solver": "density: 1, viscosity: 0.01, dimension: 2, mesh: square.msh, boundaries: {left: {type: inlet, velocity: [1, 0]}, "
                    "right: {type: outlet}, bottom: {type: no-slip}, top: {type: no-slip}}",
    "solid_solver": "dimension: 2, mesh: square.msh, analysis: dynamic, material: {density: 1000, youngs-modulus: 1 MPa, poissons-ratio: 0.3}, "
                    "solution-method: {type: newton-krylov}, "
                    "boundaries: {left: {type: fixed-displacement, value: [0, 0]}, right: {type: traction, value: [100, 0]}, "
                    "bottom: {type: free}, top: {type: free}}",
    "mesh_mover": "dimension: 2, mesh: square.msh, boundaries: {left: {type: moving, motion: {translation: ['0.01*t', 0]}}, "
                  "right: {type: fixed}, bottom: {type: free}, top: {type: free}}",
    "plate_modal": "mesh: square.msh, material: {density: 1000, youngs-modulus: 1 GPa, poissons-ratio: 0.3}, thickness: 1 cm, modes: {number: 3}, "
                   "initial-amplitudes: [1e-4], boundaries: {bottom: {type: clamped}, top: {type: free}, left: {type: free}, right: {type: free}}",
    "thermocline": "diameter: 10 m, fluid: {type: solar-salt}, bed: {cells: 200, initial-temperature: 290 degC, "
                   "layers: [{height: 5 m, porosity: 0.22, diameter: 5 mm}]}, "
                   "flow: {type: schedule, rows: [{at: 0 h, mass-flow: -20 kg/s, inlet-temperature: 390 degC}]}",
}
TIMES = {"fluid_solver": (0.004, 0.001), "solid_solver": (0.04, 0.01), "mesh_mover": (2, 0.5), "plate_modal": (0.004, 0.001),
         "thermocline": (14400, 900)}
SHELL = ("shell={material: {type: a387-grade-91}, plates: [{height: 5 m, thickness: 20 mm}]}",)
HEAT = ("material.conductivity=1", "material.specific-heat=1000", "heat={boundaries: {left: {type: temperature, value: 300 K}}}")
WARM = ("material.expansion=1e-5", "temperature=293.15+10*t", "thermal-expansion={}")


@dataclasses.dataclass
class Own:
    """An effect, the keys that switch it on, and the files whose code is its own."""
    program: str
    effect: str
    keys: tuple
    files: tuple
    needs: tuple = ()  # of the scene beside which it is off
    names: str = ""  # of those functions of the files that are its own; all by default


EFFECTS = [
    Own("fluid_solver", "turbulence model", ("turbulence={model: wale}",), ("fluid_solver/turbulence/turbulence.cpp",)),
    Own("fluid_solver", "immersed bodies", ("bodies={ball: {level: 'sqrt((x-0.5)^2+(y-0.5)^2)-0.2'}}",),
        ("fluid_solver/motion/immersed.cpp", "fluid_solver/pressure/projection_bodies.cpp")),
    Own("fluid_solver", "gaps that close", ("gaps={slot: {between: [bottom, top], opening: 1 mm}}",),
        ("fluid_solver/motion/gaps.cpp", "fluid_solver/pressure/projection_gaps.cpp")),
    Own("fluid_solver", "implicit viscous term", ("viscous=implicit",), ("fluid_solver/pressure/viscous_solver.cpp",), ("viscous=explicit",)),
    Own("fluid_solver", "running statistics", ("statistics={start: 0}",), ("fluid_solver/turbulence/statistics.cpp",)),
    Own("fluid_solver", "lines and planes", ("output={samples: {middle: {type: line, from: [0.1, 0.5], to: [0.9, 0.5]}}}",),
        ("fluid_solver/output/samples.cpp",)),
    Own("fluid_solver", "vorticity and Q", ("output={vorticity: true}",), ("fluid_solver/output/derived.cpp",), names="vorticity|q_criterion"),
    Own("fluid_solver", "velocity from a file", ("boundaries.left={type: inlet, table: {file: speed.csv}}",), ("common/fv/grid_table.cpp",)),
    Own("solid_solver", "geometric non-linearity", ("kinematics=finite-strain", "material.law=neo-hookean"),
        ("solid_solver/large_strain/finite_strain.cpp", "solid_solver/body/finite_fields.cpp", "solid_solver/method/tangent_solver.cpp")),
    Own("solid_solver", "orthotropic elasticity", ("material={density: 1000, orthotropic: {youngs-moduli: [1e6, 2e6, 1e6], "
                                                   "poissons-ratios: [0.3, 0.3, 0.3], shear-moduli: [4e5, 4e5, 4e5]}}",),
        ("solid_solver/material/orthotropic.cpp",)),
    Own("solid_solver", "conduction of heat", HEAT, ("solid_solver/thermal/heat.cpp", "solid_solver/thermal/heat_boundaries.cpp")),
    Own("solid_solver", "thermal strain", WARM, ("solid_solver/thermal/thermal_strain.cpp",)),
    Own("solid_solver", "energies", ("output={energies: true}",), ("solid_solver/output/output.cpp",), names="write_energies"),
    Own("solid_solver", "free vibrations", ("output={modes: 2}", "solution-method.face-gradient=symmetric"), ("solid_solver/output/modal_analysis.cpp",),
        ("solution-method.face-gradient=symmetric",)),
    Own("solid_solver", "step control", ("time-step-control={tolerance: 1 mm}",), ("solid_solver/motion/step_control.cpp",)),
    Own("mesh_mover", "elastic mesh motion", ("method=pseudo-solid",), ("mesh_mover/pseudo_solid.cpp",)),
    Own("mesh_mover", "rotations carried into the mesh", ("method=rotations",), ("mesh_mover/rotations.cpp",)),
    Own("mesh_mover", "mesh motion by a barrier", ("method=barrier",), ("mesh_mover/barrier/barrier_motion.cpp",)),
    Own("plate_modal", "contact with a seat", ("contact={height: -1 cm}",), ("plate_modal/motion/contact.cpp",)),
    Own("plate_modal", "pressures of the case", ("load={upper-pressure: 1}",), ("plate_modal/motion/pressure_load.cpp",)),
    Own("thermocline", "shell", SHELL, ("thermocline/wall/shell.cpp",)),
    Own("thermocline", "filler mechanics", (*SHELL, "filler-mechanics={}"), ("thermocline/wall/mechanics.cpp",), SHELL, "FillerMechanics"),
    Own("thermocline", "insulation", (*SHELL, "insulation={thickness: 0.3 m}"), ("thermocline/wall/insulation.cpp",), SHELL),
    Own("thermocline", "ground", ("ground={layers: [{material: soil, thickness: 5 m}]}",), ("thermocline/wall/column.cpp",)),
]


NUMBERS = itertools.count()


def square(n):
    """A square of n x n quadrilaterals in the format of gmsh 2.2."""
    nodes = [f"{1 + i + j * (n + 1)} {i / n:.17g} {j / n:.17g} 0" for j in range(n + 1) for i in range(n + 1)]
    at = lambda i, j: 1 + i + j * (n + 1)
    edges = [(e, a, b) for k in range(n) for e, a, b in ((1, at(0, k), at(0, k + 1)), (2, at(n, k), at(n, k + 1)),
                                                        (3, at(k, 0), at(k + 1, 0)), (4, at(k, n), at(k + 1, n)))]
    cells = [(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)) for j in range(n) for i in range(n)]
    lines = [f"{k + 1} 1 2 {e} {e} {a} {b}" for k, (e, a, b) in enumerate(edges)]
    lines += [f"{len(edges) + k + 1} 3 2 5 5 {' '.join(map(str, c))}" for k, c in enumerate(cells)]
    names = '1 1 "left"\n1 2 "right"\n1 3 "bottom"\n1 4 "top"\n2 5 "inside"'
    return ("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n" + names + f"\n$EndPhysicalNames\n$Nodes\n{len(nodes)}\n"
            + "\n".join(nodes) + f"\n$EndNodes\n$Elements\n{len(lines)}\n" + "\n".join(lines) + "\n$EndElements\n")


def watched(job, program, keys, tool, n=6, steps=4):
    """Folder of a run of the small scene under a tool of valgrind."""
    def make():
        folder = job.scratch / f"effects-{program}-{tool}-{next(NUMBERS)}"
        folder.mkdir()
        (folder / "square.msh").write_text(square(n))
        (folder / "speed.csv").write_text("y [m],u [m/s],v [m/s]\n0,1,0\n1,1,0\n")
        step = TIMES[program][1]
        (folder / "case.yaml").write_text(f"simulation: {{end-time: {steps * step}, time-step: {step}, output: {{folder: out}}}}\n"
                                          f"participants: {{it: {{program: {program}, {BASES[program]}}}}}\n")
        command = ["valgrind", f"--tool={tool}", f"--{tool}-out-file=watched", *OPTIONS[tool], job.build / "bin" / program, "case.yaml"]
        for key in keys:
            command += ["--set", f"participants.it.{key}"]
        result = subprocess.run([str(c) for c in command], cwd=folder, env=environment(), capture_output=True, text=True, timeout=600)
        if result.returncode != 0:
            raise RuntimeError(f"{program} {' '.join(keys)}: {(result.stdout + result.stderr)[-400:]}")
        return folder
    return job.once(("watched", program, keys, tool, n, steps), make)


OPTIONS = {"callgrind": ("--demangle=no", "--compress-strings=no", "--compress-pos=no"), "massif": ("--time-unit=i", "--max-snapshots=200", "--detailed-freq=1000000")}


def instructions(folder):
    """{function: instructions of its own}, by the names of the symbols."""
    found, function, skip = {}, "", False
    for line in (folder / "watched").read_text(errors="replace").splitlines():
        if line.startswith("fn="):
            function = line[3:]
        elif line.startswith("calls="):
            skip = True  # the next line is what was called, with all below it
        elif line[:1].isdigit():
            if not skip:
                found[function] = found.get(function, 0) + int(line.split()[1])
            skip = False
    return found


def symbols_of(job):
    """{file of the source: names that its object alone defines}."""
    def make():
        by_file, owners = {}, {}
        if any((job.build / "CMakeFiles").glob("*/Unity")):
            raise RuntimeError("the build compiles sources in batches; name one of single objects (preset single, --build build-single)")
        for file in sorted((job.build / "CMakeFiles").rglob("*.cpp.o")):
            source = re.sub(r".*\.dir/", "", str(file))[:-2]
            if not (job.root / source).exists():
                continue  # of an earlier state of the folder
            names = set()
            for line in job.run(["nm", "--defined-only", "--format=posix", file]).stdout.splitlines():
                name, kind = line.split()[:2]
                # what runs before main sets the constants of a file up, whether the effect is on or not
                if kind in "TtWw" and not name.startswith("_GLOBAL__sub_I"):
                    names.add(name)
                    owners.setdefault(name, set()).add(source)
            by_file[source] = names
        return {f: {n for n in names if len(owners[n]) == 1} for f, names in by_file.items()}
    return job.once("symbols", make)


def spent(job, own, keys):
    """Instructions in the effect's own files, and the name of the largest."""
    table, counts = symbols_of(job), instructions(watched(job, own.program, keys, "callgrind"))
    names = {n for f in own.files for n in table[f] if re.search(own.names, n)}
    inside = {n: c for n, c in counts.items() if n.split("'")[0] in names}
    return sum(inside.values()), max(inside, key=inside.get, default="")


def off_is_free(job):
    lost, least = [], None
    for own in EFFECTS:
        off, name = spent(job, own, own.needs)
        on, _ = spent(job, own, own.keys)
        least = on if least is None else min(on, least)
        print(f"  {own.program}, {own.effect}: off {off}, on {on}", flush=True)
        if off > 0 or on == 0:
            lost.append(f"{own.effect}: {off} off ({name[:60]}), {on} on")
    text = f"{len(EFFECTS) - len(lost)} of {len(EFFECTS)} execute nothing of theirs when off, and at least {least} instructions when on"
    return text + (f"; not: {'; '.join(lost)}" if lost else ""), not lost


BARS = [
    Bar("an effect that is off executes no instruction of its own files (callgrind)", "0, and more than 0 with it on", off_is_free, long=True,
        but="the release build, for any x86-64: the preset v3 compiles the same functions, but its whole build was too expensive for this row"),
]
