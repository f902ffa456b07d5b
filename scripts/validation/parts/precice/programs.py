# SPDX-License-Identifier: Apache-2.0
"""Programs of preCICE's own, unchanged: its tutorials and solver dummies as they were fetched, never in this
repository. The folders are named by COUPLET_PRECICE_TUTORIALS, COUPLET_PRECICE_DUMMIES (examples/solverdummies) and
COUPLET_PRECICE_PYTHON_DUMMY (examples/solverdummy of its Python bindings); without them the rows report that."""
import os
import pathlib
import re
import shlex
import shutil

import numpy as np

PUBLISHED = 223.52, -223.00  # elastic-tube-1d with preCICE: largest and smallest pressure in the middle, 100 steps
NOTE = "not measured: {} does not name the fetched programs"


def folder(name):
    place = os.environ.get(name)
    return pathlib.Path(place).resolve() if place and pathlib.Path(place).is_dir() else None


def commit_of(place, job):
    done = job.run(["git", "-C", place, "rev-parse", "--short=8", "HEAD"])
    return f", commit {done.stdout.strip()}" if done.returncode == 0 else ""


def flags(job):
    lib = job.build / "precice/lib"
    return [f"-I{job.root / 'client/precice/include'}", f"-L{lib}", "-lprecice", f"-Wl,-rpath,{lib}"]


def coupled(job, where, configuration, words):
    """Runs a job of programs, {name: shell command}; gives all that they print."""
    case = where / "case.yaml"
    job.run([job.root / "scripts/couplet", "import", configuration, "-o", case, "--force"], check=True)
    job.environment |= {
        "PYTHONPATH": str(job.root / "client/precice/python"),
        "COUPLET_PRECICE_LIBRARY": str(job.build / "precice/lib/libprecice.so.3"),
    }
    line = [
        "mpirun",
        "--oversubscribe",
        *(["--allow-run-as-root"] if os.geteuid() == 0 else []),
        "-n",
        "1",
        job.build / "bin/coupler",
        case,
    ]
    for command in words:
        line += [":", "-n", "1", "sh", "-c", command]
    done = job.done(line, cwd=where)
    return done.stdout + done.stderr


def passes(text):
    return float(re.search(r"coupling iterations: mean ([\d.]+)", text)[1])


# -- elastic-tube-1d
# ----------------------------------------------------------------------------------------------------
def middle_pressures(output):
    values = []
    for file in output.glob("out_fluid_*.vtk"):
        lines = [line for line in file.read_text().splitlines() if line.strip()]
        first = next(i for i, line in enumerate(lines) if line.startswith("SCALARS pressure")) + 2
        values.append(float(lines[first + 50]))
    return max(values), min(values)


def tube(job, fluid, solid):
    source = folder("COUPLET_PRECICE_TUTORIALS")
    if source is None:
        return NOTE.format("COUPLET_PRECICE_TUTORIALS"), None
    where = job.scratch / f"tube-{fluid}-{solid}"
    shutil.copytree(source / "elastic-tube-1d", where)
    for side, kind, name in (("fluid", fluid, "FluidSolver"), ("solid", solid, "SolidSolver")):
        if kind == "cpp":
            job.run(
                [
                    "g++",
                    "-O2",
                    "-std=c++17",
                    *sorted((where / f"{side}-cpp/src").glob("*.cpp")),
                    "-o",
                    where / f"{side}-cpp/{name}",
                    *flags(job),
                    "-llapack",
                ],
                check=True,
            )
    (where / f"fluid-{fluid}/output").mkdir(exist_ok=True)
    command = (
        lambda side, kind, name: (
            f"cd {shlex.quote(str(where))}/{side}-{kind} && exec"
            f" {f'./{name}' if kind == 'cpp' else f'/usr/bin/python3 {name}.py'} ../precice-config.xml"
        )
    )  # noqa: E731
    said = coupled(
        job,
        where,
        where / "precice-config.xml",
        [command("fluid", fluid, "FluidSolver"), command("solid", solid, "SolidSolver")],
    )
    high, low = middle_pressures(where / f"fluid-{fluid}/output")
    off = max(abs(high / PUBLISHED[0] - 1), abs(low / PUBLISHED[1] - 1))
    return (
        f"{high:.2f}, {low:.2f} ({100 * off:.2f} % off), {passes(said):.2f} coupling iterations per step{commit_of(source, job)}",
        off < 0.005,
    )


def newmark_of_both(steps=400, dt=0.0025):
    """Largest errors of the tutorial's two masses by the trapezoidal rule for both at once with the sub-steps'
    length."""
    stiffness = 4 * np.pi**2 * np.array([[5.0, -4.0], [-4.0, 5.0]])
    squares, modes = np.linalg.eigh(stiffness)
    u, v, worst = np.array([1.0, 0.0]), np.zeros(2), np.zeros(2)
    for n in range(1, steps + 1):
        v_new = np.linalg.solve(np.eye(2) + dt**2 / 4 * stiffness, v - dt * stiffness @ (u + dt / 4 * v))
        u, v = u + dt / 2 * (v + v_new), v_new
        worst = np.maximum(worst, abs(u - modes @ (np.cos(np.sqrt(squares) * n * dt) * modes[0])))
    return sorted(worst)


def oscillator(job):
    source = folder("COUPLET_PRECICE_TUTORIALS")
    if source is None:
        return NOTE.format("COUPLET_PRECICE_TUTORIALS"), None
    where = job.scratch / "oscillator"
    shutil.copytree(source / "oscillator", where)
    sides = ("Left", "Right")
    words = [
        f"cd {where}/mass-{side.lower()}-python && exec /usr/bin/python3 ../solver-python/oscillator.py Mass-{side} >"
        f" {where}/{side}.txt"
        for side in sides
    ]
    said = coupled(job, where, where / "precice-config.xml", words)
    errors = [
        float(re.search(r"^0\.0025,([\d.e-]+)", (where / f"{side}.txt").read_text(), flags=re.M)[1]) for side in sides
    ]
    own = newmark_of_both()
    return (
        (
            f"errors {', '.join(f'{e:.6e}' for e in sorted(errors))}, by itself {', '.join(f'{e:.6e}' for e in own)};"
            f" {passes(said):.2f} passes{commit_of(source, job)}"
        ),
        max(abs(np.array(sorted(errors)) - own)) < 1e-7,
    )


# -- solver dummies
# -----------------------------------------------------------------------------------------------------
def dummies(job):
    source = folder("COUPLET_PRECICE_DUMMIES")
    if source is None:
        return NOTE.format("COUPLET_PRECICE_DUMMIES"), None
    where, ran = job.scratch / "dummies", []
    shutil.copytree(source, where)
    commands = {
        "c++": ["g++", "-std=c++17", where / "cpp/solverdummy.cpp"],
        "c": ["gcc", where / "c/solverdummy.c"],
        "fortran": ["gfortran", "-J", where, where / "fortran/solverdummy.f90"],
    }
    for kind, command in commands.items():
        job.run([*command, "-o", where / f"dummy-{kind}", *flags(job)], check=True)
    start = {kind: where / f"dummy-{kind}" for kind in commands}
    pairs = [("c++", "c++"), ("c", "c++"), ("c++", "c"), ("fortran", "c++"), ("c++", "fortran")]
    if python := folder("COUPLET_PRECICE_PYTHON_DUMMY"):
        start["python"] = f"/usr/bin/python3 {python / 'solverdummy.py'}"
        pairs += [("python", "c++"), ("c++", "python"), ("python", "python")]
    for one, two in pairs:
        coupled(
            job,
            where,
            where / "precice-config.xml",
            [
                f"exec {start[kind]} {where}/precice-config.xml {name}"
                for kind, name in ((one, "SolverOne"), (two, "SolverTwo"))
            ],
        )
        ran.append(f"{one}/{two}")
    return f"{', '.join(ran)}: exit code 0", len(ran) == len(pairs) == 8


# -- against the client
# -------------------------------------------------------------------------------------------------
VERTICES, TWO = 100000, pathlib.Path(__file__).with_name("two.xml")


def cost(job):
    """The least of three runs each, in turn: others use the machine, too."""
    where, seconds, sums = job.scratch / "cost", {"precice": [], "native": []}, set()
    where.mkdir(exist_ok=True)
    shutil.copy(TWO, where)
    for kind in ("native", "precice") * 3:
        said = coupled(
            job,
            where,
            where / "two.xml",
            [f"exec {job.build}/bin/tests/precice_cost {kind} {name} two.xml {VERTICES}" for name in ("One", "Two")],
        )
        found = re.findall(r"([\d.]+) s a window, sum (\S+)", said)
        seconds[kind].append(max(float(s) for s, _ in found))
        sums.add(tuple(sorted(total for _, total in found)))
    native, by_precice = min(seconds["native"]), min(seconds["precice"])
    same = "the same sums of all values" if len(sums) == 1 else "other sums of all values"
    return (
        (
            f"{1e3 * by_precice:.1f} ms, client {1e3 * native:.1f} ms: {by_precice / native:.2f}x (load"
            f" {os.getloadavg()[0]:.0f}); {same}"
        ),
        len(sums) == 1 and by_precice <= 1.2 * native,
    )


# -- configurations
# -----------------------------------------------------------------------------------------------------
def configurations(job):
    source = folder("COUPLET_PRECICE_TUTORIALS")
    if source is None:
        return NOTE.format("COUPLET_PRECICE_TUTORIALS"), None
    files = sorted(f for f in source.rglob("precice-config*.xml") if f.is_file() and not f.is_symlink())
    valid, refused, wrong = 0, 0, []
    for file in files:
        case = job.scratch / "import.yaml"
        done = job.run([job.root / "scripts/couplet", "import", file, "-o", case, "--force"])
        if done.returncode == 2 and "not supported" in done.stderr:
            refused += 1
        elif done.returncode == 0 and job.run([job.build / "bin/coupler", case, "--check"]).returncode == 0:
            valid += 1
        else:
            wrong.append(file.parent.name)
    return (
        (
            f"{len(files)} read: {valid} valid cases, {refused} refused by a feature's"
            f" name{'; wrong: ' + ', '.join(wrong) if wrong else ''}{commit_of(source, job)}"
        ),
        bool(files) and not wrong,
    )
