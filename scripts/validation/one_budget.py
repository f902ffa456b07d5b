# SPDX-License-Identifier: Apache-2.0
"""Bars of the error budget, the predictions and the atlas. Built so far: other programs on a case by one command, pictures that can be
read, --for-error beside ladders of runs, the budget with the model in it, a flow
that a clock drives, the atlas."""
import csv
import re
import sys

from validation.job import Bar
from validation.parts import atlas
from validation.parts.prediction import rows as prediction
from validation.parts.trust.runs import tests

NOTE = ("Built so far: other programs on a case by one command, pictures that can be read, `--for-error`, the budget with the model in it, Womersley's flow, and the atlas. "
        "Quantities of interest have no rows yet.")
SOURCES = ("client/python/couplet/peers", "client/python/couplet/study", "configs/elliptic-plate", "configs/le1", "configs/cook", "configs/cavity", "configs/cylinder", "coupler")
FOAM = "solidDisplacementFoam"
# What of a study is run (--only: the sizes that a busy machine allows), its quantity, and the error that each program's best run has at most.
PEERS = {
    "plate B": ("elliptic-plate/case.yaml", "4-corrected-1e-8,8-corrected-1e-8,12-corrected-1e-8,16-corrected-1e-8", "displacement",
                {"CalculiX C3D8I": 0.02, "CalculiX C3D20R": 0.01, FOAM: 0.1}),
    "LE1": ("le1/case.yaml", "*", "stress at D", {"CalculiX CPS4": 0.03, "CalculiX C3D8I": 0.01, "CalculiX CPS8R": 0.001, FOAM: 0.01}),
    "Cook": ("cook/case.yaml", "4-*,8-*,16-*,32-*", "displacement of the corner",
             {"CalculiX CPE4": 0.05, "CalculiX C3D8I": 0.02, "CalculiX CPE8R": 0.005, FOAM: 0.1}),
    "cavity, Re 1000": ("cavity/study.yaml", "16-even,24-even,32-even", "u minimum", {"icoFoam": 0.3, "pimpleFoam": 0.3}),
    "2D-1": ("cylinder/study-2d-1.yaml", "8,12,16", "cd", {"icoFoam": 0.02, "pimpleFoam": 0.02}),
}


def beside(name):
    """One command on the case as it is; what was run before with the same programs and input is not run again."""
    file, only, quantity, wanted = PEERS[name]

    def measure(job):
        case = job.root / "configs" / file
        done = job.run([job.root / "scripts/study", case, "--peers", f"--only={only}", f"--build={job.build}"], timeout=7200)
        folder = case.parent / "out" / "study"
        if done.returncode != 0:
            return f"exit code {done.returncode}: {(done.stderr or done.stdout).strip()[-200:]}", False
        with open(folder / "peers.csv", newline="") as table:
            rows = [r for r in csv.DictReader(table) if not r["reason"]]
        head = f"error of {quantity}" if rows and f"error of {quantity}" in rows[0] else quantity
        parts, met = [], True
        for program, limit in wanted.items():
            best = min(((float(r[head]), float(r["processor [s]"])) for r in rows if re.fullmatch(rf"{re.escape(program)}(, .*)?", r["version"])), default=None)
            parts.append(f"{program} {100 * best[0]:.2g} % in {best[1]:.2g} s" if best else f"{program}: no run" + (
                " (not installed)" if "is not installed" in done.stdout else ""))
            met = met and best is not None and best[0] <= limit
        with open(folder / "runs.csv", newline="") as table:
            ours = [(float(r[head]), float(r["processor [s]"])) for r in csv.DictReader(table) if r[head]]
        text = (folder / "report.md").read_text()
        section = text[text.index(f"\n## {quantity}\n"):].split("\n![", 1)[0]
        front = [p for p in wanted if f"| {p}" in section]
        return f"{'; '.join(parts)}; ours {100 * min(ours)[0]:.2g} % in {min(ours)[1]:.2g} s; on the front: {', '.join(front) or 'ours alone'}", met
    return measure


def checks(script):
    def measure(job):
        done = job.run([sys.executable, job.root / "tests/cli/study" / script])
        good, bad = (len(re.findall(rf"^{word} ", done.stdout, re.M)) for word in ("ok", "FAILED"))
        left = re.findall(r"^skipped: (.*)$", done.stdout, re.M)
        return f"{good} checks, {bad} failed" + (f"; skipped: {'; '.join(left)}" if left else ""), done.returncode == 0 and good > 0 and not left
    return measure


BARS = [
    *(Bar(f"study --peers on {name}: one command from the case alone", ", ".join(f"{p} within {100 * e:g} %" for p, e in wanted.items()), beside(name), long=True)
      for name, (_, _, _, wanted) in PEERS.items()),
    Bar("couplet export: CalculiX input of LE1 runs, OpenFOAM patches and cells, refusals by the name of the key", "all pass", checks("peers.py")),
    Bar("pictures of studies: at most eight series in a panel, no word cut, processor seconds, other programs in the front", "all pass", checks("pictures.py")),
]
BARS += prediction.BARS


def scenes(job):
    """Each with a second run that has the effect, or a closed form (tests/cli/budget)."""
    done = job.run([sys.executable, job.root / "tests/cli/budget/run.py", job.build / "bin", job.root / "configs", "all"], 900)
    good, bad = (re.findall(rf"^{word} +(.*?):", done.stdout, re.M) for word in ("ok", "FAILED"))
    near = re.findall(r"^ok +.*share ([\d.e+-]+), truth ([\d.e+-]+) \(near\)", done.stdout, re.M)
    text = f"{len(good)} of {len(good) + len(bad)} name the right one{' (not: ' + '; '.join(bad) + ')' if bad else ''}; shares and truths "
    return text + ", ".join(f"{share} and {truth}" for share, truth in near), not bad and len(good) == 10 and len(near) >= 8


def periodic(job):
    done = job.run([sys.executable, job.root / "tests/cli/periodic/run.py", job.build / "bin", job.root / "configs", "4", "32", "100"], 3600)
    found = re.findall(r"^(ok|FAILED) +(alpha \d+, \d+ periods): step ([\d.e+-]+), truth ([\d.e+-]+)", done.stdout, re.M)
    return "; ".join(f"{name}: {step} for {truth}" for _, name, step, truth in found), len(found) == 6 and all(word == "ok" for word, *_ in found)


BARS.append(Bar("periodic flow (Womersley, alpha 3 and 10, 40 steps per period): the step's estimate over the truth at 4, 32, 100 periods", "within a factor of 3", periodic, long=True,
                but="2D-2 has no row yet: what drifts there is the phase"))
BARS.append(Bar("ten scenes with a known error of their model: the largest part of the budget, or what could be omitted, is the right one; its share", "10 of 10, 8 within a factor of 2",
                scenes, but="two of the ten are effects that do nothing and have no share, so all of the other 8 must be near"))
BARS.append(Bar("cause named first, a soft leaflet in water: explicit on five meshes, relaxation 1 with two schemes; a stable coupling whose mesh folds beside them",
                "7 of 7, and the neighbour's is the mesh", tests("^coupling_causes_long$")))
BARS += atlas.BARS
