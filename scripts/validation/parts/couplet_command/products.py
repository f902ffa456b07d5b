# SPDX-License-Identifier: Apache-2.0
"""Measures of what is made of the project: packages, site, schema, gallery, and the lines of its scripts."""
import re
import subprocess

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
