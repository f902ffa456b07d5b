# SPDX-License-Identifier: Apache-2.0
"""Bars of what is made of the project: packages, site, schema, gallery, and the lines of its scripts."""
import re
import subprocess

from validation.job import Bar
from validation.parts.trust.runs import tests

HOURS = 4 * 3600  # [s]
BEFORE = "a334ee1"  # the last commit with scripts/couplet_*
SAME_WORK_BEFORE = ("scripts/accuracy", "scripts/plot", "scripts/stability", "scripts/study", "scripts/couplet_optimise.py", "scripts/couplet_series.py",
                    "scripts/couplet_thermocline.py", "scripts/couplet_run", "scripts/couplet_study", "scripts/couplet_atlas")
SAME_WORK = ("series.py", "tank.py", "plot.py", "study", "atlas", *(f"runs/{name}.py" for name in ("__init__", "case", "process", "pool", "results", "task", "warnings")))
ADDED = ("fits.py", "series.py")  # of study/: --for-error with bounds of its fits, series compared by cost


def lines(job):
    """Of what studies, accuracy, atlas, plots and the runner were and are, without the schema of studies."""
    names = job.run(["git", "-C", job.root, "ls-tree", "-r", "--name-only", BEFORE, "--", *SAME_WORK_BEFORE], check=True).stdout.split()
    before = sum(job.run(["git", "-C", job.root, "show", f"{BEFORE}:{name}"], check=True).stdout.count("\n") for name in names)
    places = [job.root / "client/python/couplet" / name for name in SAME_WORK]
    files = [f for place in places for f in (place.rglob("*.py") if place.is_dir() else [place]) if f.name != "schema.py"]
    now = sum(f.read_text().count("\n") for f in files)
    added = sum((job.root / "client/python/couplet/study" / name).read_text().count("\n") for name in ADDED)
    return f"{now - added} lines, {before} before; not counted: {added} in {' and '.join(ADDED)}, for work that was not done before", now - added < before


def readmes(job):
    folders = [f.parent for f in sorted((job.root / "configs").glob("*/case.yaml"))]
    texts = {f.name: (f / "README.md").read_text() if (f / "README.md").exists() else "" for f in folders}
    pictures = sum(bool(re.search(r"!\[[^]]*\]\(", t)) for t in texts.values())
    commands = sum(re.search(r"^\s*(?:mpirun|build/bin/|couplet |scripts/|fluid_solver |configs/\S+/run)", t, flags=re.M) is not None for t in texts.values())
    return f"{len(texts)} cases, {pictures} with a picture, {commands} with a command", pictures == commands == len(texts)


def names_of_programs(job):
    """No program differs between its reference and the schema: scripts/docs finds nothing to write."""
    done = subprocess.run([job.root / "scripts/docs", "--check", "--bin", job.build / "bin"], capture_output=True, text=True)
    return (done.stdout + done.stderr).strip().splitlines()[-1][:200], done.returncode == 0


BARS = [
    Bar("cmake --install into a prefix that is moved, empty HOME", "command, programs, cases, man pages, completion, picture work", tests("^command_installed_prefix$")),
    Bar("cmake --install where nothing was built", "installs the command, which names what is missing", tests("^command_installed_empty$")),
    Bar("cpack's .deb by dpkg -x into an empty folder", "libraries of the system alone, no path of the build, first case runs", tests("^command_installed_deb$")),
    Bar(".deb by apt in a minimal Debian (debootstrap), a new user with an empty home: doctor, coupled case, pictures, import couplet, man, completion; purged",
        "all work; nothing is left", tests("^command_chroot_package_long$", seconds=HOURS), long=True),
    Bar("Containerfile, statement by statement in such a Debian, from the sources to the image's user", "each ends well; its package works",
        tests("^command_chroot_container_long$", seconds=HOURS), long=True),
    Bar("schema: all cases valid, wrong ones of the tests", "refused where a schema can", tests("^cases_schema_refuses_what_a_schema_can$")),
    Bar("schema and reference", "what the programs say", names_of_programs),
    Bar("site: all documents, gallery of all cases, search", "no dead link, nothing from elsewhere, no error in a headless browser", tests("^command_site$")),
    Bar("every command of the tutorials, in an empty folder with an empty HOME", "ends well, with a picture each", tests("^command_tutorial_", 8), long=True),
    Bar("couplet new of every case of the gallery", "a valid case in an empty folder", tests("^command_gallery$")),
    Bar("READMEs of configs/", "a picture and a command each", readmes),
    Bar("every command of the READMEs of configs/, in a copy with an empty HOME",
        "ends well (not as first asked: after 40 s a run is stopped by SIGTERM and must end with exit code 3, saved, a study by Ctrl-C)",
        tests("^command_readmes_", 4, HOURS), long=True),
    Bar("lines for the same work as scripts/ before", "fewer", lines),
]
