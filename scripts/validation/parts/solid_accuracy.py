# SPDX-License-Identifier: Apache-2.0
"""Static solids: energy and limit loads, the bonded block of rubber, time to equal error beside quadratic tetrahedra of
CalculiX, and estimated errors beside the true ones."""
import math
import re
import shutil

import numpy as np

from couplet.peers import calculix
from couplet.peers.solid import Solid
from couplet.runs import Case
from couplet.runs.process import RunFailed, launch
from couplet.runs.pool import WARNING
from couplet.runs.results import Results


def quiet(text, right, run):
    """Returns the text of a row whose run must not warn, and whether it is right."""
    said = WARNING.findall(run.log)
    return f"{text}, {said[0] if said else 'no warning'}", right and not said


def strip(job):
    run = job.case("undamped-strip")
    energies = run.table("solid", "energies.csv")
    total = energies["kinetic [J]"] + energies["strain [J]"]
    worst = np.abs(total / total[0] - 1).max()
    return quiet(f"within {worst:.1e} of {total[0]:.0f} J", worst <= 1e-6, run)


def snap(job):
    """The first limit load [kN] in run.json, and what else the run has to say."""
    findings = job.case("lees-frame").findings()
    found = next(f["number"] for f in findings if f["id"] == "limit-load")
    worse = [f["id"] for f in findings if f["severity"] != "note"]
    error = found / 18.5 - 1
    return (
        f"{found:.4g} kN ({100 * error:+.2f} %), {', '.join(worse) or 'no warning'}",
        abs(error) <= 0.02 and not worse,
    )


# -- rubber -----------------------------------------------------------------------------------------------------------
HALF, NUMBER = 0.5, r"([-+.\de]+)"
FOLD = "the free surface has folded past the plane of the support"


def followed(job, n):
    """A block of n cells along each half, on its way to half its height: (share by which it is compressed at the end,
    last words or None, what a row shows)"""
    try:
        run, said, cause = (
            job.case(
                "rubber-block",
                (
                    "simulation.time-step=0.05",
                    f".mesh-parameters={{n: {n}}}",
                    f".boundaries.top.value=[0, -{HALF / 2}*t]",
                ),
            ),
            None,
            "no message",
        )
    except RunFailed as failure:
        run = failure.results
        said = re.findall(r"error: (.*)", (run.folder / "run.log").read_text())[-1]
        cell = re.search(rf"worst cell is at \({NUMBER}, {NUMBER}, {NUMBER}\)", said)
        named = FOLD in said and "End the load here" in said
        cause = (
            f"worst cell ({', '.join(cell.groups())}) m,"
            f" {'names the fold and the cure' if named else 'does not name the fold'}"
        )
    share = HALF * run.steps("solid")["time [s]"][-1]
    return share, said, f"{100 * share:.1f} %; {cause}"


def half(job, n):
    share, _, text = followed(job, n)
    return text, share >= HALF - 1e-9


def beside_elements(job):
    """64 across, and dolfinx with quadratic displacement and linear pressure on the same mesh."""
    share, said, text = followed(job, 64)
    python = shutil.which("python3", path="/usr/bin")
    if not python or job.run([python, "-c", "import dolfinx"]).returncode:
        return f"{text}; dolfinx is not installed", False
    found = job.run([python, job.root / "benchmarks/peers/dolfinx_block.py", "64"], timeout=3600).stdout
    theirs = float(re.search(rf"^64 {NUMBER}", found, re.M)[1])
    return f"{text}; dolfinx 0.5.2 {100 * theirs:.1f} %", share >= theirs and FOLD in (said or "")


# -- beside CalculiX --------------------------------------------------------------------------------------------------
TIP, FORK, BRACKET = -2.4535e-4, "tuning-fork", "filleted-bracket"
TURNS, LONG = 3, 10  # [s] of a run that is measured once
FINEST, MODES = 0.00125, 8
FREQUENCIES = f"*STEP\n*FREQUENCY\n{MODES}\n*END STEP\n"
SIZES = {  # from the coarsest: ours, C3D10
    BRACKET: ((0.01, 0.008, 0.006, 0.005, 0.0036, 0.0028, 0.0022), (0.02, 0.015, 0.012, 0.01)),
    FORK: ((0.0025, 0.00175, 0.00125, 0.001), (0.005, 0.004, 0.0035, 0.003, 0.0025, 0.002)),
}


def ours(job, case, h):
    """A run of its own, so that it can be timed again."""
    return job.case_run(
        job.root / "configs" / case / "case.yaml",
        job.scratch / "ours",
        (f"participants.solid.mesh-parameters={{h: {h}}}",),
        {"solid": 1},
        3600,
    )


def theirs(job, case, h):
    """Returns the folder with CalculiX's input and output for the case, and the input. Cases in motion are allowed for
    modes."""

    def make():
        data = Case(job.root / "configs" / case / "case.yaml").data
        section = {**data["participants"]["solid"], "analysis": "static", "mesh-parameters": {"h": h}}
        solid = Solid(
            {**data, "participants": {"solid": section}},
            "solid",
            job.root / "configs" / case,
            job.scratch / "meshes",
            "CalculiX",
        )
        what, folder = calculix.Input(solid, "C3D10"), job.scratch / f"ccx-{case}-{h}"
        what.write(folder)
        if case == FORK:
            text = (folder / "case.inp").read_text()
            (folder / "case.inp").write_text(text[: text.index("*STEP")] + FREQUENCIES)
        launch(["ccx", "case"], folder / "log", folder)
        return folder, what

    return job.once(("ccx", case, h), make)


def median_of(run):
    """The median by processor seconds of TURNS runs, of one run where that is long; `run`: () -> (seconds, ...)"""
    runs = [run()]
    if runs[0][0] <= LONG:
        runs += [run() for _ in range(TURNS - 1)]
    return sorted(runs)[len(runs) // 2]


def our_seconds(job, case, h):
    """Returns (whole process, of it before the first step and after the last: start-up, reading, writing)"""

    def once():
        run = ours(job, case, h)
        steps = sum(float(x) for x in re.findall(r"^(?:begin_step|solve|accept_step)\s+([\d.]+)", run.log, re.M))
        return run.cost.cpu, run.cost.cpu * max(0, 1 - steps / run.cost.wall)

    return median_of(once)


def cheapest(meshes, error, limit):
    """Returns (h, error) of the coarsest mesh that is within the limit as the next finer one is, if one is left."""
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
        raise LookupError(
            f"h = {h:g}, the finest of those tried, is {100 * abs(e):.2f} % off, limit {100 * limit:.2f} %"
        )
    return found


def tip_error(run):
    return run.last("solid", "probes.csv")["tip y [m]"] / TIP - 1


def their_tip_error(job, h):
    folder, what = theirs(job, BRACKET, h)
    what.read(folder, folder / "out/solid")
    return tip_error(Results(folder / "out"))


def their_modes(job, h):
    rows = re.findall(
        r"^\s+\d+\s+\S+E\S+\s+\S+E\S+\s+(\S+E\S+)\s+\S+E\S+\s*$",
        (theirs(job, FORK, h)[0] / "case.dat").read_text(),
        re.M,
    )
    return np.array(rows[:MODES], float)


def mode_error(job, modes):
    return np.abs(modes / their_modes(job, FINEST) - 1).max()


def seconds(job, case):
    """Processor seconds on the cheapest meshes whose tip (bracket) or modes (fork) are right."""
    if not shutil.which("ccx"):
        return "CalculiX is not installed", False
    if case == BRACKET:
        limit, mine, other = 0.005, lambda h: tip_error(ours(job, case, h)), lambda h: their_tip_error(job, h)
    else:
        limit, mine, other = (
            0.02,
            lambda h: mode_error(job, list(ours(job, case, h).table("solid", "modes.csv").values())[1]),
            lambda h: mode_error(job, their_modes(job, h)),
        )
    (h, error), (k, their_error) = (cheapest(sizes, off, limit) for sizes, off in zip(SIZES[case], (mine, other)))
    took, around = our_seconds(job, case, h)
    folder = theirs(job, case, k)[0]
    they = median_of(lambda: (launch(["ccx", "case"], folder / "log", folder).cpu,))[0]
    return (
        (
            f"h {h:g} {100 * error:+.2f} % in {took:.2f} s, {around:.2f} s of it start-up, reading and writing; C3D10 h"
            f" {k:g} {100 * their_error:+.2f} % in {they:.2f} s: {took / they:.2f} times"
        ),
        took <= 2 * they,
    )


# -- estimates --------------------------------------------------------------------------------------------------------
def moved(job, case, column, mesh, keys):
    """Returns (displacement at the probe, estimate of its error: what mesh, steps and solvers leave, without what
    neglected effects change)"""
    run = job.case(case, (f".mesh-parameters={{{mesh}}}", *keys))
    parts = run.report("solid")["errors"]
    return next(v for name, v in run.last("solid", "probes.csv").items() if name.startswith(column)), sum(
        parts[k] or 0 for k in ("mesh", "step", "linear")
    )


def stress(job, case, mesh, keys, place):
    """Returns (xx, yy, zz and sqrt 2 times xy, yz, xz [Pa]; estimated error over their norm)"""
    run = job.case(
        case, (f".mesh-parameters={{{mesh}}}", f".probes.surface={{point: {list(place)}, fields: [stress]}}", *keys)
    )
    parts = {
        name[len("surface stress-") :]: value
        for name, value in run.last("solid", "probes.csv").items()
        if name.startswith("surface stress-")
    }
    told = next(f["number"] for f in run.findings() if f["id"] == "stress-error" and "'surface'" in f["sentence"])
    return [value * (1 if name[0] == name[1] else math.sqrt(2)) for name, value in parts.items()], told


def ratios(job, what, bodies):
    """Returns [(estimated over true error, case and mesh)] of the displacements or the stresses. `bodies`: [(case,
    displacement, meshes, the fine one, where the stress is read: surfaces, none where it is singular; further keys)]"""

    def make():
        found = []
        for case, column, meshes, fine, places, keys in bodies:
            for place in places if what == "stress" else (None,):
                look = (
                    (lambda mesh: stress(job, case, mesh, keys, place))
                    if place
                    else (lambda mesh: moved(job, case, column, mesh, keys))
                )
                right = look(fine)[0]
                for mesh in meshes:
                    value, told = look(mesh)
                    share = (
                        (told or 0) * math.hypot(*right) / math.dist(value, right)
                        if place
                        else told / abs(value / right - 1)
                    )
                    found.append((share, f"{case} {{{mesh}}}"))
        return found

    return job.once(("estimates beside errors", what), make)


def within(job, what, factor, bodies, wanted=0.8):
    found = ratios(job, what, bodies)
    inside = sum(1 / factor <= r <= factor for r, _ in found)
    (small, where), large = min(found), max(found)[0]
    return (
        (
            f"{inside} of {len(found)}, {100 * inside / len(found):.0f} %; least {small:.2f} ({where}), largest"
            f" {large:.0f}"
        ),
        inside >= wanted * len(found),
    )


def least(job, what, bodies):
    found = ratios(job, what, bodies)
    (ratio, where), large = min(found), max(found)[0]
    return f"least {ratio:.2f} ({where}), largest {large:.0f}", ratio >= 1 / 3
