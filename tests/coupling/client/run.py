# SPDX-License-Identifier: Apache-2.0
"""Programs of other people in a job: the examples in C++, C and Python with the real fluid, from the build and from an
installed prefix, on several ranks of the coupler and over a restart; what goes wrong is said.
Usage: run.py PROJECT BUILD MPIRUN... -- [examples | install | handshake | fenicsx | tube]"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import check, end, mpmd  # noqa: E402

project, build = map(pathlib.Path, sys.argv[1:3])
mpirun, what = sys.argv[3:sys.argv.index("--")], sys.argv[-1]
here = project / "tests/coupling/client"
environment = dict(os.environ, PYTHONPATH=str(project / "client/python"))
body_of = {"c++": [build / "bin/tests/spring_cylinder"], "c": [build / "bin/tests/spring_cylinder_c"],
           "python": ["/usr/bin/python3", project / "client/examples/spring_cylinder.py"]}
parameters = ["body", "2", "0.1", "3", "0.05"]


def run(folder, body, coupler_ranks=1, fluid_ranks=1, sets=(), restart=None, code=0):
    for name in ("case.yaml", "cylinder.geo"):
        shutil.copy(here / name, folder)
    extra = [*(f"--set={s}" for s in sets), *(["--restart", restart] if restart else [])]
    parts = [[build / "bin" / program, "case.yaml", *extra] for program in ("coupler", "fluid_solver", "mesh_mover")]
    line = mpmd([*parts, [*body, *parameters]], (coupler_ranks, fluid_ranks), mpirun)
    result = subprocess.run(line, cwd=folder, capture_output=True, text=True, timeout=300, env=environment)
    if result.returncode != code:
        print(result.stdout[-3000:], result.stderr[-3000:])
        check(f"exit code {code}", False, f"it is {result.returncode}")
    return result


def motion(folder):
    return [[float(w) for w in line.split(",")] for line in (pathlib.Path(folder) / "body.csv").read_text().splitlines()]


def apart(a, b):
    return max((abs(x - y) for p, q in zip(a, b) for x, y in zip(p, q)), default=0) if len(a) == len(b) else float("inf")


def python_is_there():
    there = not subprocess.run(["/usr/bin/python3", "-c", "import mpi4py, numpy"], capture_output=True).returncode
    if not there:
        print("skipped: Python without mpi4py and numpy")
    return there


def examples():
    results = {}
    for language, body in body_of.items():
        if language == "python" and not python_is_there():
            continue
        with tempfile.TemporaryDirectory() as folder:
            run(folder, body)
            results[language] = motion(folder)
    reference = results["c++"]
    check("the cylinder moves", len(reference) == 10 and abs(reference[-1][1] - 0.05) > 1e-4, f"{reference[-1]}")
    for language, result in results.items():
        check(f"{language}: the same motion", apart(reference, result) < 1e-9, f"{apart(reference, result):.1e}")
    for ranks in ((2, 1), (3, 2)):
        with tempfile.TemporaryDirectory() as folder:
            run(folder, body_of["c++"], *ranks)
            off = apart(reference, motion(folder))
            check(f"coupler on {ranks[0]} and fluid on {ranks[1]} ranks: the same motion", off < 1e-9, f"{off:.1e}")
    with tempfile.TemporaryDirectory() as folder:
        run(folder, body_of["c++"], sets=["simulation.end-time=0.1"])
        run(folder, body_of["c++"], restart="out/checkpoints")
        check("restart continues bit for bit", motion(folder) == reference[5:])
    for name in ("spring_cylinder.cpp", "spring_cylinder.c", "spring_cylinder.py"):
        n = len((project / "client/examples" / name).read_text().splitlines())
        check(f"{name} takes less than 80 lines", n < 80, str(n))


def install():
    with tempfile.TemporaryDirectory() as top:
        top = pathlib.Path(top)
        prefix, user = top / "prefix", top / "user"
        subprocess.run(["cmake", "--install", build / "client", "--prefix", prefix], check=True, capture_output=True)
        shutil.copytree(project / "client/examples", user)
        (user / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.20)\nproject(user LANGUAGES C CXX)\nset(CMAKE_CXX_STANDARD 17)\n"
            "find_package(couplet_client REQUIRED)\nadd_executable(mine spring_cylinder.cpp)\n"
            "target_link_libraries(mine couplet::client)\n")
        for command in (["cmake", "-S", user, "-B", user / "build", f"-DCMAKE_PREFIX_PATH={prefix}"],
                        ["cmake", "--build", user / "build"]):
            made = subprocess.run(command, capture_output=True, text=True)
            if made.returncode:
                print(made.stdout, made.stderr)
        check("a CMake project finds and links the installed library", (user / "build/mine").exists())
        flags = subprocess.run(["pkg-config", "--cflags", "--libs", "couplet_client"], capture_output=True, text=True,
                               env=dict(os.environ, PKG_CONFIG_PATH=str(prefix / "lib/pkgconfig"))).stdout.split()
        made = subprocess.run(["cc", "spring_cylinder.c", "-o", "mine_c", *flags, "-lm"], cwd=user, capture_output=True,
                              text=True)
        check("a C compiler does with pkg-config", made.returncode == 0, made.stderr[-500:])
        environment["PYTHONPATH"] = str(prefix / "share/couplet/python")
        bodies = {"cmake": [user / "build/mine"], "pkg-config": [user / "mine_c"],
                  "python": ["/usr/bin/python3", user / "spring_cylinder.py"]}
        if not python_is_there():
            del bodies["python"]
        results = {}
        for name, body in bodies.items():
            folder = top / name
            folder.mkdir()
            run(folder, body, sets=["simulation.end-time=0.06"])
            results[name] = motion(folder)
        for name, result in results.items():
            check(f"{name}: runs from the prefix", len(result) == 3 and apart(results["cmake"], result) < 1e-9)


def handshake():
    with tempfile.TemporaryDirectory() as folder:
        # Another participant's name: nobody plays the body.
        global parameters
        parameters = ["somebody", *parameters[1:]]
        said = run(folder, body_of["c++"], code=2)
        check("a guest whom nobody asked for is named", "'somebody' was started" in said.stderr + said.stdout)
        check("so is who is missing", "participant 'body' (spring_cylinder) is missing" in said.stderr + said.stdout)
        parameters = ["body", *parameters[1:]]
        for language, body in body_of.items():
            if language != "python" or python_is_there():
                said = run(folder, body, sets=["coupling.sub-steps={body: 2}"], code=1)
                check(f"{language}: sub-steps that nobody would take are refused", "takes one step per coupling step" in said.stderr + said.stdout)

    if not python_is_there():
        return
    with tempfile.TemporaryDirectory() as folder:
        # A program of Python that fails in the middle: MPI_Finalize alone would wait for the others for ever.
        broken = pathlib.Path(folder) / "broken.py"
        text = (project / "client/examples/spring_cylinder.py").read_text()
        broken.write_text(text.replace('if event == "solve":', 'if event == "solve":\n            1 / 0', 1))
        parameters = ["body", *parameters[1:]]
        said = run(folder, ["/usr/bin/python3", broken], code=1)
        check("its traceback is there", "ZeroDivisionError" in said.stderr)
        check("and who left", "participant 'body' ended before the job was over" in said.stderr)


def fenicsx():
    """The flap of FEniCSx instead of solid_solver, by the launch line alone."""
    if subprocess.run(["/usr/bin/python3", "-c", "import dolfinx"], capture_output=True).returncode:
        print("skipped: no DOLFINx here (Debian: python3-dolfinx)")
        return
    flap = project / "configs/perpendicular-flap"
    guest = ["--set", "participants.solid={program: flap_fenicsx}"]
    python = ["/usr/bin/python3", project / "client/examples/flap_fenicsx.py", "solid"]

    def coupled(folder, solid, end, *options):
        words = ["--set", f"simulation.end-time={end}", "--set", "simulation.checkpoint.interval=0.02", *options]
        parts = [[build / "bin" / program, "case.yaml", *words] for program in ("coupler", "fluid_solver", "mesh_mover")]
        line = mpmd([*parts, solid or [build / "bin/solid_solver", "case.yaml", *words]], mpirun=mpirun)
        for file in ("case.yaml", "fluid.geo", "solid.geo"):
            shutil.copy(flap / file, folder)
        done = subprocess.run(line, cwd=folder, capture_output=True, text=True, timeout=600, env=environment)
        if done.returncode:
            print(done.stdout[-3000:], done.stderr[-3000:])
        check("exit code 0", done.returncode == 0, str(done.returncode))
        return pathlib.Path(folder)

    def tips(file):
        return [float(line.split(",")[1]) for line in file.read_text().splitlines() if not line.startswith("time")]

    with tempfile.TemporaryDirectory() as folder:
        theirs = tips(coupled(folder, python, 0.03, *guest) / "solid.csv")
        again = tips(coupled(folder, python, 0.03, *guest, "--restart", "out/checkpoints/step-00000002") / "solid.csv")
        check("restart continues bit for bit", again == theirs[2:], f"{again} {theirs[2:]}")
    with tempfile.TemporaryDirectory() as folder:
        ours = tips(coupled(folder, None, 0.03) / "out/solid/probes.csv")[-1]
        check("tip within 1 % of solid_solver", abs(theirs[-1] / ours - 1) < 0.01, f"{theirs[-1]} {ours}")
    n = len((project / "client/examples/flap_fenicsx.py").read_text().splitlines())
    check("flap_fenicsx.py takes less than 80 lines", n < 80, str(n))


def tube():
    """Both participants from elsewhere: the tube in one dimension against its monolithic solution; restart with the history
    of the quasi-Newton method."""
    if not python_is_there():
        return
    sys.path.insert(0, str(project / "configs/tube-1d"))
    import tube as model
    wanted = model.monolithic(8)[:, 1]

    def coupled(folder, *options):
        done = subprocess.run([project / "configs/tube-1d/run", "--set", f"simulation.output.folder={folder}/out", "--set",
                               "simulation.end-time=0.08", "--set", "simulation.checkpoint.interval=0.04", *options], cwd=folder,
                              capture_output=True, text=True, timeout=300, env=dict(environment, COUPLET_BIN=str(build / "bin")))
        if done.returncode:
            print(done.stdout[-3000:], done.stderr[-3000:])
        check("exit code 0", done.returncode == 0, str(done.returncode))
        return [float(line.split(",")[1]) for line in (pathlib.Path(folder) / "tube.csv").read_text().splitlines()]

    with tempfile.TemporaryDirectory() as folder:
        pressure = coupled(folder)
        off = max(abs(a - b) for a, b in zip(pressure, wanted)) / max(abs(wanted))
        check("pressure of the monolithic solution", len(pressure) == 8 and off < 1e-4, f"{off:.1e}")
        again = coupled(folder, "--restart", f"{folder}/out/checkpoints/step-00000004")
        check("restart continues bit for bit", again == pressure[4:], f"{again} {pressure[4:]}")


{"examples": examples, "install": install, "handshake": handshake, "fenicsx": fenicsx, "tube": tube}[what]()
end()
