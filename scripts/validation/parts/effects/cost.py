# SPDX-License-Identifier: Apache-2.0
"""What an effect costs beside what its card claims: heap and instructions of the shipped programs under massif, which repeat to the
last digit. Two runs with the effect and two without, one of them longer: the difference is that of the steps alone; the heap is what
the program holds while it steps (the median over the time between the ends of the two runs), not the peak of its start."""
import concurrent.futures
import dataclasses
import re

from validation.job import Bar
from validation.parts.effects.off import EFFECTS, Own, watched

CELLS = 32  # along a side of the square; the bed of a tank has 200
STEPS = {"fluid_solver": (20, 120), "solid_solver": (20, 120), "mesh_mover": (10, 60), "plate_modal": (50, 400), "thermocline": (20, 120)}
FEW = {"geometric non-linearity": (4, 12)}  # its steps are dear enough to be seen
OFF_ONLY = ("implicit viscous term", "step control", "vorticity and Q", "lines and planes", "velocity from a file", "free vibrations")
SYMMETRIC = ("solution-method={type: newton-krylov, face-gradient: symmetric}",)  # what an orthotropic body takes
MORE = [
    Own("fluid_solver", "body force", ("body-force=['1', '0']",), ()),
    Own("fluid_solver", "energy budget", ("output={energy-budget: true}",), ()),
    Own("solid_solver", "near incompressibility", ("solution-method={type: newton-krylov, face-gradient: symmetric, volume-strain: cells}",), (),
        ("solution-method={type: newton-krylov, face-gradient: symmetric, volume-strain: faces}",)),
    Own("solid_solver", "gravity", ("gravity=['0', '-9.81']",), ()),
    Own("solid_solver", "body force", ("body-force=['1', '0']",), ()),
    Own("solid_solver", "structural damping", ("damping={stiffness: 1e-4}",), ()),
    Own("plate_modal", "damping", ("damping={ratio: 0.01}",), ()),
    Own("thermocline", "resolved grains", ("bed.shells=5",), (), ("bed.shells=1",)),
]
PRICED = [dataclasses.replace(own, needs=SYMMETRIC) if own.effect == "orthotropic elasticity" else own
          for own in (*EFFECTS, *MORE) if own.effect not in OFF_ONLY]
LEAST_BYTES, LEAST_SHARE = 16, 0.03  # what a card need not name: two numbers a cell, a thirtieth of a step
NOT_BY_CELLS = ("geometric non-linearity", "ground")  # another solver in place of factors; a column of its own


@dataclasses.dataclass
class Weight:
    bytes: float  # on the heap while it steps
    step: float  # instructions


def snapshots(folder):
    text = (folder / "watched").read_text()
    return [(int(t), int(a) + int(b)) for t, a, b in re.findall(r"time=(\d+)\nmem_heap_B=(\d+)\nmem_heap_extra_B=(\d+)", text)]


def weigh(job, program, keys, steps):
    def make():
        short, long = (snapshots(watched(job, program, keys, "massif", CELLS, n)) for n in steps)
        begin, end = short[-1][0], long[-1][0]
        held = sorted((bytes_, later - now) for (now, bytes_), (later, _) in zip(long, long[1:]) if begin <= now <= end)
        half, passed = sum(t for _, t in held) / 2, 0
        for bytes_, time in held:
            passed += time
            if passed >= half:
                return Weight(bytes_, (end - begin) / (steps[1] - steps[0]))
        raise RuntimeError(f"{program}: no snapshot between the ends of the two runs")
    return job.once(("weight", program, keys, steps), make)


def claim(job, own):
    """(bytes per cell, share of a step) of the card, as --explain prints it with the effect on."""
    folder = watched(job, own.program, own.keys, "massif", CELLS, (FEW.get(own.effect) or STEPS[own.program])[0])
    command = [job.build / "bin" / own.program, "case.yaml", "--explain"]
    for key in own.keys:
        command += ["--set", f"participants.it.{key}"]
    line = re.search(rf"^  on +{re.escape(own.effect)}: (.*)$", job.run(command, cwd=folder).stdout, re.M)
    if not line:
        raise RuntimeError(f"{own.program} --explain does not list '{own.effect}' as on")
    number = lambda pattern: float(m[1]) if (m := re.search(pattern, line[1])) else 0.0
    return number(r"([\d.]+) B per cell"), number(r"([+-][\d.]+) % of a step") / 100


def compare(job, own):
    """(measured bytes per cell, measured share, claimed, claimed, memory right, time right)."""
    steps = FEW.get(own.effect) or STEPS[own.program]
    off, on = weigh(job, own.program, own.needs, steps), weigh(job, own.program, own.keys, steps)
    cells = 200 if own.program == "thermocline" else CELLS**2
    bytes_, share = (on.bytes - off.bytes) / cells, on.step / off.step - 1
    said_bytes, said_share = claim(job, own)
    holds = lambda said, got, part, least: abs(said - got) <= max(part * abs(got), least)
    result = (bytes_, share, said_bytes, said_share, holds(said_bytes, bytes_, 0.2, LEAST_BYTES), holds(said_share, share, 0.5, LEAST_SHARE))
    print(f"  {own.program}, {own.effect}: {bytes_:.1f} B per cell (card {said_bytes:g}), {100 * share:+.1f} % (card {100 * said_share:+g})", flush=True)
    return result


def compare_all(job):
    """{effect: comparison}; the programs side by side, what the effects of one share is made once."""
    with concurrent.futures.ThreadPoolExecutor(len(STEPS)) as pool:
        parts = pool.map(lambda program: {f"{own.program} {own.effect}": compare(job, own) for own in PRICED if own.program == program}, STEPS)
        return {name: result for part in parts for name, result in part.items()}


def claims(kind):
    def measure(job):
        found = job.once("costs", lambda: compare_all(job))
        right = 4 if kind == "memory" else 5
        if kind == "memory":
            found = {name: r for name, r in found.items() if not name.endswith(NOT_BY_CELLS)}
        wrong = [f"{name} {r[0]:.0f} for {r[2]:g} B" if kind == "memory" else f"{name} {100 * r[1]:+.0f} for {100 * r[3]:+g} %"
                 for name, r in found.items() if not r[right]]
        named = sum(bool(r[2 if kind == "memory" else 3]) for r in found.values())
        return (f"{len(found) - len(wrong)} of {len(found)} effects of five programs, {named} with a number of their own"
                + (f"; not: {'; '.join(wrong)}" if wrong else ""), not wrong)
    return measure


BUT = "two-dimensional, one rank, on the square of 32 x 32 cells (a bed of 200) of the row, {}"
BARS = [
    Bar("a card's claimed memory against the heap of the run (massif)", "within 20 %", claims("memory"), long=True,
        but=BUT.format("without a number below 16 B per cell, except what is not proportional to cells: large strain's other solver, the ground's column")),
    Bar("a card's claimed share of a step against the instructions of the run (massif)", "within 50 %", claims("time"), long=True,
        but=BUT.format("whose step is what the share is of, in instructions, and without a number below 3 %")),
]
