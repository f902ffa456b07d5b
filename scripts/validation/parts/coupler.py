# SPDX-License-Identifier: Apache-2.0
"""The coupler: added mass, schemes, programs of others."""
import json
import re
import sys

import numpy as np

from couplet.runs.process import RunFailed

FLAP, TUBE = "perpendicular-flap", "tube-3d"


def string(job, pattern, wanted):
    """Numbers of tests/coupling/string/string.py (the finite-volume fluid under an elastic wall) by their claim; met if
    that many were found and none failed."""

    def make():
        file = job.scratch / "string.json"
        job.run(
            [
                sys.executable,
                job.root / "tests/coupling/string/string.py",
                job.build / "bin",
                job.build / "bin/tests",
                file,
            ],
            3600,
        )
        return json.loads(file.read_text())

    result = job.once("string", make)
    found = {k: v for k, v in result["numbers"].items() if re.search(pattern, k)}
    return "; ".join(f"{k}: {v:.5g}" for k, v in found.items()), len(found) >= wanted and not set(found) & set(
        result["failed"]
    )


# -- tubes ------------------------------------------------------------------------------------------------------------
def beside_the_job(job, case, script, *words):
    """Folder in which a case's own script ran."""

    def make():
        folder = job.scratch / "-".join((case, *words))
        folder.mkdir()
        job.environment["COUPLET_BIN"] = str(job.build / "bin")
        job.done(
            [job.root / "configs" / case / script, *words, f"--set=simulation.output.folder={folder / 'out'}"],
            3600,
            cwd=folder,
        )
        return folder

    return job.once((case, script, words), make)


def tube_1d(job):
    """Coupled pressure in the middle of the tube against the monolithic one, all 100 steps."""
    got = np.loadtxt(beside_the_job(job, "tube-1d", "run") / "tube.csv", delimiter=",")[:, 1]
    wanted = job.beside("configs/tube-1d/tube.py").monolithic()[:, 1]
    off = np.abs(got - wanted).max() / np.abs(wanted).max()
    return f"{off:.1e} of the largest pressure, {wanted.max():.2f} (preCICE's plot 223.5)", len(got) == 100 and bool(
        off < 1e-4
    )


def step(job):
    """Radial motion of A from 3 to 4 ms with steps of 0.1, 0.05 and 0.025 ms."""
    runs = [
        job.case(TUBE, (f"simulation.end-time={end} ms", f"simulation.time-step={dt} ms")).probes("solid")
        for dt, end in ((0.1, 8.5), (0.05, 4), (0.025, 4))
    ]
    t, most = runs[0]["time [s]"], runs[0]["A y [m]"].max()
    then = [at for at in t if 3e-3 - 1e-9 <= at <= 4e-3 + 1e-9]
    found = [np.array([run["A y [m]"][np.abs(run["time [s]"] - at).argmin()] for at in then]) for run in runs]
    gap = np.abs(found[0] - found[2]).max()
    first, second = (100 * np.sqrt(np.mean((a - b) ** 2)) / most for a, b in zip(found, found[1:]))
    return (
        (
            f"{100 * gap / most:.2f} % of the largest motion apart at most, {len(then)} times; root mean square of 0.1"
            f" to 0.05 ms {first:.2f} %, of 0.05 to 0.025 ms {second:.2f} %: order {np.log2(first / second):.2f}"
        ),
        len(then) == 11 and bool(gap <= 0.01 * most),
    )


# -- runs -------------------------------------------------------------------------------------------------------------
def refused(job, words, most, *keys):
    """A flap that cannot hold: it ends within so many steps (null: or not at all) with these words."""
    try:
        job.case(FLAP, ("simulation.end-time=0.6", *keys), timeout=600)
    except RunFailed as failure:
        steps, named = (
            len(failure.results.table("coupler", "balance.csv")["time [s]"]),
            words in (failure.results.folder / "run.log").read_text(),
        )
        return (
            f"{str(failure).split(':')[0]} after {steps} steps, {'named' if named else 'not named'}",
            "exit code 1:" in str(failure) and named and steps <= (most or steps),
        )
    return "the end is reached", most is None


def exchanged(job, kind, times):
    """A pass of two dummies with 1e5 vectors of three each way, without their own work, over MPI's own time; the best
    of three runs. On the machine where preCICE was measured MPI alone took 0.3117 ms (15.4 GB/s of messages of 2
    MiB)."""

    def make():
        dummies = job.beside("benchmarks/exchange/exchange.py")
        return [dummies.measure(100000, job.build / "bin") for _ in range(3)]

    runs = job.once("exchange", make)
    passes, ms = min((found[kind] for found, *_ in runs), key=lambda f: f[1])
    plain = min(p for _, p, _ in runs)
    return (
        (
            f"{ms:.2f} ms per pass, {passes:.1f} coupling iterations per step; MPI alone {plain:.2f} ms there and back:"
            f" {ms / plain:.1f} times"
        ),
        ms <= times * plain,
    )


def fenicsx(job):
    """Tip of the flap with DOLFINx's structure over solid_solver's, the same steps."""
    folder, end = job.scratch / "fenicsx", 0.2 if job.quick else 0.8
    folder.mkdir()
    options = [
        f"--set=simulation.end-time={end}",
        f"--set=simulation.output.folder={folder / 'out'}",
        "--set=participants.solid={program: flap_fenicsx}",
    ]
    job.done(
        [
            job.root / "scripts/couplet",
            "run",
            job.root / "configs" / FLAP,
            "--bin",
            job.build / "bin",
            *options,
            f"--with=solid=/usr/bin/python3 {job.root / 'client/examples/flap_fenicsx.py'} solid",
        ],
        3600,
        cwd=folder,
    )
    theirs = np.loadtxt(folder / "solid.csv", delimiter=",")[:, 1]
    ours = job.case(FLAP, (f"simulation.end-time={end}",)).probes("solid")["tip x [m]"]
    n = min(len(theirs), len(ours))
    gap = np.abs(theirs[:n] - ours[:n]).max() / np.abs(ours[:n]).max()
    return f"{100 * gap:.3f} % of the largest motion apart at most, to {end} s", bool(gap <= 0.03)
