# SPDX-License-Identifier: Apache-2.0
"""What an effect costs: heap and instructions of the shipped programs under massif, on scenes in two and three dimensions, each with the
effect and without it. Two runs of each, one of them longer: the difference is that of the steps alone. The heap is what the program
holds while it steps (the median over its time), not the peak of its start. `scripts/prices` writes them into the one list that
programs and documents take them from; the bars measure it again."""
import concurrent.futures
import dataclasses
import re

from validation.parts.effects.scenes import EFFECTS, SHELL, Own, Scene, watched

LIST = "common/diagnostics/prices.cpp"
BOX = (Scene(2, 32), Scene(2, 16, True), Scene(3, 8), Scene(3, 5, True))
SCENES = {"fluid_solver": BOX, "solid_solver": BOX, "mesh_mover": BOX, "plate_modal": BOX[:2], "thermocline": (Scene(1, 100), Scene(1, 400))}
STEPS = {"fluid_solver": (10, 150), "solid_solver": (10, 60), "mesh_mover": (10, 150), "plate_modal": (50, 400), "thermocline": (100, 1000)}
FEW = {"geometric non-linearity": (4, 12)}  # its steps are long enough to be seen
OFF_ONLY = ("implicit viscous term", "step control", "vorticity and Q", "lines and planes", "velocity from a file", "free vibrations")
MORE = [
    Own("fluid_solver", "body force", ("body-force=['1', '0'|]",)),
    Own("fluid_solver", "energy budget", ("output={energy-budget: true}",)),
    Own("solid_solver", "near incompressibility", ("solution-method={type: newton-krylov, face-gradient: symmetric, volume-strain: cells}",)),
    Own("solid_solver", "gravity", ("gravity=['0', '-9.81'|]",)),
    Own("solid_solver", "body force", ("body-force=['1', '0'|]",)),
    Own("solid_solver", "structural damping", ("damping={stiffness: 1e-4}",)),
    Own("plate_modal", "damping", ("damping={ratio: 0.01}",)),
    Own("fluid_solver", "waves of pressure", ("compressibility={speed-of-sound: 100 m/s}",)),
    Own("fluid_solver", "rotating frame", ("rotating-frame={speed: 1 rad/s}",)),
    Own("fluid_solver", "moving frame", ("motion={translation: ['0.01*t', 0|]}",)),
    Own("mesh_mover", "incremental mesh motion", ("form=incremental",)),
    Own("thermocline", "resolved grains", ("bed.shells=5",), needs=("bed.shells=1",)),
    Own("thermocline", "implicit advection", ("bed.advection=implicit",)),
    Own("thermocline", "ullage", (*SHELL, "ullage={height: 1 m}"), needs=SHELL),
]
PRICED = [own for own in (*EFFECTS, *MORE) if own.effect not in OFF_ONLY]
LEAST_BYTES, LEAST_SHARE = 16, 0.03  # less is 0 in the list: two numbers a cell, a thirtieth of a step
NOT_BY_CELLS = ("ground",)  # a column of its own


@dataclasses.dataclass
class Weight:
    bytes: float  # on the heap while it steps
    step: float  # instructions


@dataclasses.dataclass(frozen=True)
class Price:
    """From the least to the most over the scenes of a dimension."""
    program: str
    effect: str
    dimension: int
    bytes: tuple
    step: tuple


def snapshots(folder):
    text = (folder / "watched").read_text()
    return [(int(t), int(a) + int(b)) for t, a, b in re.findall(r"time=(\d+)\nmem_heap_B=(\d+)\nmem_heap_extra_B=(\d+)", text)]


def weigh(job, program, keys, steps, scene):
    """What is between the ends of the short and the long run are steps, and at its end what ends a run: its first half is looked at."""
    def make():
        short, long = (snapshots(watched(job, program, keys, "massif", scene, n)) for n in steps)
        begin, end = short[-1][0], long[-1][0]
        held = sorted((bytes_, later - now) for (now, bytes_), (later, _) in zip(long, long[1:]) if begin <= now <= (begin + end) / 2)
        half, passed = sum(t for _, t in held) / 2, 0
        for bytes_, time in held:
            passed += time
            if passed >= half:
                return Weight(bytes_, (end - begin) / (steps[1] - steps[0]))
        raise RuntimeError(f"{program}: no snapshot between the ends of the two runs")
    return job.once(("weight", program, keys, steps, scene), make)


def measured(job, own, scene):
    """(bytes per cell, share of a step) by which the effect makes the scene costlier."""
    steps = FEW.get(own.effect) or STEPS[own.program]
    off, on = weigh(job, own.program, own.needs, steps, scene), weigh(job, own.program, own.keys, steps, scene)
    found = (on.bytes - off.bytes) / scene.cells, on.step / off.step - 1
    print(f"  {own.program}, {own.effect}, {scene.name}: {found[0]:.1f} B per cell, {100 * found[1]:+.1f} %", flush=True)
    return found


def rounded(value):
    """To two digits."""
    return float(f"{value:.2g}") if value else 0.0


def price(own, dimension, found):
    """Of [(bytes, share)]. What is next to nothing is 0, and so is what costs less than what it takes the place of."""
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
