# SPDX-License-Identifier: Apache-2.0
"""Beside commit b350924, each by its default settings, in processor seconds of whole processes, turn by turn. Needs a checkout of that commit with its build
in it: COUPLET_OTHER_BUILD names the folder of that build."""
import os
import pathlib
import statistics

import couplet
from validation.job import Job

BEFORE, TURNS = "b350924", 3
S = "participants.solid."


def other(job):
    """That commit's programs on that commit's cases."""
    build = os.environ.get("COUPLET_OTHER_BUILD")
    if not build:
        raise LookupError(f"COUPLET_OTHER_BUILD names no build of {BEFORE}")
    return Job(pathlib.Path(build).parent, pathlib.Path(build), job.quick)


def once(job, whose, case, sets):
    """(processor seconds, output folder)"""
    out = job.scratch / "before"
    run = whose.case_run(whose.root / "configs" / case / "case.yaml", out, ("simulation.output.interval=0", *sets), {"solid": 1}, 3600)
    return run.cost.cpu, out


def seconds(job, whose, case, sets):
    once(job, whose, case, sets)  # meshes
    return statistics.median(once(job, whose, case, sets)[0] for _ in range(TURNS))


def to_a_percent(job, whose, case, column, right, meshes):
    """(seconds, mesh, error) of the coarsest mesh from which on all of those tried are within 1 %."""
    found = None
    for mesh in reversed(meshes):
        _, out = once(job, whose, case, (f"{S}mesh-parameters={{{mesh}}}",))
        error = couplet.read_csv(out / "solid" / "probes.csv")[column][-1] / right - 1
        if abs(error) > 0.01:
            break
        found = mesh, error
    if found is None:
        raise LookupError(f"none of {len(meshes)} meshes is within 1 %")
    return seconds(job, whose, case, (f"{S}mesh-parameters={{{found[0]}}}",)), *found


def sooner(job, case, column, right, meshes):
    (now, mesh, error), (then, before, earlier) = (to_a_percent(job, whose, case, column, right, meshes) for whose in (job, other(job)))
    return (f"{{{mesh}}} {100 * error:+.2f} % in {now:.2f} s, {BEFORE} {{{before}}} {100 * earlier:+.2f} % in {then:.2f} s: {now / then:.2f} times",
            now <= 0.7 * then)


def plate(job):
    """The plate B of 36 864 hexahedra, in pairs; its mesh is kept from a first run of each."""
    sets, both = (f"{S}mesh-parameters={{nr: 32, nt: 48, nz: 24}}",), (job, other(job))
    for whose in both:
        once(job, whose, "elliptic-plate", sets)
    turns = [[once(job, whose, "elliptic-plate", sets)[0] for whose in both] for _ in range(TURNS)]
    ratios = sorted(now / then for now, then in turns)
    return f"{', '.join(f'{r:.2f}' for r in ratios)} times; {turns[0][0]:.2f} for {turns[0][1]:.2f} s", ratios[TURNS // 2] <= 1


def pairs(now, then, count):
    """Processor seconds of so many steps after the first, over those of the other build; `now`, `then`: (steps) -> seconds."""
    now(1), then(1)  # meshes
    ratios = sorted((now(1 + count) - now(1)) / (then(1 + count) - then(1)) for _ in range(TURNS))
    return ", ".join(f"{r:.2f}" for r in ratios) + " times", ratios[TURNS // 2] <= 1.1


def motion(job, case, sets, step, count):
    """The default of the other build was the least-squares gradient."""
    def of(whose):
        return lambda steps: once(job, whose, case, (*sets, f"simulation.end-time={steps * step!r}"))[0]
    return pairs(of(job), of(other(job)), count)


def beam(n_length, n_side):
    return (f"{S}mesh-parameters={{n_length: {n_length}, n_side: {n_side}}}",)


# The old checkout has no strip of triangles: a section of the beam in the plane, given whole.
PLANE = """simulation: {name: plane, end-time: 1 s, time-step: 0.1 s, output: {folder: out}}
participants:
  solid:
    program: solid_solver
    mesh: section.geo
    mesh-parameters: {n: %d}
    dimension: 2
    plane: strain
    material: {density: 2600, youngs-modulus: 10 MPa, poissons-ratio: 0.3}
    time-scheme: {type: trapezoidal}
    boundaries:
      root: {type: fixed-displacement, value: [0, 0]}
      tip: {type: traction, value: [0, "t <= 7 ? -125*t/7 : 0"]}
      sides: {type: free}
"""
SECTION = """DefineConstant [ n = 8 ];
Point(1) = {0, 0, 0}; Point(2) = {20, 0, 0}; Point(3) = {20, 2, 0}; Point(4) = {0, 2, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve {1, 3} = 10 * n + 1; Transfinite Curve {2, 4} = n + 1;
Curve Loop(1) = {1:4}; Plane Surface(1) = {1}; Transfinite Surface {1}; Recombine Surface {1};
Physical Curve("root") = {4}; Physical Curve("tip") = {2}; Physical Curve("sides") = {1, 3}; Physical Surface("beam") = {1};
"""


def section(job, n, count):
    """A beam of 10 n x n quadrilaterals, the same file for both builds."""
    folder = job.scratch / f"section-{n}"
    folder.mkdir(exist_ok=True)
    (folder / "section.geo").write_text(SECTION)
    (folder / "case.yaml").write_text(PLANE % n)

    def of(whose):
        return lambda steps: whose.case_run(folder / "case.yaml", folder / "out", ("simulation.output.interval=0", f"simulation.end-time={0.1 * steps!r}"),
                                            {"solid": 1}, 3600).cost.cpu
    return pairs(of(job), of(other(job)), count)


def rings(sizes, text):
    return [text.format(r=r, t=3 * r // 2) for r in sizes]
