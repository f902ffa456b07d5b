# SPDX-License-Identifier: Apache-2.0
"""Every coupled case of the gallery, coarse and for a few steps: continued in its middle, and on other ranks."""
import dataclasses

import numpy as np

from couplet.runs.case import Case
from couplet.runs.job import surroundings
from couplet.runs.process import launch
from couplet.series import find_series

MONITORS = ("probes.csv", "forces.csv", "volume.csv", "watch.csv")
MIDDLE = 3  # steps before the checkpoint
INNER = 1e-10  # of the pressure equation: the solution of a linear system on other ranks differs by its tolerance
RANKS = {"fluid_solver": 2, "solid_solver": 2}  # of the second run
SPRING = "client/examples/spring_cylinder.py"


def meshes(text, *participants):
    return [f"participants.{name}.mesh-parameters={text}" for name in participants]


FLAP = [*meshes("{n_side: 20, n_tip: 2, growth: 1.35, wall_growth: 1.35, wall_cells: 5}", "fluid", "mover"), *meshes("{n_side: 40, n_tip: 4}", "solid")]
FLAG = [*meshes("{n: 6}", "fluid", "mover"), *meshes("{nx: 30, ny: 5}", "solid")]
TUBE = [*meshes("{n: 3, n_ring: 2, n_z: 30}", "fluid", "mover"), *meshes("{n: 3, n_wall: 2, n_z: 30}", "solid")]


@dataclasses.dataclass
class Entry:
    name: str
    file: str            # below configs/
    step: float          # [s]
    coarse: tuple = ()   # settings of the coarse variant
    sets: tuple = ()     # further settings
    steps: int = 5       # the checkpoint is after the third: by then all steps that a scheme looks back to are behind it
    words: dict = dataclasses.field(default_factory=dict)  # external participant: (file below the root, further arguments)


GALLERY = [
    Entry("FSI1", "turek-hron/fsi1.yaml", 0.02, FLAG),
    Entry("FSI3", "turek-hron/case.yaml", 0.002, FLAG),
    Entry("tube", "tube-3d/case.yaml", 1e-4, TUBE),
    Entry("flap, linear", "perpendicular-flap/case.yaml", 0.01, FLAP),
    Entry("flap, large deflection", "perpendicular-flap/case.yaml", 0.01, FLAP,
          ["participants.solid.kinematics=finite-strain", "participants.mover.method=barrier", "participants.fluid.boundaries.inlet.velocity=[20 m/s, 0 m/s]"]),
    Entry("flap in three dimensions", "perpendicular-flap/flap-3d.yaml", 0.01),
    Entry("closed box", "closed-cavity/case.yaml", 0.02, meshes("{n: 8}", "fluid", "lid", "mover")),
    Entry("nearly closed box", "closed-cavity/nearly-closed.yaml", 0.02, meshes("{n: 8}", "fluid", "lid", "mover")),
    Entry("Mok's cavity", "cavity-flexible-bottom/case.yaml", 0.1, meshes("{n: 16}", "fluid", "membrane", "mover")),
    Entry("balloon", "balloon/case.yaml", 0.01),
    Entry("two flaps", "two-flaps/case.yaml", 0.01),
    Entry("chain of three flaps", "two-flaps/three-flaps.yaml", 0.01),
    Entry("cylinder on a spring, at rest", "spring-cylinder/case.yaml", 0.05, words={"body": (SPRING, "2", "0", "4", "0.01")}),
    Entry("cylinder on a spring, in a stream", "spring-cylinder/vortices.yaml", 0.05, words={"body": (SPRING, "2", "0", "4.9348", "0.2")}),
]


def run(job, entry, kind, ranks=None, flags=(), coarse=True):
    """The folder of a run; its checkpoint in the middle is kept."""
    folder = job.scratch / f"{entry.name.replace(' ', '-').replace(',', '')}-{kind}"
    folder.mkdir(parents=True)
    case = Case(job.root / "configs" / entry.file, job.build)
    sets = [f"simulation.time-step={entry.step!r}", f"simulation.end-time={entry.steps * entry.step!r}", f"simulation.output.folder={folder}", "simulation.output.interval=0",
            f"simulation.checkpoint={{interval: {MIDDLE * entry.step!r}, keep: 100}}", *entry.sets, *(entry.coarse if coarse else ())]
    sets += [f"participants.{name}.pressure-tolerance={INNER:g}" for name, content in case.participants.items() if content["program"] == "fluid_solver" and coarse]
    guests = {name: ["/usr/bin/python3", job.root / file, name, *more] for name, (file, *more) in entry.words.items()}
    # While a flow starts its error may be as large as itself, which ends a run with code 4; what is compared here is not the answer.
    launch(case.command({}, ranks=ranks, raw=sets, flags=("--accept", "error-estimate", *flags), played_by=guests), folder / "run.log", folder=folder, timeout=1200, env=surroundings())
    return folder


def participants(folder):
    return sorted(f.parent for f in folder.glob("*/run.json") if f.parent.name != "coupler")


def late(file, after):
    """Rows of a monitor beyond a time, as text; body.csv has no heads."""
    rows = [line.split(",") for line in file.read_text().splitlines() if not line.startswith("#")]
    heads = [h.strip() for h in rows[0]]
    at = heads.index("time [s]") if "time [s]" in heads else 0
    return [r for r in rows[0 if file.name == "body.csv" else 1:] if float(r[at]) > after]


def fields(folder):
    """{name: values by the numbers of their cells or points} of a participant at the end; none of a participant without fields."""
    try:
        series = find_series(folder)
    except FileNotFoundError:
        return {}
    last, found = len(series.times) - 1, {}
    order = {False: np.argsort(series.file["mesh/cell-id"][...]), True: np.argsort(series.file["mesh/point-id"][...])}
    for name in series.names(last):
        found[name] = series.field(last, name)[order[series.is_at_points(last, name)]]
    return found


def monitors(folder):
    return [f for place in (*participants(folder), folder / "coupler") for f in map(place.joinpath, MONITORS) if f.exists()] + list(folder.glob("body.csv"))


def continued(job, entry):
    """(what differs between the whole run and the one continued in its middle, how much was compared)"""
    whole = job.once(("gallery", entry.name), lambda: run(job, entry, "whole"))
    again = run(job, entry, "continued", flags=("--restart", whole / "checkpoints" / f"step-{MIDDLE:08d}"))
    after = (MIDDLE + 0.5) * entry.step
    differs, count = [], 0
    for file in monitors(whole):
        rows = late(file, after)
        count += len(rows)
        if not rows or rows != late(again / file.relative_to(whole), after):
            differs.append(str(file.relative_to(whole)))
    for place in participants(whole):
        first, second = fields(place), fields(again / place.name)
        count += sum(v.size for v in first.values())
        differs += [f"{place.name}: {name}" for name in first if not np.array_equal(first[name], second.get(name))]
    return differs, count


def apart(job, entry):
    """Largest difference of a field or a probe between one and two ranks over its maximum, and whose."""
    whole = job.once(("gallery", entry.name), lambda: run(job, entry, "whole"))
    programs = {name: content["program"] for name, content in Case(job.root / "configs" / entry.file, job.build).participants.items()}
    other = run(job, entry, "ranks", {name: RANKS[program] for name, program in programs.items() if program in RANKS})
    found = {}
    for place in participants(whole):
        first, second = fields(place), fields(other / place.name)
        for name in {"pressure", "displacement", *(["velocity"] if "pressure" in first else [])} & set(first):
            found[f"{place.name}'s {name}"] = np.abs(first[name] - second[name]).max() / max(np.abs(first[name]).max(), 1e-300)
    for file in whole.glob("body.csv"):
        a, b = (np.loadtxt(f, delimiter=",")[:, 1] for f in (file, other / "body.csv"))
        found["the body's motion"] = np.abs(a - b).max() / np.abs(a).max()
    return max((gap, name) for name, gap in found.items())


def both(job, name):
    entry = next(e for e in GALLERY if e.name == name)
    tolerance = float(Case(job.root / "configs" / entry.file, job.build).data["coupling"]["convergence"]["relative"])
    differs, count = continued(job, entry)
    gap, whose = apart(job, entry)
    kept = f"continued: {count} numbers equal bit for bit" if not differs else f"continued: differs in {', '.join(differs[:4])}"
    return f"{kept}; on 2 ranks {gap:.1e} apart at most ({whose}), tolerance {tolerance:g}", not differs and count > 0 and gap <= tolerance
