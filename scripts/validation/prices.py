# SPDX-License-Identifier: Apache-2.0
"""What an effect costs: heap and instructions of the shipped programs under massif, on small scenes in two and three dimensions (a unit square or cube of given
cells, a tank with a bed), each with the effect and without it, so that every number repeats on any machine that runs the same build. Two runs of each, one of
them longer: the difference is that of the steps alone. The heap is what the program holds while it steps (the median over its time), not the peak of its start.
`scripts/prices` writes them into the one list that programs and documents take them from."""
import concurrent.futures
import dataclasses
import itertools
import pathlib
import re
import subprocess

from couplet.runs import environment

LIST = "common/diagnostics/prices.cpp"
BASES = {  # program: words of the participant; a bar stands for a third component, 0
    "fluid_solver": "density: 1, viscosity: 0.01, boundaries: {left: {type: inlet, velocity: [1, 0|]}, "
                    "right: {type: outlet}, bottom: {type: no-slip}, top: {type: no-slip}SIDES}",
    "solid_solver": "analysis: dynamic, material: {density: 1000, youngs-modulus: 1 MPa, poissons-ratio: 0.3}, solution-method: {type: newton-krylov}, "
                    "boundaries: {left: {type: fixed-displacement, value: [0, 0|]}, right: {type: traction, value: [100, 0|]}, "
                    "bottom: {type: free}, top: {type: free}SIDES}",
    "mesh_mover": "boundaries: {left: {type: moving, motion: {translation: ['0.01*t', 0|]}}, right: {type: fixed}, bottom: {type: free}, top: {type: free}SIDES}",
    "plate_modal": "mesh: box.msh, material: {density: 1000, youngs-modulus: 1 GPa, poissons-ratio: 0.3}, thickness: 1 cm, modes: {number: 3}, "
                   "initial-amplitudes: [1e-4], boundaries: {bottom: {type: clamped}, top: {type: free}, left: {type: free}, right: {type: free}}",
    "thermocline": "diameter: 10 m, fluid: {type: solar-salt}, bed: {cells: CELLS, initial-temperature: 290 degC, "
                   "layers: [{height: 5 m, porosity: 0.22, diameter: 5 mm}]}, "
                   "flow: {type: schedule, rows: [{at: 0 h, mass-flow: -20 kg/s, inlet-temperature: 390 degC}]}",
}
SIDES = {"fluid_solver": "no-slip", "solid_solver": "free", "mesh_mover": "free"}  # front and back
STEP = {"fluid_solver": 0.001, "solid_solver": 0.01, "mesh_mover": 0.1, "plate_modal": 0.001, "thermocline": 900}  # [s]
SHELL = ("shell={material: {type: a387-grade-91}, plates: [{height: 5 m, thickness: 20 mm}]}",)
NUMBERS = itertools.count()


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


BOX = (Scene(2, 32), Scene(2, 16, True), Scene(3, 8), Scene(3, 5, True))
SCENES = {"fluid_solver": BOX, "solid_solver": BOX, "mesh_mover": BOX, "plate_modal": BOX[:2], "thermocline": (Scene(1, 100), Scene(1, 400))}
STEPS = {"fluid_solver": (10, 150), "solid_solver": (10, 60), "mesh_mover": (10, 150), "plate_modal": (50, 400), "thermocline": (100, 1000)}
FEW = {"geometric non-linearity": (4, 12)}  # its steps are long enough to be seen
LEAST_BYTES, LEAST_SHARE = 16, 0.03  # less is 0 in the list: two numbers a cell, a thirtieth of a step
NOT_BY_CELLS = ("ground",)  # a column of its own


@dataclasses.dataclass
class Own:
    """An effect, the keys that switch it on, and those of the scene beside which it is off."""
    program: str
    effect: str
    keys: tuple
    needs: tuple = ()


PRICED = [
    Own("fluid_solver", "turbulence model", ("turbulence={model: wale}",)),
    Own("fluid_solver", "immersed bodies", ("bodies={ball: {level: 'sqrt((x-0.5)^2+(y-0.5)^2)-0.2'}}",)),
    Own("fluid_solver", "gaps that close", ("gaps={slot: {between: [bottom, top], opening: 1 mm}}",)),
    Own("fluid_solver", "running statistics", ("statistics={start: 0}",)),
    Own("fluid_solver", "body force", ("body-force=['1', '0'|]",)),
    Own("fluid_solver", "energy budget", ("output={energy-budget: true}",)),
    Own("fluid_solver", "waves of pressure", ("compressibility={speed-of-sound: 100 m/s}",)),
    Own("fluid_solver", "rotating frame", ("rotating-frame={speed: 1 rad/s}",)),
    Own("fluid_solver", "moving frame", ("motion={translation: ['0.01*t', 0|]}",)),
    Own("solid_solver", "geometric non-linearity", ("kinematics=finite-strain", "material.law=neo-hookean")),
    Own("solid_solver", "orthotropic elasticity", ("material={density: 1000, orthotropic: {youngs-moduli: [1e6, 2e6, 1e6], "
                                                   "poissons-ratios: [0.3, 0.3, 0.3], shear-moduli: [4e5, 4e5, 4e5]}}",)),
    Own("solid_solver", "conduction of heat", ("material.conductivity=1", "material.specific-heat=1000", "heat={boundaries: {left: {type: temperature, value: 300 K}}}")),
    Own("solid_solver", "thermal strain", ("material.expansion=1e-5", "temperature=293.15+10*t", "thermal-expansion={}")),
    Own("solid_solver", "energies", ("output={energies: true}",)),
    Own("solid_solver", "near incompressibility", ("solution-method={type: newton-krylov, face-gradient: symmetric, volume-strain: cells}",)),
    Own("solid_solver", "gravity", ("gravity=['0', '-9.81'|]",)),
    Own("solid_solver", "body force", ("body-force=['1', '0'|]",)),
    Own("solid_solver", "structural damping", ("damping={stiffness: 1e-4}",)),
    Own("mesh_mover", "elastic mesh motion", ("method=pseudo-solid",)),
    Own("mesh_mover", "rotations carried into the mesh", ("method=rotations",)),
    Own("mesh_mover", "mesh motion by a barrier", ("method=barrier",)),
    Own("mesh_mover", "incremental mesh motion", ("form=incremental",)),
    Own("plate_modal", "contact with a seat", ("contact={height: -1 cm}",)),
    Own("plate_modal", "pressures of the case", ("load={upper-pressure: 1}",)),
    Own("plate_modal", "damping", ("damping={ratio: 0.01}",)),
    Own("thermocline", "shell", SHELL),
    Own("thermocline", "filler mechanics", (*SHELL, "filler-mechanics={}"), SHELL),
    Own("thermocline", "insulation", (*SHELL, "insulation={thickness: 0.3 m}"), SHELL),
    Own("thermocline", "ground", ("ground={layers: [{material: soil, thickness: 5 m}]}",)),
    Own("thermocline", "resolved grains", ("bed.shells=5",), ("bed.shells=1",)),
    Own("thermocline", "implicit advection", ("bed.advection=implicit",)),
    Own("thermocline", "ullage", (*SHELL, "ullage={height: 1 m}"), SHELL),
]


def words(text, scene):
    return text.replace("|", ", 0" if scene.dimension == 3 else "").replace("CELLS", str(scene.n))


def watched(job, program, keys, scene, steps):
    """Returns [(instructions, bytes on the heap)] of a run of a scene under massif."""
    folder = job.scratch / f"effects-{program}-{next(NUMBERS)}"
    folder.mkdir()
    base = BASES[program]
    if program in SIDES:
        sides = f", front: {{type: {SIDES[program]}}}, back: {{type: {SIDES[program]}}}" if scene.dimension == 3 else ""
        base = f"mesh: box.msh, dimension: {scene.dimension}, {base.replace('SIDES', sides)}"
    if scene.dimension > 1:
        numbers = [word for name in ("n", "dimension", "split") for word in ("-setnumber", name, int(getattr(scene, name)))]
        job.done(["gmsh", "-nopopup", "-v", "2", f"-{scene.dimension}", *numbers, pathlib.Path(__file__).with_name("box.geo"), "-o", folder / "box.msh"])
    (folder / "case.yaml").write_text(f"simulation: {{end-time: {steps * STEP[program]}, time-step: {STEP[program]}, output: {{folder: out}}}}\n"
                                      f"participants: {{it: {{program: {program}, {words(base, scene)}}}}}\n")
    command = ["valgrind", "--tool=massif", "--massif-out-file=watched", "--time-unit=i", "--max-snapshots=200", "--detailed-freq=1000000",
               job.build / "bin" / program, "case.yaml"]
    command += [word for key in keys for word in ("--set", f"participants.it.{words(key, scene)}")]
    result = subprocess.run([str(c) for c in command], cwd=folder, env=environment(), capture_output=True, text=True, timeout=900)
    if result.returncode not in (0, 4):  # 4: the answer is useless, which its cost is not
        raise RuntimeError(f"{program} {' '.join(keys)}: {(result.stdout + result.stderr)[-400:]}")
    return [(int(t), int(a) + int(b)) for t, a, b in re.findall(r"time=(\d+)\nmem_heap_B=(\d+)\nmem_heap_extra_B=(\d+)", (folder / "watched").read_text())]


def weigh(job, program, keys, steps, scene):
    """Returns (bytes on the heap while it steps, instructions of a step). What is between the ends of the short and the long run are steps, and at its end what ends a run:
    its first half is looked at."""
    def make():
        short, long = (watched(job, program, keys, scene, n) for n in steps)
        begin, end = short[-1][0], long[-1][0]
        held = sorted((bytes_, later - now) for (now, bytes_), (later, _) in zip(long, long[1:]) if begin <= now <= (begin + end) / 2)
        half, passed = sum(t for _, t in held) / 2, 0
        for bytes_, time in held:
            passed += time
            if passed >= half:
                return bytes_, (end - begin) / (steps[1] - steps[0])
        raise RuntimeError(f"{program}: no snapshot between the ends of the two runs")
    return job.once(("weight", program, keys, steps, scene), make)


@dataclasses.dataclass(frozen=True)
class Price:
    """Range of prices over the scenes of a dimension."""
    program: str
    effect: str
    dimension: int
    bytes: tuple
    step: tuple


def measured(job, own, scene):
    """Returns (bytes per cell, share of a step) by which the effect makes the scene costlier."""
    steps = FEW.get(own.effect) or STEPS[own.program]
    off, on = weigh(job, own.program, own.needs, steps, scene), weigh(job, own.program, own.keys, steps, scene)
    found = (on[0] - off[0]) / scene.cells, on[1] / off[1] - 1
    print(f"  {own.program}, {own.effect}, {scene.name}: {found[0]:.1f} B per cell, {100 * found[1]:+.1f} %", flush=True)
    return found


def rounded(value):
    """To two digits."""
    return float(f"{value:.2g}") if value else 0.0


def price(own, dimension, found):
    """Returns the price from [(bytes, share)]. Negligible prices are 0, and so are effects that cost less than what they replace."""
    clear = lambda value, least: rounded(value) if value >= least else 0.0
    bytes_ = [0.0 if own.effect in NOT_BY_CELLS else clear(b, LEAST_BYTES) for b, _ in found]
    step = [clear(s, LEAST_SHARE) for _, s in found]
    return Price(own.program, own.effect, dimension, (min(bytes_), max(bytes_)), (min(step), max(step)))


def measure(job, word=""):
    """All prices whose "program effect" holds the word; two runs side by side, what the effects of a program share is made once."""
    chosen = [own for own in PRICED if word in f"{own.program} {own.effect}"]
    needed = dict.fromkeys((own.program, keys, FEW.get(own.effect) or STEPS[own.program], scene)
                           for own in chosen for scene in SCENES[own.program] for keys in (own.needs, own.keys))
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda key: weigh(job, *key), needed))
    return [price(own, d, [measured(job, own, s) for s in SCENES[own.program] if s.dimension == d])
            for own in chosen for d in sorted({s.dimension for s in SCENES[own.program]})]


ROW = re.compile(r'\{"(\w+)",\s*"([^"]+)",\s*(\d),\s*\{([^}]*)\},\s*\{([^}]*)\}\}')


def read(root):
    ends = lambda text: tuple(float(x) for x in text.split(","))
    return [Price(m[1], m[2], int(m[3]), ends(m[4]), ends(m[5])) for m in ROW.finditer((root / LIST).read_text())]


def line(p):
    ends = lambda pair: "{" + ", ".join(f"{x:g}" for x in pair) + "}"
    return f'    {{"{p.program}", "{p.effect}", {p.dimension}, {ends(p.bytes)}, {ends(p.step)}}},\n'
