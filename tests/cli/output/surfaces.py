# SPDX-License-Identifier: Apache-2.0
"""`output.surfaces` and `output.fluxes` of whole runs: the same on 1, 2 and 3 ranks, bit for bit through a restart, read and drawn by the package, refused with
the names that there are. Usage: surfaces.py FOLDER_OF_PROGRAMS PYTHON_PACKAGE"""
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
sys.path.insert(0, sys.argv[2])
import couplet
import numpy as np
from checks import check, end
from couplet import fields
from couplet.runs.case import Wrong
from scenes import DUCT

PROGRAMS = pathlib.Path(sys.argv[1])
FLUID = """simulation: {name: duct, end-time: 0.4 s, time-step: 0.05 s, output: {folder: out, interval: 0.1 s}, checkpoint: {interval: 0.2 s}}
participants:
  fluid:
    program: fluid_solver
    mesh: mesh.geo
    mesh-parameters: {nx: 20, ny: 6}
    dimension: 2
    density: 1.2 kg/m^3
    viscosity: 0.01 Pa s
    pressure-tolerance: 1e-10
    boundaries:
      inlet: {type: inlet, velocity: ["1 + sin(9*t)", 0]}
      outlet: {type: outlet}
      walls: {type: no-slip}
    output: {surfaces: [walls, inlet], fluxes: true, coefficients: {duct: {patches: [walls], speed: 1 m/s, area: 0.2 m^2}}}
"""
BLOCK = """Point(1)={0,0,0}; Point(2)={2,0,0}; Point(3)={2,1,0}; Point(4)={0,1,0}; Line(1)={1,2}; Line(2)={2,3}; Line(3)={3,4}; Line(4)={4,1};
Transfinite Curve{1,3}=7; Transfinite Curve{2,4}=4; Curve Loop(1)={1,2,3,4}; Plane Surface(1)={1}; Transfinite Surface{1}; Recombine Surface{1};
Extrude{0,0,1}{Surface{1}; Layers{3}; Recombine;}
Physical Surface("root")={25}; Physical Surface("tip")={17}; Physical Surface("sides")={1,13,21,26}; Physical Volume("block")={1};
"""
SOLID = """simulation: {name: block, end-time: 0.04 s, time-step: 0.005 s, output: {folder: out, interval: 0.01 s}, checkpoint: {interval: 0.02 s}}
participants:
  solid:
    program: solid_solver
    mesh: mesh.geo
    dimension: 3
    analysis: dynamic
    material: {density: 1000 kg/m^3, youngs-modulus: 1 MPa, poissons-ratio: 0.3}
    solution-method: {relative-tolerance: 1e-12}
    boundaries:
      root: {type: fixed-displacement, value: [0, 0, 0]}
      tip: {type: traction, value: [0, "500*sin(60*t)", 100]}
      sides: {type: free}
    output: {surfaces: [all], moments: true}
"""


def start(folder, program, ranks=1, sets=(), more=()):
    words = ["mpirun", "--oversubscribe", "-n", str(ranks)] if ranks > 1 else []
    words += [str(PROGRAMS / program), "case.yaml", *(f"--set={s}" for s in sets), *more]
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=120)


def by_number(surface, name):
    """A field in the order of the mesh file."""
    i = len(surface.times) - 1
    order = surface.file["mesh/point-id" if surface.is_at_points(i, name) else "mesh/cell-id"][...]
    return np.asarray(surface.field(i, name))[np.argsort(order)]


def apart(one, other):
    return float(np.abs(one - other).max() / max(np.abs(one).max(), 1e-300))


def same_on_ranks(folder, program, part, table):
    one = couplet.Results(folder / "out-1")
    for ranks in (2, 3):
        many = couplet.Results(folder / f"out-{ranks}")
        for patch in one.surfaces(part):
            a, b = one.surface(part, patch), many.surface(part, patch)
            worst = {n: apart(by_number(a, n), by_number(b, n)) for n in a.names(len(a.times) - 1)}
            check(f"{program}: {patch} on {ranks} ranks", len(a.times) == len(b.times) and max(worst.values()) < 1e-6, max(worst.values()))
        a, b = one.table(part, table), many.table(part, table)
        check(f"{program}: {table} on {ranks} ranks", list(a) == list(b) and all(np.allclose(a[k], b[k], rtol=1e-6, atol=1e-6 * np.abs(list(a.values())[1:]).max()) for k in a))


def continued(folder, program, part):
    """Stopped in the middle and continued, the files are those of a run in one go, bit for bit."""
    from couplet.command.compare import arrays
    half = start(folder, program, sets=("simulation.output.folder=again", f"simulation.end-time={'0.2' if part == 'fluid' else '0.02'}"))
    rest = start(folder, program, sets=("simulation.output.folder=again",), more=("--restart", "again/checkpoints"))
    wanted, found = arrays(folder / "out-1"), arrays(folder / "again")
    names = [n for n in wanted if "surface-" in n or "fluxes.csv" in n or "reactions.csv" in n]
    same = [n for n in names if n in found and wanted[n].tobytes() == found[n].tobytes()]
    check(f"{program}: a restart continues {len(names)} tables bit for bit", half.returncode == rest.returncode == 0 and len(names) > 20 and names == same,
          (half.stderr + rest.stderr)[-500:] + str(sorted(set(names) - set(same))[:5]))


def refused(message, call):
    try:
        call()
    except Wrong as wrong:
        return message in str(wrong)
    return False


with tempfile.TemporaryDirectory(prefix="couplet-surfaces-") as name:
    for program, part, case, mesh, table in (("fluid_solver", "fluid", FLUID, DUCT, "fluxes.csv"), ("solid_solver", "solid", SOLID, BLOCK, "reactions.csv")):
        folder = pathlib.Path(name) / part
        folder.mkdir()
        (folder / "case.yaml").write_text(case)
        (folder / "mesh.geo").write_text(mesh)
        ran = [start(folder, program, ranks, (f"simulation.output.folder=out-{ranks}",)) for ranks in (1, 2, 3)]
        check(f"{program} ran", all(r.returncode == 0 for r in ran), "".join(r.stderr[-300:] for r in ran))
        same_on_ranks(folder, program, part, table)
        continued(folder, program, part)
        wrong = start(folder, program, sets=("simulation.output.folder=wrong", f"participants.{part}.output.surfaces=[{'wals' if part == 'fluid' else 'rot'}]"))
        check(f"{program}: a name that is no patch", wrong.returncode == 2 and "output.surfaces: " in wrong.stderr + wrong.stdout
              and f"Did you mean '{'walls' if part == 'fluid' else 'root'}'" in wrong.stderr + wrong.stdout, wrong.stderr[-300:])
        none = start(folder, program, sets=("simulation.output.folder=none", f"participants.{part}.output={{}}"))
        check(f"{program}: nothing unless asked for", none.returncode == 0 and not list((folder / "none").glob("*/surface*")) + list((folder / "none").glob("*/fluxes.csv")))
        check(f"{program}: the fields of the run are still found", couplet.find_series(folder / "out-1" / part).cells)
    flow, body = (couplet.Results(pathlib.Path(name) / part / "out-1") for part in ("fluid", "solid"))
    walls, forces = flow.surface("fluid", "walls"), flow.table("fluid", "forces.csv")
    load, row = walls.integral("traction"), len(forces["time [s]"]) - 1
    pairs = [(load[a], forces[f"walls pressure {x} [N]"][row] + forces[f"walls viscous {x} [N]"][row]) for a, x in enumerate("xy")]
    check("a fluid's tractions sum to its forces", all(abs(p - q) < 1e-12 * np.abs(pairs).max() for p, q in pairs), pairs)
    chains = walls.chains()
    check("both walls are followed edge by edge", sorted(len(edges) for edges, _ in chains) == [20, 20] and abs(walls.areas().sum() - 2) < 1e-12)
    check("no flow through walls", np.abs(flow.table("fluid", "fluxes.csv")["walls volume [m^3/s]"]).max() < 1e-12)
    tip, force = body.surface("solid", "tip"), 500 * np.sin(60 * 0.04)
    check("a solid's traction is its load", np.allclose(tip.integral("traction"), [0, force, 100], atol=1e-9 * abs(force)), tip.integral("traction"))
    folder = pathlib.Path(name)
    for part, patch, field in (("fluid", "walls", "wall-shear"), ("solid", "sides", "equivalent-stress")):
        picture = fields.draw_surface(folder / part / "out-1", field, patch, folder / f"{part}.png")
        check(f"picture of {field}", picture.stat().st_size > 5000)
    check("drawing names the surfaces that there are", refused("there is: inlet, walls", lambda: fields.draw_surface(folder / "fluid/out-1", "pressure", "wall")))
    check("and the fields", refused("the fields are: pressure", lambda: fields.draw_surface(folder / "fluid/out-1", "speed", "walls")))
end()
