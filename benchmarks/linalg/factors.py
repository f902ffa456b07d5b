#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Factors beside multigrid for a body in motion: processor seconds of set-up and of a step, and after how many steps the factors
are the cheaper ones; solid_solver/method/solution_method.cpp estimates the same from the mesh. --write: factors.csv."""
import argparse
import pathlib
import resource
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
S = "participants.solid."
SOFT = "{density: 2600, youngs-modulus: 10 MPa, poissons-ratio: 0.3}"
TURNS = 3
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


def case_of(name):
    return ROOT / "configs" / name / "case.yaml"


def quadrilaterals(n, folder):
    (folder / "section.geo").write_text(SECTION)
    (folder / f"section-{n}.yaml").write_text(PLANE % n)
    return folder / f"section-{n}.yaml", (), 10 * n * n


def triangles(n):
    return case_of("undamped-strip"), (f"{S}mesh-parameters={{n: {n}}}", f"{S}material={SOFT}"), 2 * round(n * n / 0.15)


def hexahedra(length, side):
    return case_of("vibrating-cantilever"), (f"{S}mesh-parameters={{n_length: {length}, n_side: {side}}}",), length * side**2


def tetrahedra(side, length):
    return case_of("slender-beam"), (f"{S}mesh-parameters={{n: {side}, nl: {length}, L: {length / side}, shape: 1}}", f"{S}analysis=dynamic", f"{S}material={SOFT}",
                            f"{S}probes={{}}"), 6 * length * side**2


def seconds(build, case, sets, steps):
    with tempfile.TemporaryDirectory() as out:
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        subprocess.run([str(build / "bin" / "solid_solver"), str(case),
                        *(word for key in (f"simulation.output.folder={out}", "simulation.output.interval=0", "simulation.time-step=0.1", f"simulation.end-time={0.1 * steps!r}",
                                           f"{S}time-scheme.type=trapezoidal", *sets) for word in ("--set", key))], check=True, stdout=subprocess.DEVNULL)
        return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def measure(build, case, sets, steps):
    """Returns (seconds of the first step with all set-up, seconds of a later step)"""
    seconds(build, case, sets, 1)  # meshes
    first = min(seconds(build, case, sets, 1) for _ in range(TURNS))
    return first, (min(seconds(build, case, sets, 1 + steps) for _ in range(TURNS)) - first) / steps


def measure_all(build, bodies):
    for name, case, sets, cells in bodies:
        steps = max(20, min(400, 400000 // cells))
        (first, factors), (other, multigrid) = (measure(build, case, (*sets, f"{S}solution-method={{preconditioner: {p}}}"), steps) for p in ("factors", "multigrid"))
        pays = f"{(first - other) / (multigrid - factors):.0f}" if factors < multigrid else "never"
        line = f"{name},{cells},{first - other:.3f},{factors:.3g},{multigrid:.3g},{pays}"
        print(line, flush=True)
        yield line


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    parser.add_argument("--write", action="store_true")
    args = parser.parse_args()
    lines = ["body,cells,set_up_more,step_factors,step_multigrid,pays_after"]
    with tempfile.TemporaryDirectory() as folder:
        bodies = [*(("quadrilaterals", *quadrilaterals(n, pathlib.Path(folder))) for n in (4, 10, 16, 32, 48)), *(("triangles", *triangles(n)) for n in (6, 12, 24)),
                  *(("hexahedra", *hexahedra(*n)) for n in ((20, 2), (40, 4), (80, 4))), *(("tetrahedra", *tetrahedra(*n)) for n in ((2, 20), (2, 80), (4, 40)))]
        lines += measure_all(args.build, bodies)
    if args.write:
        (HERE / "factors.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    sys.exit(main())
