# SPDX-License-Identifier: Apache-2.0
"""Measures of the modal plate: frequencies, coupling with a fluid."""
import re

import numpy as np

from couplet.runs import Results
from couplet.series import extrema

TABLE_4_1 = [30.57, 129.3, 319.7, 980.6, 1039, 1545, 2039, 2288, 2702, 3738, 3828, 3925, 4147, 5412, 5443]  # thesis, Hz


def reed(job):
    error = job.case("plate-reed").column("reed", "frequencies.csv", "frequency [Hz]") / np.array(TABLE_4_1) - 1
    rms, worst = np.sqrt(np.mean(error**2)), np.abs(error).max()
    return f"rms {100 * rms:.2f} %, worst {100 * worst:.2f} %", bool(rms <= 0.01 and worst <= 0.02)


# -- the plate in the flow --------------------------------------------------------------------------------------------
def thin_plate(job, structure):
    """Returns {what: number} of configs/thin-plate with 'plate' or 'solid': first maximum of the tip [m], frequency
    [Hz], seconds in the structure's solve."""

    def make():
        out = job.scratch / f"thin-plate-{structure}"
        job.environment["COUPLET_BIN"] = str(job.build / "bin")
        log = job.done(
            [job.root / "configs/thin-plate/run", structure, "--set", f"simulation.output.folder={out}"], 7200
        ).stdout
        probes = Results(out).probes("structure")
        (first, height), (second, _), *_ = [
            (t, v) for t, v, kind in extrema(probes["time [s]"], probes["tip x [m]"]) if kind == "max"
        ]
        solve = re.search(r"^solve\s+([\d.]+)\s", log[log.index("time of 'structure'") :], flags=re.M)[1]
        return {"maximum": height, "frequency": 1 / (second - first), "cost": float(solve)}

    return job.once(("thin-plate", structure), make)


def beside_solid(job, what, share=None, times=None):
    """Compares a result with that of solid_solver: within this share, or smaller by this factor."""
    a, b = (thin_plate(job, structure)[what] for structure in ("plate", "solid"))
    text = f"plate_modal {a:.5g}, solid_solver {b:.5g}: "
    return (
        (f"{text}{b / a:.0f} times", b / a >= times)
        if times
        else (f"{text}{100 * (a / b - 1):+.2f} %", abs(a / b - 1) <= share)
    )


def restarted(job, what):
    """Returns the output of tests/coupling/plate/restart.py for a coupled restart in the middle of a contact."""

    def make():
        result = job.run(
            [
                "/usr/bin/python3",
                job.root / "tests/coupling/plate/restart.py",
                "coupled",
                job.root / "configs",
                job.build / "bin",
            ]
        )
        if result.returncode != 0 and "apart by" not in result.stdout:
            raise RuntimeError((result.stdout + result.stderr).strip().splitlines()[-1])
        return result.stdout

    said = job.once("coupled-restart", make)
    if what == "energies":
        joules, share = re.search(r"mismatch of the energies (\S+) J, (\S+) % of the impact's", said).groups()
        return f"{joules} J, {share} % of the impact's", float(share) <= 1
    apart = max(map(float, re.findall(r"apart by (\S+) of", said)))
    return f"apart by {apart:.1e} of the largest value", apart == 0
