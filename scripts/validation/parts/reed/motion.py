# SPDX-License-Identifier: Apache-2.0
"""The reed: mesh motion, contact, mesh 1 of the source."""
import re

import numpy as np

import couplet
from validation.parts.reed.valve import columns, meshed


# -- mesh -------------------------------------------------------------------------------------------------------------
LAST = "least scaled Jacobian [1]"
HUNDRED = "reed's slice opened to 3.9 mm and closed to 1 % of it, 100 times"
CYCLE = '"(0.001932*(1-cos(2*pi*t+acos(1-264/1932)))-0.000264)*(x/0.06)^2*(3-x/0.06)/2"'  # of the gap of 0.3 mm: from 0.039 to 3.9 mm
LIFT = '"0.0039*t*(x/0.06)^2*(3-x/0.06)/2"'  # a cantilever's, 3.9 mm at the tip


def walls(kind, *names):
    return ", ".join(f"{name}: {{type: {kind}}}" for name in names)


def moving(patch, motion):
    return f"{patch}: {{type: moving, motion: {{{motion}}}}}"


def frame(kind):
    sides = ("xmin", "xmax", "ymin", "ymax") + (("zmin", "zmax") if kind == 2 else ())
    z = ', "0"' if kind == 2 else ""
    return ("tests/verification/mover/frame.geo", 3 if kind == 2 else 2, f"{{kind: {kind}, n: {3 if kind == 2 else 6}}}", 1, 20,
            f'{walls("slip", *sides)}, {moving("block", f"""translation: ["0.475*t", "0.475*t"{z}]""")}')


# Mesh, dimension, its parameters, end [s], steps, boundaries.
SCENES = {
    "block in a frame closed to 5 %, triangles": frame(0),
    "block in a frame closed to 5 %, quadrilaterals": frame(1),
    "block in a frame closed to 5 %, tetrahedra": frame(2),
    "plate turned by 180 degrees": ("configs/moving-mesh/square.geo", 2, "{n: 50}", 1, 50,
                                    f'{walls("slip", "floor", "right", "lid", "left")}, {moving("plate", "angle: pi*t")}'),
    "reed's tip lifted to 3.9 mm, slice one cell deep": (
        "tests/verification/mover/reed_slice.geo", 3, "{}", 1, 20,
        f'{walls("fixed", "inlet", "outlet", "walls", "seat")}, sides: {{type: slip}}, {moving("plate", f"""displacement: ["0", "0", {LIFT}]""")}'),
    "reed's tip lifted to 3.9 mm, slice in two dimensions": (
        "tests/verification/mover/reed_plane.geo", 2, "{}", 1, 20,
        f'{walls("fixed", "inlet", "outlet", "walls", "seat")}, {moving("plate", f"""displacement: ["0", {LIFT}]""")}'),
    "reed's tip lifted to 3.9 mm, tetrahedra": (
        "tests/verification/mover/reed.geo", 3, "{}", 1, 20,
        f'{walls("fixed", "far", "lid", "seat")}, {walls("slip", "side", "clamp", "middle")}, {moving("plate", f"""displacement: ["0", "0", {LIFT}]""")}'),
    HUNDRED: (
        "tests/verification/mover/reed_plane.geo", 2, "{}", 100, 4000,
        f'{walls("fixed", "inlet", "outlet", "walls", "seat")}, {moving("plate", f"""displacement: ["0", {CYCLE}]""")}'),
    "two cylinders past each other at a gap of 10 %": (
        "configs/passing-cylinders/pair.geo", 2, "{gap: 0.1}", 8, 160,
        f'{walls("slip", "ends", "sides")}, {moving("upper", """translation: ["sin(pi*t/4)^3", 0]""")}, '
        f'{moving("lower", """translation: ["-sin(pi*t/4)^3", 0]""")}'),
}


def run(job, scene, method):
    """Rows of quality.csv, whether it came to the end, its message."""
    def make():
        mesh, dimension, parameters, end, steps, boundaries = SCENES[scene]
        folder = job.scratch / f"reed-{list(SCENES).index(scene)}-{method}"
        folder.mkdir()
        (folder / "case.yaml").write_text(f"""simulation: {{end-time: {end}, time-step: {end / steps}, max-step-halvings: 0, output: {{folder: out, interval: {end}}}, checkpoint: {{interval: 0}}}}
participants:
  mover:
    program: mesh_mover
    mesh: {job.root / mesh}
    mesh-parameters: {parameters}
    dimension: {dimension}
    method: {method}
    boundaries: {{{boundaries}}}
""")
        done = job.run([job.build / "bin" / "mesh_mover", folder / "case.yaml"], 1200)
        file = folder / "out" / "mover" / "quality.csv"
        if not file.exists():
            raise RuntimeError((done.stderr or done.stdout)[-400:])
        said = re.search(r"(inverts cell|makes cell|no valid mesh)", done.stderr + done.stdout)
        return couplet.read_csv(file), done.returncode == 0, said[1] if said else ""
    return job.once(("reed mesh", scene, method), make)


def end_of(scene, rows):
    share = 100 * rows["time [s]"][-1] / SCENES[scene][3]
    return f"{share:.0f} %" if share >= 1 else f"{share:.1g} %"


def reaches(job, scene):
    rows, valid, said = run(job, scene, "barrier")
    least = min(rows[LAST])
    text = f"all cells valid, least scaled Jacobian {least:.4f}" if valid else f"refused at {end_of(scene, rows)} of the way ({said})"
    beside = []
    for method in ("laplacian", "pseudo-solid"):
        other, came, said = run(job, scene, method)
        beside.append(f"{method} " + ("comes through too" if came else f"refused at {end_of(scene, other)} ({said})"))
    return f"{text}; {', '.join(beside)}", valid and least > 0


# -- contact ----------------------------------------------------------------------------------------------------------
SEAT = "verification_solid_seat"


def hertz(job):
    (width,), passed = job.recorded(SEAT, "of_hertz", "width_error_80")
    (peak,), _ = job.recorded(SEAT, "of_hertz", "peak_error_80")
    (face,), _ = job.recorded(SEAT, "of_hertz", "face_80")
    return (f"half width {100 * width:+.2f} % (a face there is {100 * face:.1f} % of it), largest pressure {100 * peak:+.2f} %",
            passed and abs(width) <= max(0.02, face) and abs(peak) <= 0.01)


def pressed(job):
    tests = [t for name, t in job.gtest(SEAT)[0].items() if "has_uniform_stress" in name]
    values = [float(v) for t in tests for key, v in t.items() if key.startswith("stress_")]
    passed = all(t["passed"] for t in tests)
    return f"{max(values):.1e} of the stress, on {len(values)} kinds of cells", passed and len(values) == 6 and max(values) <= 1e-7


def column(job):
    (found,) = (t for name, t in job.gtest(SEAT)[0].items() if "two_travel_times" in name)
    duration, force, rebound = map(float, found["bar_100"].split())
    return (f"duration {duration:.4f}, pressure {force:.4f}, momentum {rebound:.4f} of the closed form, 100 cells",
            found["passed"] and max(abs(v - 1) for v in (duration, force, rebound)) <= 0.02)


def kept(job):
    (small,), passed = job.recorded(SEAT, "every_impact", "conserving")
    (other,), _ = job.recorded(SEAT, "every_impact", "midpoint")
    (large,), more = job.recorded(SEAT, "at_large_strain", "large_strain")
    return f"{small:.1e} at small, {large:.1e} at large strain; the midpoint rule beside it {other:.1f}", passed and more and max(small, large) <= 1e-6


# -- mesh one ---------------------------------------------------------------------------------------------------------
MESH = meshed("{size: 0.85e-3, growth: 1.12}")
HALF, END_OF_MESH_ONE, WHOLE = 0.3e-3, 0.6e-3, 8e-3  # checkpoint, end of this run, what was asked for [s]


def run_mesh_one(job, name, end, ranks=(1, 1, 1, 1), flags=()):
    sets = (*MESH, f"simulation.end-time={end}", f"simulation.checkpoint.interval={HALF}", "simulation.output.interval=0")
    return job.coupled_run(job.root / "configs/reed-valve/case.yaml", f"reed-mesh-one-{name}", sets, ranks, 3 * 3600, flags)


def continued(job, name, end, ranks=(1, 1, 1, 1)):
    first = sorted((run_mesh_one(job, "whole", END_OF_MESH_ONE).folder / "checkpoints").glob("step-*"))[0]
    return run_mesh_one(job, name, end, ranks, ("--restart", str(first)))


def rows(result, file):
    """By time."""
    names = ("point-1 z [m]",) if file == "reed/probes.csv" else ("plate pressure z [N]",)
    t, values = columns(result, file, *names)
    return dict(zip(np.round(t, 9), values))


def apart(job, one, other):
    """Largest difference of lift and force over their largest values, at the times of the other."""
    worst = 0
    for file in ("reed/probes.csv", "fluid/forces.csv"):
        a, b = rows(one, file), rows(other, file)
        late = [t for t in b if t > HALF + 1e-9]
        worst = max(worst, max(abs(a[t] - b[t]) for t in late) / max(abs(v) for v in a.values()))
    return worst


def mesh_one(job):
    whole = run_mesh_one(job, "whole", END_OF_MESH_ONE)
    cells = int(re.search(r"^\[fluid 0\] mesh: (\d+) cells", whole.log, re.M)[1])
    milliseconds = END_OF_MESH_ONE * 1e3
    hours = whole.cost.cpu / 3600 / milliseconds
    again = apart(job, whole, continued(job, "again", END_OF_MESH_ONE))
    ranks = apart(job, whole, continued(job, "ranks", HALF + 0.1e-3, (1, 2, 1, 2)))
    wall = whole.cost.wall / 3600 * WHOLE / END_OF_MESH_ONE
    return (f"{cells / 1000:.0f} k cells, {2 * cells / 1000:.0f} k of the whole valve: {hours:.2f} core-hours per millisecond on 4 processes and two cores, {whole.cost.memory:.0f} MB in the largest; "
            f"8 ms at that rate {wall:.1f} h of wall time; restarted: {'bit for bit' if again == 0 else f'{again:.0e} apart'}, fluid and mover on two ranks: {ranks:.0e} apart",
            again == 0 and ranks < 1e-4 and wall <= 3)
