# SPDX-License-Identifier: Apache-2.0
"""Meshes of which no rank has the whole: memory of their set-up on several ranks, by `mesh_tool open`, which does what the programs do, and its
time beside the fluid's steps. Boxes made in parallel by `mesh_tool box`."""
import re

from couplet.runs import launch

# name: (cells along each side, cut into tetrahedra, further words of `open`)
MESHES = {"hexahedra": (160, False, ()), "tetrahedra": (70, True, ("--solid",))}
RANKS = (2, 8, 16)
STEPS = 13


def cut(job, n, tetrahedra=False):
    """The box with n hexahedra along each side."""
    def make():
        file = job.scratch / f"box-{n}-{tetrahedra}.h5"
        job.done([job.build / "bin/mesh_tool", "box", "--cells", n, n, n, "-o", file, *(["--tetrahedra"] if tetrahedra else [])])
        return file
    return job.once(("cut mesh", n, tetrahedra), make)


def opened(job, kind, ranks):
    """Peak over all ranks, the largest of one, and what was there before [MB]."""
    n, tetrahedra, words = MESHES[kind]

    def make():
        launcher = ["mpirun", "--oversubscribe", "-n", ranks]
        result = job.run([*launcher, job.build / "bin/mesh_tool", "open", cut(job, n, tetrahedra), *words], timeout=3600)
        found = re.search(r"peak of memory ([\d.]+) MB over all ranks, ([\d.]+) MB on one, of which ([\d.]+) MB", result.stdout)
        if result.returncode != 0 or not found:
            raise RuntimeError((result.stdout + result.stderr)[-300:])
        return tuple(map(float, found.groups()))
    return job.once(("opened", kind, ranks), make)


def together(job, kind):
    one = opened(job, kind, 1)[0]
    all_ = {ranks: opened(job, kind, ranks) for ranks in RANKS}
    words = ", ".join(f"{peak / one:.2f} on {ranks} ({peak / 1000:.2f} GB, of them {before / 1000:.2f} before the mesh)" for ranks, (peak, _, before) in all_.items())
    return f"{words}; one rank {one / 1000:.2f} GB", max(peak / one for peak, *_ in all_.values()) <= 1.3


def per_rank(job, kind):
    peak, _, before = opened(job, kind, 1)
    shares = {ranks: (most - there / ranks) * ranks / (peak - before) for ranks in RANKS for _, most, there in [opened(job, kind, ranks)]}
    return "; ".join(f"{share:.2f} on {ranks}" for ranks, share in shares.items()), max(shares.values()) <= 1.2


def steps(job, n, count, ranks):
    """Cost of a run of so many steps of a cavity, and its output."""
    folder = job.scratch / f"large-{n}-{count}-{ranks}"
    folder.mkdir(exist_ok=True)
    dt = 0.2 / n
    (folder / "case.yaml").write_text(f"""simulation: {{end-time: {count * dt:.10g}, time-step: {dt}, output: {{folder: out, interval: {count * dt:.10g}}}, accept: [error-estimate]}}
participants:
  fluid:
    program: fluid_solver
    mesh: {cut(job, n)}
    dimension: 3
    density: 1
    viscosity: 0.001
    viscous: explicit
    time-step: {dt}
    pressure-tolerance: 1e-6
    boundaries: {{zmax: {{type: moving-wall, velocity: [1, 0, 0]}}, {', '.join(f'{side}: {{type: no-slip}}' for side in ('xmin', 'xmax', 'ymin', 'ymax', 'zmin'))}}}
""")
    launcher = ["mpirun", "--oversubscribe", "-n", ranks] if ranks > 1 else []
    return launch([*launcher, job.build / "bin/fluid_solver", "case.yaml"], folder / "log", folder), (folder / "log").read_text()


def beside_steps(job):
    """Wall time of the process beyond the run's own account, which begins with the first step: opening the mesh, matrices, MPI."""
    found = []
    for ranks in (1, 2):
        cost, text = steps(job, 100, STEPS, ranks)
        account = {m[1]: float(m[2]) for m in re.finditer(r"^(\w+) +([\d.]+) +[\d.]+ %", text, re.M)}
        step = sum(account.get(part, 0) for part in ("begin_step", "solve", "accept_step")) / STEPS
        found.append((ranks, (cost.wall - account["total"]) / step, step))
    words = "; ".join(f"{ratio:.1f} steps of {step:.2f} s on {ranks}" for ranks, ratio, step in found)
    return words, max(ratio for _, ratio, _ in found) <= 20


def largest(job):
    n = MESHES["hexahedra"][0]
    cost, text = steps(job, n, 3, 2)
    memory = float(re.search(r"peak memory of .*, (\d+) MB in total", text)[1])
    return f"{n ** 3 / 1e6:.1f} M hexahedra, 3 steps on 2 ranks: {memory / 1000:.1f} GB, {cost.cpu:.0f} s of processor time", None
