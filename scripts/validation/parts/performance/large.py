# SPDX-License-Identifier: Apache-2.0
"""Large meshes and interfaces, many ranks."""
import importlib
import json
import re
import sys

from couplet.runs import launch


# -- large ------------------------------------------------------------------------------------------------------------
# name: (cells along each side, cut into tetrahedra, further words of `open`)
MESHES = {"hexahedra": (160, False, ()), "tetrahedra": (70, True, ("--solid",))}
RANKS = (2, 8, 16)
STEPS = 13


def cut(job, n, tetrahedra=False):
    """The box with n hexahedra along each side."""

    def make():
        file = job.scratch / f"box-{n}-{tetrahedra}.h5"
        job.done(
            [
                job.build / "bin/mesh_tool",
                "box",
                "--cells",
                n,
                n,
                n,
                "-o",
                file,
                *(["--tetrahedra"] if tetrahedra else []),
            ]
        )
        return file

    return job.once(("cut mesh", n, tetrahedra), make)


def opened(job, kind, ranks):
    """Peak over all ranks, the largest of one, and what was there before [MB]."""
    n, tetrahedra, words = MESHES[kind]

    def make():
        launcher = ["mpirun", "--oversubscribe", "-n", ranks]
        result = job.run(
            [*launcher, job.build / "bin/mesh_tool", "open", cut(job, n, tetrahedra), *words], timeout=3600
        )
        found = re.search(
            r"peak of memory ([\d.]+) MB over all ranks, ([\d.]+) MB on one, of which ([\d.]+) MB", result.stdout
        )
        if result.returncode != 0 or not found:
            raise RuntimeError((result.stdout + result.stderr)[-300:])
        return tuple(map(float, found.groups()))

    return job.once(("opened", kind, ranks), make)


def together(job, kind):
    one = opened(job, kind, 1)[0]
    all_ = {ranks: opened(job, kind, ranks) for ranks in RANKS}
    words = ", ".join(
        f"{peak / one:.2f} on {ranks} ({peak / 1000:.2f} GB, of them {before / 1000:.2f} before the mesh)"
        for ranks, (peak, _, before) in all_.items()
    )
    return f"{words}; one rank {one / 1000:.2f} GB", max(peak / one for peak, *_ in all_.values()) <= 1.3


def per_rank(job, kind):
    peak, _, before = opened(job, kind, 1)
    shares = {
        ranks: (most - there / ranks) * ranks / (peak - before)
        for ranks in RANKS
        for _, most, there in [opened(job, kind, ranks)]
    }
    return "; ".join(f"{share:.2f} on {ranks}" for ranks, share in shares.items()), max(shares.values()) <= 1.2


def steps(job, n, count, ranks):
    """Cost of a run of so many steps of a cavity, and its output."""
    folder = job.scratch / f"large-{n}-{count}-{ranks}"
    folder.mkdir(exist_ok=True)
    dt = 0.2 / n
    (folder / "case.yaml").write_text(
        f"""simulation: {{end-time: {count * dt:.10g}, time-step: {dt}, output: {{folder: out, interval: {count * dt:.10g}}}, accept: [error-estimate]}}
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
"""
    )
    launcher = ["mpirun", "--oversubscribe", "-n", ranks] if ranks > 1 else []
    return (
        launch([*launcher, job.build / "bin/fluid_solver", "case.yaml"], folder / "log", folder),
        (folder / "log").read_text(),
    )


# -- wall -------------------------------------------------------------------------------------------------------------
VERTICES, WALL_RANKS, WALL_STEPS = 1_000_000, 4, 5
CASE = """simulation: {{end-time: {end}, time-step: 0.01, output: {{folder: out, interval: 0}}, checkpoint: {{interval: 0}}, accept: [error-estimate]}}
participants:
  fluid: {{program: sheet}}
  solid: {{program: sheet}}
coupling:
  scheme: explicit
  exchange: {{participants: [fluid, solid], order: serial}}
  mapping: {{type: projection}}
"""
SHARED_MEMORY = ("--mca", "pml", "ob1", "--mca", "btl", "self,vader")


def sheet(job):
    def make():
        program = job.scratch / "sheet"
        client = job.root / "client"
        job.done(
            [
                "mpicxx",
                "-O2",
                "-std=c++17",
                "-DOMPI_SKIP_MPICXX",
                f"-I{client}",
                job.root / "benchmarks/exchange/sheet.cpp",
                *client.glob("*.cpp"),
                "-o",
                program,
            ]
        )
        return program

    return job.once(("sheet",), make)


def coupled(job, ranks):
    """Returns the output of the programs and run.json of the coupler."""

    def make():
        folder = job.scratch / f"sheet-{ranks}"
        folder.mkdir()
        (folder / "case.yaml").write_text(CASE.format(end=WALL_STEPS * 0.01))
        sides = [word for name in ("fluid", "solid") for word in (":", "-n", ranks, sheet(job), name, VERTICES)]
        result = job.done(
            ["mpirun", "--oversubscribe", "-n", ranks, job.build / "bin/coupler", "case.yaml", *sides], 3600, cwd=folder
        )
        return result.stdout, json.loads((folder / "out/coupler/run.json").read_text())

    return job.once(("sheet", ranks), make)


def maps(job):
    """Time from the start of the job to the first step, as the slower side sees it: surfaces sent, maps made, places
    judged. Processor time is that of the coupler until its end, which hangs less on what else the machine does."""
    text, run = coupled(job, WALL_RANKS)
    seconds = max(map(float, re.findall(r"first step after ([\d.]+)", text)))
    off = float(re.search(r"displacement off by (\S+) m", text)[1])
    return (
        (
            f"{seconds:.1f} s until the first step, {run['processor']:.1f} s of processor time of the coupler's"
            f" {WALL_RANKS} ranks with {WALL_STEPS} steps, on two cores; a linear motion arrives to {off:.1g} m"
        ),
        seconds <= 10 and off < 1e-9,
    )


def share(job):
    """Returns the share of memory, as the system counts it, of the surfaces, their copies and the maps."""
    _, run = coupled(job, WALL_RANKS)
    fullest = run["memory-most"] / (run["memory-all"] / WALL_RANKS)
    return (
        (
            f"{fullest:.2f} of the mean of {WALL_RANKS} ranks, {run['memory-all'] / 1000:.2f} GB over all,"
            f" {run['memory-most'] / 1000:.2f} GB on the fullest; vertices and faces are cut evenly, what is near a cut"
            " is copied"
        ),
        fullest <= 2,
    )


def beside_mpi(job):
    text, _ = coupled(job, WALL_RANKS)
    step = float(re.search(r"steps, ([\d.]+) s a step", text)[1])
    alone = job.done(
        ["mpirun", "--oversubscribe", *SHARED_MEMORY, "-n", 2 * WALL_RANKS, sheet(job), "plain", VERTICES]
    ).stdout
    plain = float(re.search(r"plain ([\d.]+) s", alone)[1])
    return (
        (
            f"{step:.3f} s for a step of two passes, least of {WALL_STEPS - 1}; MPI alone {plain:.3f} s there and back,"
            f" least of 20: {step / plain:.1f} times"
        ),
        step <= 3 * plain,
    )


# -- many -------------------------------------------------------------------------------------------------------------
SCENES = ("fluid", "solid", "mover", "flap")


def scaling(job, name):
    folder = str(job.root / "benchmarks/scaling")
    if folder not in sys.path:
        sys.path.insert(0, folder)
    return importlib.import_module(name)


def rows(job, scene, ranks):
    """Counts per step of the programs of one scene on these numbers of ranks."""
    counts = scaling(job, "counts")
    return job.once(
        ("counts", scene, tuple(ranks)), lambda: counts.scan({scene: counts.SCENES[scene]}, ranks, job.build)
    )


def words(found, key):
    return "; ".join(
        f"{program} " + ", ".join(f"{r[key]:.0f} on {r['ranks']}" for r in found if r["program"] == program)
        for program in dict.fromkeys(r["program"] for r in found)
    )


def flat(job, ranks, share):
    """Iterations of the linear solvers on these numbers of ranks beside those on the first."""
    got, worst = [], 0
    for scene in ("fluid", "solid"):
        own = rows(job, scene, ranks)
        change = max(abs(r["iterations"] / own[0]["iterations"] - 1) for r in own)
        got.append(
            f"{scene} " + ", ".join(f"{r['iterations']:.1f} on {r['ranks']}" for r in own) + f" ({100 * change:.0f} %)"
        )
        worst = max(worst, change)
    return "; ".join(got), worst <= share


def predicted(job, nodes, cores):
    """Weak scaling as the model makes it of the committed counts."""
    model = scaling(job, "model")
    counts = json.loads((job.root / "benchmarks/scaling/counts.json").read_text())
    found = {
        program: (weak, strong)
        for program, ranks, weak, strong in model.predictions(counts, nodes, cores, 1e6)
        if ranks == nodes * cores
    }
    return "; ".join(
        f"{program} {100 * weak:.0f} % weak, {100 * strong:.0f} % strong" for program, (weak, strong) in found.items()
    ), all(w >= 0.9 for w, _ in found.values())
