# SPDX-License-Identifier: Apache-2.0
"""Measures of mesh motion around thin bodies: the barrier to the end of the way, its neighbours refused on it, and the price of each."""
import re
import resource

import couplet

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


def run(job, scene, method, share=1.0, again=0):
    """Rows of quality.csv, whether it came to the end, its message, cpu seconds of the whole run, seconds of its steps."""
    def make():
        mesh, dimension, parameters, end, steps, boundaries = SCENES[scene]
        folder = job.scratch / f"reed-{list(SCENES).index(scene)}-{method}-{share}-{again}"
        folder.mkdir()
        (folder / "case.yaml").write_text(f"""simulation: {{end-time: {end * share}, time-step: {end / steps}, max-step-halvings: 0, output: {{folder: out, interval: {end}}}, checkpoint: {{interval: 0}}}}
participants:
  mover:
    program: mesh_mover
    mesh: {job.root / mesh}
    mesh-parameters: {parameters}
    dimension: {dimension}
    method: {method}
    boundaries: {{{boundaries}}}
""")
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = job.run([job.build / "bin" / "mesh_mover", folder / "case.yaml"], 1200)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        total = re.search(r"^total +([\d.]+) +100", done.stdout + done.stderr, re.M)
        file = folder / "out" / "mover" / "quality.csv"
        if not file.exists():
            raise RuntimeError((done.stderr or done.stdout)[-400:])
        said = re.search(r"(inverts cell|makes cell|no valid mesh)", done.stderr + done.stdout)
        return (couplet.read_csv(file), done.returncode == 0, said[1] if said else "",
                after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, float(total[1]) if total else float("nan"))
    return job.once(("reed mesh", scene, method, share, again), make)


def end_of(scene, rows):
    share = 100 * rows["time [s]"][-1] / SCENES[scene][3]
    return f"{share:.0f} %" if share >= 1 else f"{share:.1g} %"


def reaches(job, scene):
    rows, valid, said, *_ = run(job, scene, "barrier")
    least = min(rows[LAST])
    text = f"all cells valid, least scaled Jacobian {least:.4f}" if valid else f"refused at {end_of(scene, rows)} of the way ({said})"
    beside = []
    for method in ("laplacian", "pseudo-solid"):
        other, came, said, *_ = run(job, scene, method)
        beside.append(f"{method} " + ("comes through too" if came else f"refused at {end_of(scene, other)} ({said})"))
    return f"{text}; {', '.join(beside)}", valid and least > 0


CAUSE = ("; two fifths of it are conjugate gradients, a third the assembly of eight simplices in three components per hexahedron, though the slice is one cell "
         "deep: factors in place of multigrid took 16 times; in two dimensions the slice meets the bar")


def price(job, scene):
    """Over the way that the Laplacian stands, in the same steps; the least of three runs each."""
    rows = run(job, scene, "laplacian")[0]
    share = round(float(rows["time [s]"][-1]) / SCENES[scene][3], 6)
    runs = {m: [run(job, scene, m, share, i) for i in (1, 2, 3)] for m in ("laplacian", "pseudo-solid", "barrier")}
    steps, whole = ({m: min(r[k] for r in of) for m, of in runs.items()} for k in (4, 3))
    all_of_it = min(run(job, scene, "barrier", 1.0, i)[4] for i in (1, 2))
    against = lambda cost, m: f"{cost[m] / cost['laplacian']:.1f}"
    met = steps["barrier"] <= 6 * steps["laplacian"]
    return (f"steps {against(steps, 'barrier')} times ({steps['barrier']:.3f}, {steps['laplacian']:.3f} s; pseudo-solid {against(steps, 'pseudo-solid')} times), "
            f"whole runs {against(whole, 'barrier')} times in cpu, over the {100 * share:.0f} % of the way that the laplacian stands; barrier over the whole "
            f"way {all_of_it:.2f} s{'' if met else CAUSE}"), met
