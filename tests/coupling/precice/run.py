# SPDX-License-Identifier: Apache-2.0
"""Programs on preCICE's interface in a job: C++, C, Python and Fortran against each other, all schemes and sub-steps against the same
scheme computed here, several processes, wrong calls, and the import of configurations.
Usage: run.py PROJECT BUILD MPIRUN... -- languages | schemes | waveforms | ranks | meshes | wrong | answers | import"""
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile

import numpy as np

project, build = map(pathlib.Path, sys.argv[1:3])
mpirun, what = sys.argv[3:sys.argv.index("--")], sys.argv[-1]
sys.path[:0] = [str(project / "client/python")]
from couplet.command import main  # noqa: E402
from couplet.runs.process import Pages, culprit  # noqa: E402
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import check, end  # noqa: E402
from oscillators_xml import configuration  # noqa: E402

here, python = project / "tests/coupling/precice", "/usr/bin/python3"
os.environ["COUPLET_PRECICE_LIBRARY"] = str(build / "precice/lib/libprecice.so.3")
environment = dict(os.environ, PYTHONPATH=str(project / "client/precice/python"))
programs = {"c++": [build / "bin/tests/precice_oscillators"], "c": [build / "bin/tests/precice_oscillators_c"], "python": [python, here / "oscillators.py"]}


def imported(folder, text):
    """The configuration and, of it, case.yaml in a folder."""
    (folder / "precice-config.xml").write_text(text)
    with open(os.devnull, "w") as nothing:
        out, sys.stdout = sys.stdout, nothing
        try:
            code = main(["couplet", "import", str(folder / "precice-config.xml"), "-o", str(folder / "case.yaml"), "--force"])
        finally:
            sys.stdout = out
    check("the configuration is imported", code == 0) if code else None


def launch(folder, words, sets=(), ranks=None):
    """words: of each participant."""
    command = [*mpirun, "-n", (ranks or {}).get("coupler", 1), build / "bin/coupler", "case.yaml", "-q", *(f"--set={s}" for s in sets)]
    for name, line in words.items():
        command += [":", "-n", (ranks or {}).get(name, 1), *line]
    return subprocess.run(list(map(str, command)), cwd=folder, capture_output=True, text=True, timeout=60, env=environment)


def motion(folder, name, ranks=1):
    """Rows (t, u of the pairs from left to right)."""
    parts = [np.atleast_2d(np.loadtxt(folder / f"{name}-{r}.txt")) for r in range(ranks)]
    u = np.hstack([p[:, 1:] for p in parts])
    return np.column_stack((parts[0][:, 0], u if name == "Left" else u[:, ::-1]))


def run(scheme, left="c++", right="c++", steps=(1, 1), ranks=None, initialize="true", sets=(), iterations=50, degree=None, substeps=None):
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        imported(folder, configuration(scheme, initialize, iterations=iterations, degree=degree, substeps=substeps))
        words = {name: [*programs[kind], name, "precice-config.xml", n, *(["parallel"] if ranks else [])]
                 for name, kind, n in (("Left", left, steps[0]), ("Right", right, steps[1]))}
        done = launch(folder, words, sets, ranks)
        if done.returncode:
            print(done.stdout[-2000:], done.stderr[-2000:])
        check(f"{scheme}, {left} and {right}, {steps[0]} and {steps[1]} steps a window: runs", done.returncode == 0, done.returncode or "")
        return {name: motion(folder, name, (ranks or {}).get(name, 1)) for name in words}


def launch_separately(folder, words, ranks, ways):
    """The same with each participant started by an mpirun of its own; ways: how its relay listens. Exit codes and all that was said."""
    relays = {name: [build / "bin/relay", name, "--listen", ways[name]] for name in words}
    own = {name: value for name, value in environment.items() if not name.startswith(("OMPI_COMM", "PMIX_"))}
    started = [subprocess.Popen(list(map(str, [*mpirun, "-n", ranks[name], *line])), cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                env={**own, "COUPLET_JOIN": f"{name}.relay"}) for name, line in words.items()]
    done = launch(folder, relays, ranks=ranks)
    said = [p.communicate(timeout=60)[0] for p in started]
    return [done.returncode, *(p.returncode for p in started)], [done.stdout + done.stderr, *said]


# -- the same schemes, computed here ------------------------------------------------------------------------------------
X, SPRING, WINDOW = np.arange(6.0), 15.0, 0.1
START = {"Left": 1 - 0.1 * X, "Right": 0.3 * X - 0.5}
STIFFNESS = {"Left": 40 + 4 * X, "Right": 30 + 2 * X}


def in_time(values, share, degree):
    """The polynomial through all values at equal distances, if they are too few for more than one of the degree, or the line from one to the next."""
    n = len(values) - 1
    if degree > 1:
        assert n <= degree
        nodes = np.arange(n + 1) / n
        return sum(v * np.prod([(share - other) / (node - other) for other in nodes if other != node]) for v, node in zip(values, nodes))
    k = min(int(share * n), n - 1)
    return values[k] + (share * n - k) * (values[k + 1] - values[k])


def window(name, state, others, steps, degree=1):
    """The motion at the ends of the sub-steps; others: the other's motion at equal distances, from the start of the window on."""
    (u, v), h, k, motion = state, WINDOW / steps, STIFFNESS[name] + SPRING, []
    at = lambda n: in_time(others, n / steps, degree)  # noqa: E731
    for n in range(steps):
        v_new = (v + h * (SPRING * (at(n) + at(n + 1)) / 2 - k * (u + h / 4 * v))) / (1 + h * h / 4 * k)
        u, v = u + h / 2 * (v + v_new), v_new
        motion.append(u)
    return u, v, motion


def expected(scheme, steps=(1, 1), initialize="true", windows=10, degree=1, substeps=False):
    """substeps: the values at all sub-steps go over, not only those at the end of the window."""
    state = {name: (u, 0 * u) for name, u in START.items()}
    seen = {name: (u if initialize == "true" else 0 * u) for name, u in START.items()}  # at the start of the window, by the others
    rows = {name: [] for name in START}
    for _ in range(windows):
        end = {name: [u] for name, u in seen.items()}  # at the ends of the sub-steps
        for _ in range(200 if "implicit" in scheme else 1):
            held = "explicit" in scheme
            left = window("Left", state["Left"], [end["Right"][-1]] * 2 if held else [seen["Right"], *end["Right"]], steps[0], degree)
            given = left[2] if substeps else left[2][-1:]
            right = window("Right", state["Right"], [seen["Left"], *given] if "serial" in scheme else [end["Left"][-1]] * 2 if held else [seen["Left"], *end["Left"]], steps[1], degree)
            end = {"Left": given, "Right": right[2] if substeps else right[2][-1:]}
        state, seen = {"Left": left[:2], "Right": right[:2]}, {name: values[-1] for name, values in end.items()}
        for name, (u, _) in state.items():
            rows[name].append(u)
    return {name: np.array(r) for name, r in rows.items()}


def apart(found, wanted):
    return max(np.abs(found[name][:, 1:] - wanted[name]).max() if len(found[name]) == len(wanted[name]) else np.inf for name in wanted)


def exact(windows=10):
    """The two masses of each pair, by their modes."""
    ends = {"Left": np.zeros((windows, 6)), "Right": np.zeros((windows, 6))}
    for i in range(6):
        squares, modes = np.linalg.eigh([[STIFFNESS["Left"][i] + SPRING, -SPRING], [-SPRING, STIFFNESS["Right"][i] + SPRING]])
        for n in range(windows):
            ends["Left"][n, i], ends["Right"][n, i] = modes @ (np.cos(np.sqrt(squares) * WINDOW * (n + 1)) * (modes.T @ [START["Left"][i], START["Right"][i]]))
    return ends


# -- the tests ----------------------------------------------------------------------------------------------------------
def languages():
    wanted = expected("serial-implicit")
    pairs = [("c++", "c++"), ("c", "python"), ("python", "c")]
    with tempfile.TemporaryDirectory() as folder:
        if shutil.which("gfortran"):
            made = subprocess.run(["gfortran", "-O1", project / "client/precice/fortran/precice.f90", here / "oscillators.f90", "-o", f"{folder}/oscillators", f"-L{build}/precice/lib",
                                   "-lprecice", f"-Wl,-rpath,{build}/precice/lib"], cwd=folder, capture_output=True, text=True)
            check("Fortran's module and program compile", made.returncode == 0, made.stderr[-500:])
            programs["fortran"] = [f"{folder}/oscillators"]
            pairs.append(("fortran", "c++"))
        else:
            print("skipped: Fortran, there is no gfortran")
        for left, right in pairs:
            off = apart(run("serial-implicit", left, right), wanted)
            check(f"{left} and {right}: the motion of the monolithic trapezoidal rule", off < 1e-10, f"{off:.1e}")


def schemes():
    for scheme in ("serial-explicit", "parallel-explicit", "serial-implicit", "parallel-implicit"):
        off = apart(run(scheme, steps=(3, 2), substeps="false"), expected(scheme, (3, 2)))
        check(f"{scheme}: as computed", off < (1e-9 if "implicit" in scheme else 1e-13), f"{off:.1e}")
    off = apart(run("parallel-explicit", initialize="false"), expected("parallel-explicit", initialize="false"))
    check("without initial data the first window reads zeros", off < 1e-13, f"{off:.1e}")
    computed, true = expected("serial-implicit", (20, 20)), exact()
    off = max(np.abs(computed[name] - true[name]).max() for name in true)
    check("the scheme computed here is the physics (a line in time within a window)", off < 0.1, f"{off:.1e}")
    few = apart(run("serial-implicit", iterations=2), expected("serial-implicit"))
    check("a window is accepted at max-iterations", 1e-9 < few < 0.3, f"{few:.1e} from the converged motion")


def said_by(folder, name, words):
    """A job of one of the programs here on both sides; what it printed."""
    done = launch(folder, {side: [python, here / name, side, "precice-config.xml", *words] for side in ("Left", "Right")})
    check(f"{name} {' '.join(map(str, words))}: runs", done.returncode == 0, done.stderr[-800:])
    return done.stdout


def waveforms():
    for scheme, steps, degree in (("serial-implicit", (3, 2), 1), ("parallel-implicit", (3, 2), 3), ("serial-implicit", (2, 3), 3), ("serial-explicit", (3, 2), 3)):
        off = apart(run(scheme, steps=steps, degree=degree), expected(scheme, steps, degree=degree, substeps=True))
        check(f"{scheme}, degree {degree}, values at {steps} sub-steps: as computed", off < (1e-9 if "implicit" in scheme else 1e-13), f"{off:.1e}")
    cubic, lines = (expected("serial-implicit", (3, 2), degree=degree, substeps=True) for degree in (3, 1))
    two = max(abs(cubic[name] - lines[name]).max() for name in cubic)
    check("degree 3 is another motion than degree 1", two > 1e-5, f"{two:.1e}")
    off = apart(run("serial-implicit", steps=(2, 2), ranks={"Left": 3, "Right": 2, "coupler": 2}), expected("serial-implicit", (2, 2), substeps=True))
    check("values at the sub-steps on 3 and 2 processes, coupler on 2: the same motion", off < 1e-9, f"{off:.1e}")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for scheme in ("serial-explicit", "serial-implicit"):
            imported(folder, configuration(scheme, degree=0, end=0.3))
            found = re.search(r"worst (\S+) beyond ([-+.e\d]+)", said_by(folder, "polynomial.py", [0]))
            check(f"{scheme}: with degree 0 the value at the next sub-step is read", bool(found) and max(map(float, found.groups())) < 1e-14, found and found[0])
        for scheme, degree in (("serial-explicit", 3), ("serial-implicit", 2), ("parallel-implicit", 3)):
            imported(folder, configuration(scheme, degree=degree, end=0.3))
            found = re.search(r"worst (\S+) beyond ([-+.e\d]+)", said_by(folder, "polynomial.py", [degree]))
            worst, beyond = map(float, found.groups()) if found else (1, 0)
            check(f"{scheme}: polynomials of degree {degree} in time arrive to rounding (side by side: to the limit of convergence)", worst < (1e-11 if "parallel" in scheme else 1e-14), f"{worst:.1e}")
            check(f"{scheme}: one of degree {degree + 1} does not", beyond > 1e-9, f"{beyond:.1e}")
        errors = {}
        for scheme, degree, steps in (("serial-implicit", 1, 4), ("serial-implicit", 1, 8), ("serial-implicit", 3, 4), ("serial-implicit", 3, 8), ("parallel-implicit", 3, 8)):
            imported(folder, configuration(scheme, degree=degree, end=1).replace('size value="0.1"', 'size value="0.5"'))
            found = re.search(r"Left ends with ([-+.e\d]+)", said_by(folder, "circuit.py", [steps]))
            errors[scheme, degree, steps] = abs(float(found[1]) - np.cos(1)) if found else np.nan
        for degree, least, most in ((1, 1.8, 2.2), (3, 3.5, 6)):
            order = np.log2(errors["serial-implicit", degree, 4] / errors["serial-implicit", degree, 8])
            check(f"a circuit with degree {degree} is at least of order {degree + 1} in its sub-steps", least < order < most, f"{order:.2f}, error {errors['serial-implicit', degree, 8]:.1e}")
        both = errors["serial-implicit", 3, 8], errors["parallel-implicit", 3, 8]
        check("side by side the same", abs(both[0] - both[1]) < 1e-10, both)


def ranks():
    wanted = expected("serial-implicit", (2, 1), substeps=True)
    for left, right, coupler in ((3, 2, 2), (1, 3, 1)):
        off = apart(run("serial-implicit", steps=(2, 1), ranks={"Left": left, "Right": right, "coupler": coupler}), wanted)
        check(f"{left} and {right} processes, coupler on {coupler}: the same motion", off < 1e-9, f"{off:.1e}")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        imported(folder, configuration("serial-implicit"))
        done = launch(folder, {name: [*programs["c++"], name, file, 1] for name, file in (("Left", "case.yaml"), ("Right", "./case.yaml"))})
        check("programs find the configuration by the case", done.returncode == 0, done.stderr[-300:])
        words = {name: [*programs["c++"], name, "precice-config.xml", 1] for name in ("Left", "Right")}
        done = launch(folder, words, ranks={"Left": 2})
        check("rank and size of another communicator are refused", done.returncode != 0 and "was constructed as process 0 of 1, but is process" in done.stderr, done.stderr[-300:])


def separately():
    table = pathlib.Path("/proc/net/if_inet6")
    six = "tcp6:lo" if table.exists() and " lo\n" in table.read_text() else "unix"
    for ways, kinds, ranks in (({"Left": "unix", "Right": "tcp:lo"}, ("c++", "c++"), {"Left": 3, "Right": 2, "coupler": 2}), ({"Left": six, "Right": "tcp:lo"}, ("python", "c"), {"Left": 1, "Right": 1, "coupler": 1})):
        wanted = run("serial-implicit", *kinds, ranks=ranks if kinds[0] == "c++" else None)
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            imported(folder, configuration("serial-implicit"))
            words = {name: [*programs[kind], name, "precice-config.xml", 1, *(["parallel"] if kinds[0] == "c++" else [])] for name, kind in zip(("Left", "Right"), kinds)}
            codes, said = launch_separately(folder, words, ranks, ways)
            check(f"{kinds[0]} and {kinds[1]} on {ranks['Left']} and {ranks['Right']} processes, each launched separately: all end well", codes == [0, 0, 0], "" if not any(codes) else said)
            for name in words:
                found = motion(folder, name, ranks[name])
                check(f"{name}: the values of one launch, bit for bit", found.shape == wanted[name].shape and (found == wanted[name]).all(), f"{abs(found - wanted[name]).max():.1e}")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        imported(folder, configuration("serial-implicit"))
        words = {name: [*programs["c++"], name, "precice-config.xml", 1, "parallel"] for name in ("Left", "Right")}
        relays = {name: [build / "bin/relay", name, "--wait", "4"] for name in words}
        own = {name: value for name, value in environment.items() if not name.startswith(("OMPI_COMM", "PMIX_"))}
        guests = [subprocess.Popen(list(map(str, [*mpirun, "-n", n, *words[name]])), cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                   env={**own, "COUPLET_JOIN": f"{name}.relay"}) for name, n in (("Left", 2), ("Right", 1))]
        done = launch(folder, relays)
        said = [g.communicate(timeout=60)[0] for g in guests]
        check("another number of processes than the relay's is refused", done.returncode != 0 and "has 2 processes, but its relay has 1" in said[0], said[0][-300:])


MESHES = """<precice-configuration>
  <data:scalar name="Pressure" /> <data:vector name="Heat" /> <data:scalar name="Temperature" />
  <mesh name="Nodes" dimensions="2"><use-data name="Pressure" /><use-data name="Temperature" /></mesh>
  <mesh name="Centres" dimensions="2"><use-data name="Heat" /></mesh>
  <mesh name="Solid" dimensions="2"><use-data name="Pressure" /><use-data name="Temperature" /><use-data name="Heat" /></mesh>
  <participant name="Fluid">
    <provide-mesh name="Nodes" /> <provide-mesh name="Centres" /> <receive-mesh name="Solid" from="Solid" />
    <write-data name="Pressure" mesh="Nodes" /> <write-data name="Heat" mesh="Centres" /> <read-data name="Temperature" mesh="Nodes" />
    <mapping:KIND direction="read" from="Solid" to="Nodes" constraint="consistent" />
    <mapping:KIND direction="write" from="Centres" to="Solid" constraint="conservative" />
  </participant>
  <participant name="Solid">
    <provide-mesh name="Solid" /> <receive-mesh name="Nodes" from="Fluid" />
    <read-data name="Pressure" mesh="Solid" /> <read-data name="Heat" mesh="Solid" /> <write-data name="Temperature" mesh="Solid" />
    <mapping:KIND direction="read" from="Nodes" to="Solid" constraint="consistent" />
  </participant>
  <m2n:sockets acceptor="Fluid" connector="Solid" />
  <coupling-scheme:serial-explicit>
    <participants first="Fluid" second="Solid" /> <max-time-windows value="5" /> <time-window-size value="0.1" />
    <exchange data="Pressure" mesh="Nodes" from="Fluid" to="Solid" /> <exchange data="Heat" mesh="Solid" from="Fluid" to="Solid" />
    <exchange data="Temperature" mesh="Solid" from="Solid" to="Fluid" />
  </coupling-scheme:serial-explicit>
</precice-configuration>
"""


def meshes():
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        imported(folder, MESHES.replace("KIND", "nearest-neighbor"))
        for coupler in (1, 2):
            done = launch(folder, {name: [python, here / "meshes.py", name, "precice-config.xml"] for name in ("Fluid", "Solid")}, ranks={"coupler": coupler})
            check(f"two meshes in one place keep their data apart, coupler on {coupler}", done.returncode == 0 and done.stdout.count("has seen what it should") == 2, done.stderr[-800:])


AMOUNTS = """<precice-configuration>
  <data:vector name="Force" /> <data:scalar name="Place" />
  <mesh name="Left-Mesh" dimensions="DIM"><use-data name="Force" /><use-data name="Place" /></mesh>
  <mesh name="Right-Mesh" dimensions="DIM"><use-data name="Force" /><use-data name="Place" /></mesh>
  <participant name="Left"><provide-mesh name="Left-Mesh" /><receive-mesh name="Right-Mesh" from="Right" />
    <write-data name="Force" mesh="Left-Mesh" /><write-data name="Place" mesh="Left-Mesh" />
    <mapping:KIND direction="write" from="Left-Mesh" to="Right-Mesh" constraint="conservative" /></participant>
  <participant name="Right"><provide-mesh name="Right-Mesh" /><receive-mesh name="Left-Mesh" from="Left" />
    <read-data name="Force" mesh="Right-Mesh" /><read-data name="Place" mesh="Right-Mesh" />
    <mapping:KIND direction="read" from="Left-Mesh" to="Right-Mesh" constraint="consistent" /></participant>
  <m2n:sockets acceptor="Left" connector="Right" />
  <coupling-scheme:serial-explicit>
    <participants first="Left" second="Right" /><time-window-size value="1" /><max-time value="2" /><exchange data="Force" mesh="Right-Mesh" from="Left" to="Right" />
    <exchange data="Place" mesh="Left-Mesh" from="Left" to="Right" />
  </coupling-scheme:serial-explicit>
</precice-configuration>
"""
# The first controls and gets a datum for that alone, which it does not read.
CHAIN = """<precice-configuration>
  <data:scalar name="Left" /> <data:scalar name="Near" /> <data:scalar name="Far" /> <data:scalar name="Right" />
  <mesh name="Left-Mesh" dimensions="2"><use-data name="Left" /><use-data name="Near" /></mesh> <mesh name="Right-Mesh" dimensions="2"><use-data name="Right" /><use-data name="Far" /></mesh>
  <mesh name="Middle-Mesh" dimensions="2"><use-data name="Left" /><use-data name="Near" /><use-data name="Far" /><use-data name="Right" /></mesh>
  <participant name="Left"><provide-mesh name="Left-Mesh" /><receive-mesh name="Right-Mesh" from="Right" /><write-data name="Left" mesh="Left-Mesh" /><read-data name="Near" mesh="Left-Mesh" /></participant>
  <participant name="Middle"><provide-mesh name="Middle-Mesh" /><receive-mesh name="Left-Mesh" from="Left" /><receive-mesh name="Right-Mesh" from="Right" />
    <read-data name="Left" mesh="Middle-Mesh" /><write-data name="Near" mesh="Middle-Mesh" /><write-data name="Far" mesh="Middle-Mesh" /><read-data name="Right" mesh="Middle-Mesh" />
    <mapping:nearest-neighbor direction="read" from="Left-Mesh" to="Middle-Mesh" constraint="consistent" /><mapping:nearest-neighbor direction="write" from="Middle-Mesh" to="Left-Mesh" constraint="consistent" />
    <mapping:nearest-neighbor direction="read" from="Right-Mesh" to="Middle-Mesh" constraint="consistent" /><mapping:nearest-neighbor direction="write" from="Middle-Mesh" to="Right-Mesh" constraint="consistent" />
  </participant>
  <participant name="Right"><provide-mesh name="Right-Mesh" /><write-data name="Right" mesh="Right-Mesh" /><read-data name="Far" mesh="Right-Mesh" /></participant>
  <m2n:sockets acceptor="Left" connector="Middle" /><m2n:sockets acceptor="Middle" connector="Right" /><m2n:sockets acceptor="Left" connector="Right" />
  <coupling-scheme:multi>
    <participant name="Left" control="yes" /><participant name="Middle" /><participant name="Right" />
    <max-time value="3" /><time-window-size value="1" /><max-iterations value="60" />
    <exchange data="Left" mesh="Left-Mesh" from="Left" to="Middle" /><exchange data="Near" mesh="Left-Mesh" from="Middle" to="Left" />
    <exchange data="Far" mesh="Right-Mesh" from="Middle" to="Right" /><exchange data="Right" mesh="Right-Mesh" from="Right" to="Middle" /><exchange data="Right" mesh="Right-Mesh" from="Right" to="Left" />
    <relative-convergence-measure data="Near" mesh="Left-Mesh" limit="1e-9" /><relative-convergence-measure data="Right" mesh="Right-Mesh" limit="1e-9" />
  </coupling-scheme:multi>
</precice-configuration>
"""


def small(folder, text, case, number=0, people=("Left", "Right"), coupler=1):
    """What the programs of small.py print, by participant."""
    imported(folder, text)
    done = launch(folder, {name: [python, here / "small.py", case, name, "precice-config.xml", number] for name in people}, ranks={"coupler": coupler})
    check(f"{case} {number:g}: runs", done.returncode == 0, done.stderr[-800:])
    return {name: json.loads(rows) for name, rows in re.findall(r"(Left|Middle|Right) (\[\[.*?\}\]\])", done.stdout)}  # lines of two may be one


def answers():
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for scheme, windows, steps in (("serial-explicit", 3, "time"), ("serial-explicit", 1, "time"), ("serial-explicit", 1, "halves"), ("parallel-explicit", 3, "time"),
                                       ("serial-implicit", 2, "time"), ("parallel-implicit", 1, "time")):
            seen = small(folder, configuration(scheme, initialize="false", end=windows / 10), steps)
            off = max((abs(read[f"Displacement-{'Right' if me == 'Left' else 'Left'}"][0] - (10 if me == "Left" else 1) * t) for me, rows in seen.items() for t, _, read in rows), default=1)
            check(f"{scheme}, {windows} windows: after each of them the other's value at that time is read", off < 1e-12 and [len(rows) for rows in seen.values()] == [windows] * 2, (off, seen))
        found = []
        for stiffness in (1e3, 1e6, 1e9):
            text = configuration("parallel-implicit", initialize="false", end=0.3).replace('limit="1e-12"', 'limit="1e-9"')
            rows = small(folder, text, "springs", stiffness).get("Left", [])
            exact = 1000 / (1 + np.array([2, 1, 0.5]) * stiffness)
            found.append([passes for _, passes, _ in rows])
            off = max((np.abs(np.array(read["Displacement-Right"]) * (1 + np.array([2, 1, 0.5])) * stiffness / 1000 - 1).max() for _, _, read in rows), default=1)
            check(f"springs of {stiffness:g} N/m, side by side: exact", off < 1e-6, f"{off:.1e} in {found[-1]} passes")
        check("in as many passes whatever the units", found[0] and found.count(found[0]) == 3, found)
        for dim in (2, 3):
            for kind, faces in (("nearest-projection", ""), ("nearest-projection", "loose "), ("nearest-projection", "Left loose "), ("rbf-global-direct", ""), ("nearest-neighbor", "")):
                for coupler in (1, 2, 3):
                    seen = small(folder, AMOUNTS.replace("KIND", kind).replace("DIM", str(dim)), f"{faces}amounts", dim, coupler=coupler)
                    off = max((abs(read["Place"][i] - x) for me, rows in seen.items() for _, _, read in rows if me == "Right" for i, x in enumerate([0, 0.5, 1] * 3 ** (dim - 2))), default=1)
                    check("a field that is linear in the place arrives as it is", kind == "nearest-neighbor" or off < 1e-12, off)
                    taken = np.array(seen.get("Right", [[0, 0, {"Force": np.zeros((3 ** (dim - 1), dim))}]])[-1][2]["Force"])[:, 1].reshape(-1, 3)
                    moment = (taken * [0, 0.5, 1]).sum()
                    check(f"{kind} in {dim} dimensions, coupler on {coupler}: all forces arrive, but for nearest-neighbor with their moment", abs(taken.sum() - 5 ** (dim - 1)) < 1e-12 and
                          (kind == "nearest-neighbor" or abs(moment - 5 ** (dim - 1) / 2) < 1e-12), taken)
                    if kind == "nearest-projection" and not faces:
                        sides = np.array([1.5, 2, 1.5])
                        check("as projected by hand", np.abs(taken - sides if dim == 2 else taken.sum(axis=0) - 5 * sides).max() < 1e-12, taken)
        for text in (CHAIN, CHAIN.replace(' control="yes"', "").replace('<participant name="Middle" />', '<participant name="Middle" control="yes" />')):
            seen = small(folder, text, "chain", people=("Left", "Middle", "Right"))
            for t, _, read in seen.get("Middle", []):
                # Left, Near, Far, Right
                exact = np.linalg.solve([[1, -0.5, 0, 0], [0.4, 1, 0, -0.3], [-0.6, 0, 1, 0.2], [0, 0, -0.7, 1]], [t, 0, 0, 1])
                off = max(abs(read["Left"][0] - exact[0]), abs(read["Right"][0] - exact[3]))
                check(f"three in a row, the first or the second controls, at {t:g}: exact", off < 1e-7, f"{off:.1e}")
            check("three in a row: to the end", len(seen.get("Middle", [])) == 3, seen)


SAID = {"unknown participant": '"Middle" is not defined', "no configuration": '"none.xml" cannot be opened', "rank": "The process index is 1", "second participant": 'this process has been "Left"', "advance first": "initialize() has to be called",
        "read first": "cannot be called before initialize()", "unknown mesh": 'The mesh named "Mesh" is unknown', "received mesh": "does not provide the mesh", "coordinates": "2 coordinates and 6 ids",
        "no vertex": "the vertex id 0 is invalid", "edge": "the vertex id 0 is invalid", "twice in an edge": "occurs twice", "initial data": "Initial data has to be written",
        "initialize twice": "may only be called once", "mesh is locked": "is locked", "unknown data": 'The data "Force" is unknown', "data is read": "does not write the data",
        "data is written": "does not read the data", "sizes": "1 values where 6 vertices need 6", "id": "the vertex id 6 is invalid", "not finite": "not finite", "read time": "after the end of the time window",
        "negative read time": "negative", "step": "exceeds the maximum allowed time step size 0.1", "no step": "time step size of 0", "checkpoint": "A checkpoint must be written",
        "direct access": "not supported", "just-in-time": "just-in-time mapping", "gradients": "gradients of data", "resetMesh": "meshes that change"}


def wrong():
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        imported(folder, configuration("serial-implicit"))
        bad, good = [build / "bin/tests/precice_wrong_calls", "Left", "precice-config.xml"], [*programs["c++"], "Right", "precice-config.xml", 1]
        done = launch(folder, {"Left": bad, "Right": good})
        answers = dict(line.split(" | ", 1) for line in done.stdout.splitlines() if " | " in line)
        for call, text in SAID.items():
            check(f"wrong call '{call}' is refused", text in answers.get(call, ""), answers.get(call, "no answer"))
        check("no other call was tried", set(answers) == set(SAID), set(answers) ^ set(SAID))
        check("an error that nobody catches ends the job", done.returncode != 0 and "time step size of -1" in done.stderr, done.returncode)
        done = launch(folder, {"Left": [*bad, "leave"], "Right": good})
        check("a program that leaves early ends the job with its name", done.returncode != 0 and 'The participant "Left" ended before the coupling was over' in done.stderr, done.stderr[-300:])
        imported(folder, configuration("parallel-explicit", initialize="false"))
        for number, code, said in ((1, 0, ""), (0, 1, 'The participant "Left" ended before the coupling was over')):
            done = launch(folder, {name: [python, here / "small.py", "leave", name, "precice-config.xml", number] for name in ("Left", "Right")})
            check("programs that leave together end the job, one alone is an error", done.returncode == code and said in done.stdout + done.stderr, (done.returncode, done.stdout[-300:], done.stderr[-300:]))
        words = {name: [*programs["c++"], name, "precice-config.xml", 1] for name in ("Left", "Right")}
        imported(folder, configuration("serial-explicit"))
        case = folder / "case.yaml"
        case.write_text(re.sub(r"\n *digest: .*", "", case.read_text()))
        done = launch(folder, words, sets=["coupling.scheme=implicit"])
        check("a case that is not that of the configuration is refused", done.returncode != 0 and "repeat a step of explicit coupling" in done.stderr, done.stderr[-300:])
        edited(folder, words)
        ended(folder)


def ended(folder):
    """By a signal to one program, by a stop, and a case that asks for checkpoints."""
    imported(folder, configuration("serial-implicit", end=1e6))
    line = [sys.executable, "-m", "couplet", "run", "case.yaml", "--bin", build / "bin", *(w for n in ("Left", "Right") for w in ("--with", f"{n}={programs['c++'][0]} {n} precice-config.xml 1"))]
    surroundings = {**environment, "PYTHONPATH": str(project / "client/python")}
    for victim, number, said in (("Right", signal.SIGKILL, "'Right' was killed by signal 9"), ("run", signal.SIGINT, "No state was saved: 'Left', a program on preCICE's interface, writes no checkpoint")):
        process = subprocess.Popen(list(map(str, line)), cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=surroundings)
        for words in process.stdout:
            if "step 3 " in words:
                break
        found = [int(pid) for pid in os.listdir("/proc") if pid.isdigit() and words_of(pid)[:2] == [str(programs["c++"][0]), "Right"] and os.readlink(f"/proc/{pid}/cwd") == str(folder.resolve())]
        os.kill(found[0] if victim == "Right" else process.pid, number)
        out, told = process.communicate(timeout=30)
        check(f"{victim} killed by signal {number}: the reason is named, nothing to resume", process.returncode not in (0, 3) and said in told and "couplet resume" not in told, (process.returncode, told[-500:]))
    plain = [*mpirun, "-n", 1, build / "bin/coupler", "case.yaml", *(w for n in ("Left", "Right") for w in (":", "-n", 1, programs["c++"][0], n, "precice-config.xml", 1))]
    for attempt in range(3):  # the launcher may end before it has passed a program's last line on
        process = subprocess.Popen(list(map(str, plain)), cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
        for words in process.stdout:
            if "step 3 " in words:
                break
        victim = next(int(pid) for pid in os.listdir("/proc") if pid.isdigit() and words_of(pid)[:2] == [str(programs["c++"][0]), "Right"] and os.readlink(f"/proc/{pid}/cwd") == str(folder.resolve()))
        os.kill(victim, signal.SIGKILL)
        out, told = process.communicate(timeout=30)
        if "couplet:" in told:
            break
    check("a program that is killed is named without couplet run, too", process.returncode != 0 and f"participant 'Right' (pid {victim}) was killed or has ended unexpectedly" in told and
          "MPI_ERR" not in told, (process.returncode, told[-800:]))
    done = subprocess.run(list(map(str, [*line, "--set", "simulation.checkpoint.interval=1"])), cwd=folder, capture_output=True, text=True, env=surroundings, timeout=60)
    check("checkpoints are refused", done.returncode == 2 and "simulation.checkpoint.interval: 1 s here, but 'Left'" in done.stderr, done.stderr[-500:])
    pages = Pages()
    frame = b"-" * 74 + b"\n"
    text = b"a\n" + frame + b"mpirun noticed that process rank 2 with PID 7 on node n exited on\nsignal 9 (Killed).\n" + frame + frame + b"MPI_ABORT was invoked on rank 2\n" + frame + frame + b"of a program\n" + frame + b"unfinished"
    seen = b"".join(pages.feed(text[i:i + 1]) for i in range(len(text))) + pages.feed(b"", last=True)
    check("of mpirun's pages only its own are taken out", seen == b"a\n" + frame + b"of a program\n" + frame + b"unfinished", seen)
    check("and the process is found in them", culprit(pages.killed, [("coupler", 1), ("Left", 2)]) == "'Left', rank 1, was killed by signal 9 (Killed)", pages.killed)


def words_of(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/cmdline").read_text().split("\0")
    except OSError:
        return []


def edited(folder, words):
    """The configuration or the case changed after the import."""
    text, file = configuration("serial-implicit"), folder / "precice-config.xml"
    imported(folder, text)
    once = "".join(text.split("\n")[1:]).replace('first="Left" second="Right"', 'second = "Right"\n\tfirst= "Left"').replace("<!-- pairs of masses -->", "<!-- two --><!-- masses -->")
    file.write_text(once.replace("debug", "info").replace("m2n:sockets", "m2n:mpi"))
    done = launch(folder, words)
    check("comments, spaces, the order of attributes, logs and m2n may change", done.returncode == 0, done.stderr[-500:])
    refused = lambda done, said: (done.returncode == 2 and said in done.stdout + done.stderr, (done.returncode, done.stdout[-300:], done.stderr[-500:]))  # noqa: E731
    file.write_text(text.replace('<max-time value="1" />', '<max-time value="2" />'))
    done = launch(folder, words)
    check("another end in the configuration than in its case is refused", *refused(done, "reads a preCICE configuration that differs from the one this case was created from"))
    (folder / "other.xml").write_text(text)
    done = launch(folder, {**words, "Right": [*words["Right"][:2], "other.xml", 1]}, sets=["coupling.exchange.digest="])
    check("two programs with different configurations are refused", *refused(done, "'Left' and 'Right' read different preCICE configurations"))
    file.write_text(text)
    for key, said in (("coupling.scheme=explicit", "coupling.scheme: explicit here, but implicit"), ("coupling.exchange.order=parallel", "coupling.exchange.order: parallel here, but serial"),
                      ("coupling.exchange.participants=[Right, Left]", "coupling.exchange.participants: 'Right' before 'Left' here, but after it")):
        check(f"{key} against the configuration is refused", *refused(launch(folder, words, sets=[key]), said))


GOOD = configuration("serial-implicit", substeps="false")
BAD = {  # replaced, by what, what is said
    "direct access": ('from="Right" />\n    <write', 'from="Right" api-access="true" />\n    <write', ":11: <receive-mesh> with api-access (direct access to received meshes) is not supported"),
    "just-in-time mapping": ('from="Right-Mesh" to="Left-Mesh" constraint', 'from="Right-Mesh" constraint', "just-in-time mapping"),
    "remeshing": ("<precice-configuration", '<precice-configuration experimental="true" allow-remeshing="true"', "with allow-remeshing (meshes that change during the run) is not supported"),
    "actions": ("<m2n:sockets", '<action:summation /><m2n:sockets', "<action:summation> (actions on data) is not supported"),
    "gradients": ("mapping:nearest-neighbor direction", "mapping:nearest-neighbor-gradient direction", "mapping with gradients"),
    "scaled": ('constraint="consistent"', 'constraint="scaled-consistent-surface"', 'with constraint "scaled-consistent-surface" is not supported'),
    "another element": ("<m2n:sockets", "<shape><m2n:sockets", ":34: mismatched tag"),
    "an unknown element": ("<m2n:sockets", "<shape /><m2n:sockets", "<shape> is not known"),
    "version 2": ("precice-configuration", "solver-interface", "expected <precice-configuration> of preCICE version 3"),
    "no end": ('<max-time value="1" />', "", "neither <max-time> nor <max-time-windows>"),
    "a degree": ("<data:scalar name", '<data:scalar waveform-degree="-1" name', ':5: waveform-degree of "Displacement-Left" is "-1"; expected a whole number from 0 to 99'),
    "a degree without sub-steps": ('<data:scalar name="Displacement-Left" />', '<data:scalar name="Displacement-Left" waveform-degree="2" />', ':28: waveform-degree 2 of "Displacement-Left" needs its values at the sub-steps'),
    "a window without end": ('<time-window-size value="0.1" />', '<time-window-size value="1e999" />', "<time-window-size>: '1e999' is not a finite number"),
    "an end that is no number": ('<max-time value="1" />', '<max-time value="nan" />', "<max-time>: 'nan' is not a finite number"),
    "what only the coupler refuses": ('<initial-relaxation value="0.5"', '<initial-relaxation value="5"', "the coupler would refuse a case with this configuration:\ncase.yaml:"),
    "windows by the first": ('<time-window-size value="0.1" />', '<time-window-size value="-1" method="first-participant" />', '<time-window-size method="first-participant"> is not supported'),
    "data that are read and never exchanged": ('<exchange data="Displacement-Left"', '<exchange data="Displacement-Right"', "reads 'Displacement-Left', but no <exchange> delivers it"),
    "exchanged data without a name": ('<exchange data="Displacement-Left"', '<exchange data="Displacment"', "<exchange>: the data 'Displacment' is not one of: "),
    "an attribute that nobody knows": ('initialize="true"', 'initialise="true"', ":29: <exchange>: the attribute 'initialise' is not known, only: data, mesh, from, to, initialize, substeps."),
    "no iteration": ('<max-iterations value="50" />', '<max-iterations value="0" />', ":30: <max-iterations>: '0' is not supported; expected a whole number from 1 to 10000"),
    "a limit that is no number": ('limit="1e-12"', 'limit="small"', "<relative-convergence-measure>: the limit 'small' is not a number above 0"),
    "entities": ("<!-- pairs", '<!DOCTYPE a [<!ENTITY b "c">]><!-- pairs', "document types are not supported"),
}


def imports():
    environment["PYTHONPATH"] = str(project / "client/python")
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "precice-config.xml"
        ask = lambda *more: subprocess.run([python, "-m", "couplet", "import", file, *more], capture_output=True, text=True, env=environment)  # noqa: E731
        file.write_text(GOOD)
        done, case = ask(), file.with_suffix(".yaml")
        check("a case is written beside the configuration", done.returncode == 0 and case.exists(), done.stderr)
        valid = subprocess.run([build / "bin/coupler", case, "--check"], capture_output=True, text=True)
        check("the coupler finds it valid", valid.returncode == 0, valid.stderr[-500:])
        check("it is not written over", ask().returncode == 2)
        for name, (old, new, said) in BAD.items():
            file.write_text(GOOD.replace(old, new))
            done = ask("--force")
            check(f"{name}: refused with the line", GOOD != file.read_text() and done.returncode == 2 and said in done.stderr, done.stderr[-300:])
        measure = '<relative-convergence-measure limit="1e-12"'
        second = '<absolute-convergence-measure limit="1e-6" data="Displacement-Right" mesh="Right-Mesh" />'
        either = '<absolute-or-relative-convergence-measure abs-limit="1e-6" rel-limit="1e-12"'
        for text, wanted in ((GOOD, False), (GOOD.replace(measure, second + measure), True), (GOOD.replace(measure, either), False), (GOOD.replace(measure, second + either), True)):
            file.write_text(text)
            done = ask("--force")
            valid = subprocess.run([build / "bin/coupler", case, "--check"], capture_output=True, text=True)
            check("of two limits, the relative one decides", done.returncode == valid.returncode == 0 and ("the relative one applies" in done.stdout) == wanted, done.stderr + valid.stderr)
        file.write_text(GOOD.replace('<max-iterations value="50" />', ""))
        done = ask("--force")
        check("no limit of iterations is noted", done.returncode == 0 and "without max-iterations, a window ends after 10000 iterations" in done.stdout, done.stdout)
        file.write_text(GOOD.replace("IQN-ILS", "IQN-IMVJ"))
        done = ask("--force")
        check("IQN-IMVJ is taken as IQN-ILS, and noted", done.returncode == 0 and "IQN-ILS replaces IQN-IMVJ" in done.stdout and "iqn-ils" in case.read_text(), done.stdout)
        file.write_text(configuration("serial-implicit", degree=3))
        done = ask("--force")
        check("a higher degree is taken as it is", done.returncode == 0 and "waveform" not in done.stdout, done.stdout)


{"languages": languages, "schemes": schemes, "waveforms": waveforms, "ranks": ranks, "meshes": meshes, "wrong": wrong, "answers": answers, "import": imports, "separate": separately}[what]()
end()
