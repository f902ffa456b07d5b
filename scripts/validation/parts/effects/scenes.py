# SPDX-License-Identifier: Apache-2.0
"""Small scenes in which one effect after the other is switched on: a unit square or cube of given cells, a tank with a bed, run under a
tool of valgrind, so that every number repeats on any machine that runs the same build."""
import dataclasses
import itertools
import subprocess

from couplet.runs import environment

BASES = {  # program: words of the participant; a bar stands for a third component, 0
    "fluid_solver": "density: 1, viscosity: 0.01, mesh: box.msh, boundaries: {left: {type: inlet, velocity: [1, 0|]}, "
                    "right: {type: outlet}, bottom: {type: no-slip}, top: {type: no-slip}FACES}",
    "solid_solver": "mesh: box.msh, analysis: dynamic, material: {density: 1000, youngs-modulus: 1 MPa, poissons-ratio: 0.3}, "
                    "solution-method: {type: newton-krylov}, "
                    "boundaries: {left: {type: fixed-displacement, value: [0, 0|]}, right: {type: traction, value: [100, 0|]}, "
                    "bottom: {type: free}, top: {type: free}FACES}",
    "mesh_mover": "mesh: box.msh, boundaries: {left: {type: moving, motion: {translation: ['0.01*t', 0|]}}, "
                  "right: {type: fixed}, bottom: {type: free}, top: {type: free}FACES}",
    "plate_modal": "mesh: box.msh, material: {density: 1000, youngs-modulus: 1 GPa, poissons-ratio: 0.3}, thickness: 1 cm, modes: {number: 3}, "
                   "initial-amplitudes: [1e-4], boundaries: {bottom: {type: clamped}, top: {type: free}, left: {type: free}, right: {type: free}}",
    "thermocline": "diameter: 10 m, fluid: {type: solar-salt}, bed: {cells: CELLS, initial-temperature: 290 degC, "
                   "layers: [{height: 5 m, porosity: 0.22, diameter: 5 mm}]}, "
                   "flow: {type: schedule, rows: [{at: 0 h, mass-flow: -20 kg/s, inlet-temperature: 390 degC}]}",
}
FACES = {"fluid_solver": ", front: {type: no-slip}, back: {type: no-slip}", "solid_solver": ", front: {type: free}, back: {type: free}",
         "mesh_mover": ", front: {type: free}, back: {type: free}"}
STEP = {"fluid_solver": 0.001, "solid_solver": 0.01, "mesh_mover": 0.1, "plate_modal": 0.001, "thermocline": 900}  # [s]
SHELL = ("shell={material: {type: a387-grade-91}, plates: [{height: 5 m, thickness: 20 mm}]}",)
HEAT = ("material.conductivity=1", "material.specific-heat=1000", "heat={boundaries: {left: {type: temperature, value: 300 K}}}")
WARM = ("material.expansion=1e-5", "temperature=293.15+10*t", "thermal-expansion={}")


@dataclasses.dataclass
class Own:
    """An effect, the keys that switch it on, and the files whose code is its own."""
    program: str
    effect: str
    keys: tuple
    files: tuple = ()
    needs: tuple = ()  # of the scene beside which it is off
    names: str = ""  # of those functions of the files that are its own; all by default


EFFECTS = [
    Own("fluid_solver", "turbulence model", ("turbulence={model: wale}",), ("fluid_solver/momentum/turbulence.cpp",)),
    Own("fluid_solver", "immersed bodies", ("bodies={ball: {level: 'sqrt((x-0.5)^2+(y-0.5)^2)-0.2'}}",),
        ("fluid_solver/motion/immersed.cpp",)),
    Own("fluid_solver", "gaps that close", ("gaps={slot: {between: [bottom, top], opening: 1 mm}}",),
        ("fluid_solver/motion/gaps.cpp",)),
    Own("fluid_solver", "implicit viscous term", ("viscous=implicit",), ("fluid_solver/momentum/viscous_solver.cpp",), ("viscous=explicit",)),
    Own("fluid_solver", "running statistics", ("statistics={start: 0}",), ("fluid_solver/output/statistics.cpp",)),
    Own("fluid_solver", "lines and planes", ("output={samples: {middle: {type: line, from: [0.1, 0.5], to: [0.9, 0.5]}}}",),
        ("fluid_solver/output/samples.cpp",)),
    Own("fluid_solver", "vorticity and Q", ("output={vorticity: true}",), ("fluid_solver/output/derived.cpp",), names="vorticity|q_criterion"),
    Own("fluid_solver", "velocity from a file", ("boundaries.left={type: inlet, table: {file: speed.csv}}",), ("common/fv/grid_table.cpp",)),
    Own("solid_solver", "geometric non-linearity", ("kinematics=finite-strain", "material.law=neo-hookean"),
        ("solid_solver/equilibrium/finite_strain.cpp", "solid_solver/equilibrium/large_strain.cpp", "solid_solver/equilibrium/tangent_solver.cpp")),
    Own("solid_solver", "orthotropic elasticity", ("material={density: 1000, orthotropic: {youngs-moduli: [1e6, 2e6, 1e6], "
                                                   "poissons-ratios: [0.3, 0.3, 0.3], shear-moduli: [4e5, 4e5, 4e5]}}",),
        ("solid_solver/parameters/material_parameters.cpp",)),
    Own("solid_solver", "conduction of heat", HEAT, ("solid_solver/thermal/heat.cpp", "solid_solver/thermal/heat_boundaries.cpp")),
    Own("solid_solver", "thermal strain", WARM, ("solid_solver/thermal/thermal_strain.cpp",)),
    Own("solid_solver", "energies", ("output={energies: true}",), ("solid_solver/output/output.cpp",), names="write_energies"),
    Own("solid_solver", "free vibrations", ("output={modes: 2}", "solution-method.face-gradient=symmetric"), ("solid_solver/output/modal_analysis.cpp",),
        ("solution-method.face-gradient=symmetric",)),
    Own("solid_solver", "step control", ("time-step-control={tolerance: 1 mm}",), ("solid_solver/motion/solid_stepper.cpp",), names="judge_step"),
    Own("mesh_mover", "elastic mesh motion", ("method=pseudo-solid",), ("mesh_mover/pseudo_solid.cpp",)),
    Own("mesh_mover", "rotations carried into the mesh", ("method=rotations",), ("mesh_mover/rotations.cpp",)),
    Own("mesh_mover", "mesh motion by a barrier", ("method=barrier",), ("mesh_mover/barrier_motion.cpp",)),
    Own("plate_modal", "contact with a seat", ("contact={height: -1 cm}",), ("plate_modal/motion/contact.cpp",)),
    Own("plate_modal", "pressures of the case", ("load={upper-pressure: 1}",), ("plate_modal/motion/pressure_load.cpp",)),
    Own("thermocline", "shell", SHELL, ("thermocline/wall/shell.cpp",), names="Shell::"),
    Own("thermocline", "filler mechanics", (*SHELL, "filler-mechanics={}"), ("thermocline/wall/mechanics.cpp",), SHELL, "FillerMechanics"),
    Own("thermocline", "insulation", (*SHELL, "insulation={thickness: 0.3 m}"), ("thermocline/wall/layers.cpp",), SHELL, "Insulation"),
    Own("thermocline", "ground", ("ground={layers: [{material: soil, thickness: 5 m}]}",), ("thermocline/wall/layers.cpp",), names="Column"),
]


@dataclasses.dataclass(frozen=True)
class Scene:
    dimension: int  # 1: a bed
    n: int          # cells along a side, of the bed
    split: bool = False  # squares into two triangles, cubes into six tetrahedra

    @property
    def cells(self):
        return self.n**self.dimension * ((1, 1, 2, 6)[self.dimension] if self.split else 1)

    @property
    def name(self):
        kind = {1: "a bed of {} cells", 2: "{0} x {0} squares", 3: "{0} x {0} x {0} cubes"}[self.dimension].format(self.n)
        return kind + (f", {'triangles' if self.dimension == 2 else 'tetrahedra'}" if self.split else "")


SQUARE = Scene(2, 6)
NUMBERS = itertools.count()
PATCHES = ("left", "right", "bottom", "top", "back", "front")


def corners(scene):
    """Cells and sides of the box as (type of gmsh, patch or None, points)."""
    n, flat = scene.n, scene.dimension == 2
    at = lambda i, j, k=0: 1 + i + (n + 1) * (j + (n + 1) * k)
    for i, j, k in itertools.product(range(n), range(n), range(1 if flat else n)):
        if flat:
            q = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1))
            yield from [(2, None, q[:3]), (2, None, (q[0], q[2], q[3]))] if scene.split else [(3, None, q)]
        elif scene.split:  # along the diagonal of the cube, the same in each: sides fit
            for order in itertools.permutations(range(3)):
                corner, points = [i, j, k], [at(i, j, k)]
                for axis in order:
                    corner[axis] += 1
                    points.append(at(*corner))
                odd = order in ((0, 2, 1), (1, 0, 2), (2, 1, 0))
                yield 4, None, (points[1], points[0], *points[2:]) if odd else tuple(points)
        else:
            yield 5, None, tuple(at(i + a, j + b, k + c) for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)))
    for side in range(2 * scene.dimension):
        axis, end = side // 2, n * (side % 2)
        free = [d for d in range(scene.dimension) if d != axis]
        for place in itertools.product(range(n), repeat=len(free)):
            def point(*step):
                corner = [0, 0, 0]
                corner[axis] = end
                for d, p, s in zip(free, place, step):
                    corner[d] = p + s
                return at(*corner)
            if flat:
                yield 1, side, (point(0), point(1))
            elif scene.split:
                yield 2, side, (point(0, 0), point(1, 0), point(1, 1))
                yield 2, side, (point(0, 0), point(1, 1), point(0, 1))
            else:
                yield 3, side, (point(0, 0), point(1, 0), point(1, 1), point(0, 1))


def box(scene):
    """The mesh in the format of gmsh 2.2."""
    n, dim = scene.n, scene.dimension
    nodes = [f"{1 + i + (n + 1) * (j + (n + 1) * k)} {i / n:.17g} {j / n:.17g} {k / n:.17g}"
             for k in range(1 if dim == 2 else n + 1) for j in range(n + 1) for i in range(n + 1)]
    inside = 2 * dim + 1
    lines = [f"{e + 1} {kind} 2 {side + 1 if side is not None else inside} {side + 1 if side is not None else inside} {' '.join(map(str, points))}"
             for e, (kind, side, points) in enumerate(corners(scene))]
    names = "\n".join(f'{dim - 1} {s + 1} "{PATCHES[s]}"' for s in range(2 * dim)) + f'\n{dim} {inside} "inside"'
    return (f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{inside}\n{names}\n$EndPhysicalNames\n$Nodes\n{len(nodes)}\n"
            + "\n".join(nodes) + f"\n$EndNodes\n$Elements\n{len(lines)}\n" + "\n".join(lines) + "\n$EndElements\n")


def words(text, scene):
    return text.replace("|", ", 0" if scene.dimension == 3 else "").replace("CELLS", str(scene.n))


def case(program, scene, steps):
    sized = f"dimension: {scene.dimension}, " if program in FACES else ""
    base = sized + BASES[program].replace("FACES", FACES[program] if scene.dimension == 3 else "") if program in FACES else BASES[program]
    return (f"simulation: {{end-time: {steps * STEP[program]}, time-step: {STEP[program]}, output: {{folder: out}}}}\n"
            f"participants: {{it: {{program: {program}, {words(base, scene)}}}}}\n")


def prepared(job, program, scene, steps):
    """A new folder with the small scene."""
    folder = job.scratch / f"effects-{program}-{next(NUMBERS)}"
    folder.mkdir()
    if scene.dimension > 1:
        (folder / "box.msh").write_text(job.once(("box", scene), lambda: box(scene)))
    (folder / "speed.csv").write_text("y [m],u [m/s],v [m/s]\n0,1,0\n1,1,0\n")
    (folder / "case.yaml").write_text(case(program, scene, steps))
    return folder


def run(job, program, keys, scene, folder, before):
    """The scene in `folder` with these keys; `before`: words of the command before the program."""
    command = [*before, job.build / "bin" / program, "case.yaml"]
    for key in keys:
        command += ["--set", f"participants.it.{words(key, scene)}"]
    result = subprocess.run([str(c) for c in command], cwd=folder, env=environment(), capture_output=True, text=True, timeout=900)
    if result.returncode not in (0, 4):  # 4: the answer is useless, which its cost is not
        raise RuntimeError(f"{program} {' '.join(keys)}: {(result.stdout + result.stderr)[-400:]}")


def watched(job, program, keys, tool, scene=SQUARE, steps=4):
    """Folder of a run of the small scene under a tool of valgrind."""
    def make():
        folder = prepared(job, program, scene, steps)
        run(job, program, keys, scene, folder, ("valgrind", f"--tool={tool}", f"--{tool}-out-file=watched", *OPTIONS[tool]))
        return folder
    return job.once(("watched", program, keys, tool, scene, steps), make)


OPTIONS = {"callgrind": ("--demangle=no", "--compress-strings=no", "--compress-pos=no"), "massif": ("--time-unit=i", "--max-snapshots=200", "--detailed-freq=1000000")}
