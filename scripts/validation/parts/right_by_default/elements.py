# SPDX-License-Identifier: Apache-2.0
"""Beside CalculiX's quadratic tetrahedra (C3D10) at equal error, both in processor seconds of whole processes on one core; meshes are made before."""
import csv
import re
import shutil

import couplet
from couplet.peers import calculix
from couplet.peers.solid import Solid
from couplet.runs import Case
from couplet.runs.process import launch
from validation.parts.right_by_default.scenes import probe

S = "participants.solid."
TIP, FORK = -2.4535e-4, "tuning-fork"
TURNS, MODES, LONG = 3, 8, 10  # [s] of a run that is measured once
# Each from the coarsest.
BRACKET = {"ours": (0.01, 0.008, 0.006, 0.005, 0.0036, 0.0028, 0.0022), "C3D10": (0.02, 0.015, 0.012, 0.01)}
PRONGS = {"ours": (0.0025, 0.00175, 0.00125, 0.001), "C3D10": (0.005, 0.004, 0.0035, 0.003, 0.0025, 0.002)}
FINEST = 0.00125


def solid(job, case, h):
    """The case as CalculiX is given it; motion is no obstacle to modes."""
    data = Case(job.root / "configs" / case / "case.yaml").data
    section = data["participants"]["solid"]
    data = {**data, "participants": {"solid": {**section, "analysis": "static", "mesh-parameters": {"h": h}}}}
    return Solid(data, "solid", job.root / "configs" / case, job.scratch / "meshes", "CalculiX")


def written(job, case, h, step=None):
    """Folder with the input of the case, and the input; `step`: other lines in place of the static step."""
    def make():
        what, folder = calculix.Input(solid(job, case, h), "C3D10"), job.scratch / f"ccx-{case}-{h}"
        what.write(folder)
        if step:
            text = (folder / "case.inp").read_text()
            (folder / "case.inp").write_text(text[:text.index("*STEP")] + step)
        return folder, what
    return job.once(("ccx", case, h, step), make)


def median_of(run):
    """The median by processor seconds of TURNS runs, of one run where that is long; `run`: () -> (seconds, ...)"""
    runs = [run()]
    if runs[0][0] <= LONG:
        runs += [run() for _ in range(TURNS - 1)]
    return sorted(runs)[len(runs) // 2]


def calculix_seconds(folder):
    return median_of(lambda: (launch(["ccx", "case"], folder / "log", folder).cpu,))[0]


def our_run(job, case, h):
    return job.case_run(job.root / "configs" / case / "case.yaml", job.scratch / "ours", (f"{S}mesh-parameters={{h: {h}}}",), {"solid": 1}, 3600)


def our_seconds(job, case, h):
    """(whole process, of it before the first step and after the last: start-up, reading, writing)"""
    def once():
        run = our_run(job, case, h)
        steps = sum(float(x) for x in re.findall(r"^(?:begin_step|solve|accept_step)\s+([\d.]+)", run.log, re.M))
        return run.cost.cpu, run.cost.cpu * max(0, 1 - steps / run.cost.wall)
    return median_of(once)


def cheapest(meshes, error, limit):
    """(h, error) of the coarsest mesh that is within the limit as the next finer one is, if one is left."""
    found = None
    for h in meshes:
        e = error(h)
        if abs(e) > limit:
            found = None
        elif found:
            break
        else:
            found = h, e
    if found is None:
        raise LookupError(f"h = {h:g}, the finest of those tried, is {100 * abs(e):.2f} % off, limit {100 * limit:.2f} %")
    return found


def our_tip(job, h):
    return probe(our_run(job, "filleted-bracket", h), "tip y [m]") / TIP - 1


def their_tip(job, h):
    folder, what = written(job, "filleted-bracket", h)
    launch(["ccx", "case"], folder / "log", folder)
    what.read(folder, folder / "out" / "solid")
    return couplet.read_csv(folder / "out" / "solid" / "probes.csv")["tip y [m]"][-1] / TIP - 1


def installed(measure):
    def of(job):
        return measure(job) if shutil.which("ccx") else ("CalculiX is not installed", False)
    return of


@installed
def bracket(job):
    (h, mine), (k, theirs) = (cheapest(BRACKET[who], lambda x, f=f: f(job, x), 0.005) for who, f in (("ours", our_tip), ("C3D10", their_tip)))
    seconds, around = our_seconds(job, "filleted-bracket", h)
    other = calculix_seconds(written(job, "filleted-bracket", k)[0])
    return (f"h {h:g} {100 * mine:+.2f} % in {seconds:.2f} s, {around:.2f} s of it start-up, reading and writing; C3D10 h {k:g} {100 * theirs:+.2f} % in {other:.2f} s: "
            f"{seconds / other:.2f} times", seconds <= 2 * other)


STEP = f"*STEP\n*FREQUENCY\n{MODES}\n*END STEP\n"


def their_modes(job, h):
    folder, _ = written(job, FORK, h, STEP)
    launch(["ccx", "case"], folder / "log", folder)
    rows = re.findall(r"^\s+\d+\s+\S+E\S+\s+\S+E\S+\s+(\S+E\S+)\s+\S+E\S+\s*$", (folder / "case.dat").read_text(), re.M)
    return [float(f) for f in rows[:MODES]]


def our_modes(job, h):
    with open(our_run(job, FORK, h).folder / "solid" / "modes.csv", encoding="utf-8") as file:
        return [float(row[1]) for row in list(csv.reader(file))[1:]]


def worst(found, right):
    return max(abs(a / b - 1) for a, b in zip(found, right, strict=True))


@installed
def fork(job):
    right = job.once("fine fork", lambda: their_modes(job, FINEST))
    (h, mine), (k, theirs) = (cheapest(PRONGS[who], lambda x, f=f: worst(f(x), right), 0.02)
                              for who, f in (("ours", lambda x: our_modes(job, x)), ("C3D10", lambda x: their_modes(job, x))))
    mine_s, other = our_seconds(job, FORK, h)[0], calculix_seconds(written(job, FORK, k, STEP)[0])
    return (f"h {h:g} {100 * mine:.2f} % in {mine_s:.2f} s; C3D10 h {k:g} {100 * theirs:.2f} % in {other:.2f} s: {mine_s / other:.1f} times",
            mine_s <= 2 * other)
