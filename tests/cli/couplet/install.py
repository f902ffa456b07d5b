# SPDX-License-Identifier: Apache-2.0
"""What is installed works by itself. Usage: install.py BUILD [prefix | empty | deb | pip]: from a prefix that is moved, with an empty HOME; a
build in which nothing was built; the unpacked .deb; the Python package by pip, beside the programs of BUILD."""

import gzip
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from scene import ROOT
from checks import check, end  # noqa: E402

build, what = pathlib.Path(sys.argv[1]), sys.argv[2]


def run(prefix, home, *words, shell=None):
    env = {"HOME": str(home), "PATH": f"{prefix / 'bin'}:/usr/bin:/bin", "LANG": "C.UTF-8", "MANPATH": str(prefix / "share/man")}
    line = [shell, "-c", words[0]] if shell else [str(w) for w in words]
    return subprocess.run(line, capture_output=True, text=True, env=env, cwd=home)


def works(prefix, home):
    """The first minutes of a new user, from the installed files alone."""
    said = run(prefix, home, "couplet", "--version")
    check("couplet is there", said.returncode == 0 and re.match(r"couplet \d+\.\d+", said.stdout), said.stderr)
    cited = re.search(r"^version: (\S+)", (prefix / "share/doc/couplet/CITATION.cff").read_text(), flags=re.M)[1]
    told = {said.stdout.strip(), run(prefix, home, "fluid_solver", "--version").stdout.strip(), f"couplet {cited}"}
    newest = re.search(r"^## (\d+\.\d+\.\d+)", (prefix / "share/couplet/CHANGELOG.md").read_text(), flags=re.M)[1]
    check("one version: command, programs, citation, release notes", told == {f"couplet {newest}"}, (told, newest))
    dangling = [str(f.relative_to(prefix)) for f in (prefix / "share").rglob("*") if f.is_symlink() and not f.exists()]
    check("each link leads to an installed file", not dangling, dangling)
    doctor = run(prefix, home, "couplet", "doctor")
    check("the doctor's self-test", doctor.returncode == 0 and "ok  self-test" in doctor.stdout, doctor.stdout + doctor.stderr)
    for words in (["gallery"], ["new", "mine", "--from", "cavity", "--end-time", "0.05 s"], ["check", "mine"], ["run", "mine", "-q"], ["plot", "mine/out"]):
        said = run(prefix, home, "couplet", *words)
        check("couplet " + " ".join(words), said.returncode == 0, said.stdout + said.stderr)
    check("with its picture", any((home / "mine/out").rglob("*.png")))
    read = run(prefix, home, "/usr/bin/python3", "-c", f"import sys; sys.path.append('{prefix}/lib/python3/dist-packages'); import couplet; print(couplet.Results('mine/out').fields('fluid').field(-1, 'velocity').shape)")
    check("import couplet reads it", read.returncode == 0 and read.stdout.startswith("("), read.stderr)


def pages(prefix, home):
    files = {f.name.removesuffix(".gz"): f for f in sorted((prefix / "share/man/man1").iterdir())}
    check("a man page for each program and command", {"couplet.1", "couplet-run.1", "couplet-watch.1", "fluid_solver.1", "coupler.1"} <= set(files), files)
    for name, file in files.items():
        text = gzip.decompress(file.read_bytes()) if file.suffix == ".gz" else file.read_bytes()
        said = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-z"], input=text, capture_output=True)
        said.stderr = said.stderr.decode()
        check(f"{name} is set without a warning", said.returncode == 0 and not [w for w in said.stderr.splitlines() if "adjust" not in w and "break" not in w], said.stderr[:300])
    said = run(prefix, home, "man", "couplet-run") if shutil.which("man") else None
    check("man couplet-run", said is None or "--slurm" in said.stdout, said and said.stderr)
    script = (f"source {prefix}/share/bash-completion/completions/couplet; COMP_CWORD={{0}}; COMP_WORDS=({{1}}); _couplet; echo ${{{{COMPREPLY[*]}}}}")
    for words, number, wanted in (("couplet res", 1, "resume"), ("couplet run --sl", 2, "--slurm"), ("couplet new x --from perpendicular-", 4, "perpendicular-flap")):
        said = run(prefix, home, script.format(number, words), shell="bash")
        check(f"bash completes '{words}'", said.stdout.strip() == wanted, said.stdout + said.stderr)
    if shutil.which("zsh"):
        said = run(prefix, home, f"autoload -Uz compinit; compinit -u -D; fpath=({prefix}/share/zsh/site-functions {prefix}/share/zsh/vendor-completions $fpath); autoload -Uz _couplet; "
                   "whence -w _couplet; functions _couplet > /dev/null; autoload +X _couplet && echo read", shell="zsh")
        check("zsh reads its completion", "function" in said.stdout and "read" in said.stdout, said.stdout + said.stderr)


def prefix(folder, home):
    subprocess.run(["cmake", "--install", build, "--prefix", folder / "first"], check=True, capture_output=True)
    (folder / "first").rename(folder / "moved")
    works(folder / "moved", home)
    pages(folder / "moved", home)


def empty(folder, home):
    """Nothing was built: the command is installed all the same, and says what is missing."""
    subprocess.run(["cmake", "-S", ROOT, "-B", folder / "build", "-DCOUPLET_TESTS=OFF"], check=True, capture_output=True)
    said = subprocess.run(["cmake", "--install", folder / "build", "--prefix", folder / "prefix"], capture_output=True, text=True)
    check("cmake --install after any build", said.returncode == 0 and said.stderr.count("CMake Warning") == said.stderr.count("scripts/build release couplet_client precice_couplet") == 2, said.stderr)
    doctor = run(folder / "prefix", home, "couplet", "doctor", "--quick")
    check("the doctor names what is missing", doctor.returncode == 1 and "NO  coupler" in doctor.stdout, doctor.stdout + doctor.stderr)
    wrong = run(folder / "prefix", home, "couplet", "run", folder / "prefix/share/couplet/configs/cavity")
    check("run names the program that is missing", wrong.returncode == 2 and "'fluid_solver' of 'fluid' is not in" in wrong.stderr, wrong.stderr)


def deb(folder, home):
    """Into an empty folder: every library is one of the system's, and no file names the place where it was built."""
    subprocess.run(["cpack", "-B", folder / "deb"], cwd=build, check=True, capture_output=True)
    package = next((folder / "deb").glob("couplet_*.deb"))
    subprocess.run(["dpkg", "-x", package, folder / "root"], check=True)
    root = folder / "root/usr"
    for program in sorted((root / "bin").iterdir()):
        if program.name not in ("couplet", "couplet-exec"):
            libraries = subprocess.run(["ldd", program], capture_output=True, text=True).stdout
            check(f"libraries of {program.name}", "not found" not in libraries and str(build) not in libraries and "libmpi" in libraries, libraries[:200])
    petsc = {p for p in ("coupler", "thermocline", "mesh_tool", "fluid_solver", "solid_solver") if "libpetsc" in subprocess.run(["ldd", root / "bin" / p], capture_output=True, text=True).stdout}
    check("programs that solve are linked to PETSc, and no others", petsc == {"fluid_solver", "solid_solver"}, petsc)
    needs = subprocess.run(["dpkg-deb", "-f", package, "Depends"], capture_output=True, text=True).stdout
    check("the package names them", "libpetsc" in needs and "libslepc" in needs, needs)
    named = [f for f in root.rglob("*") if f.is_file() and str(build).encode() in f.read_bytes()]
    check("no file names the place where it was built", not named, named)
    outside = [f for f in (folder / "root").rglob("*") if f.is_file() and f.relative_to(root).parts[0] not in ("bin", "share", "lib", "include")]
    check("files lie where the conventions want them", not outside, outside)
    works(root, home)
    pages(root, home)


def pip(folder, home):
    """pip install client/python, without the network: the package reads results and finds the programs, cases and its version."""
    if subprocess.run(["/usr/bin/python3", "-c", "import ensurepip, wheel, setuptools"], capture_output=True).returncode:
        print("skipped: no pip here (Debian: python3-venv, python3-setuptools, python3-wheel)")
        sys.exit(77)
    shutil.copytree(ROOT / "client/python", folder / "python", ignore=shutil.ignore_patterns("__pycache__", "build", "*.egg-info"))
    subprocess.run(["/usr/bin/python3", "-m", "venv", "--system-site-packages", folder / "venv"], check=True, capture_output=True)
    said = subprocess.run([folder / "venv/bin/pip", "install", "--no-index", "--no-build-isolation", folder / "python"], capture_output=True, text=True)
    check("pip install client/python", said.returncode == 0, said.stdout + said.stderr)

    def run_here(*words):
        env = {"HOME": str(home), "PATH": f"{folder / 'venv/bin'}:{build / 'bin'}:/usr/bin:/bin", "LANG": "C.UTF-8"}
        return subprocess.run([folder / "venv/bin" / words[0], *words[1:]], capture_output=True, text=True, env=env, cwd=home)

    there = re.search(r"project\(couplet VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    said = run_here("couplet", "--version")
    check("the version of the project", said.stdout == f"couplet {there}\n", said.stdout + said.stderr)
    for words in (["new", "mine", "--from", "cavity", "--end-time", "0.05 s"], ["check", "mine"], ["run", "mine", "-q"]):
        said = run_here("couplet", *words)
        check("couplet " + " ".join(words), said.returncode == 0, said.stdout + said.stderr)
    read = run_here("python3", "-c", "import couplet; print(couplet.__file__, couplet.Results('mine/out').fields('fluid').field(-1, 'velocity').shape)")
    check("import couplet reads it", read.stdout.startswith(str(folder / "venv")) and read.stdout.endswith(", 3)\n"), read.stdout + read.stderr)


with tempfile.TemporaryDirectory(prefix="couplet-install-") as scratch:
    (pathlib.Path(scratch) / "home").mkdir()
    {"prefix": prefix, "empty": empty, "deb": deb, "pip": pip}[what](pathlib.Path(scratch), pathlib.Path(scratch) / "home")
end()
