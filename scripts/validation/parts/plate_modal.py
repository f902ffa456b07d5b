# SPDX-License-Identifier: Apache-2.0
"""Measures of the modal plate: frequencies, statics, time, contact, energy, coupling with a fluid."""
import re

import numpy as np

import couplet

TABLE_4_1 = [30.57, 129.3, 319.7, 980.6, 1039, 1545, 2039, 2288, 2702, 3738, 3828, 3925, 4147, 5412, 5443]  # thesis, Hz


# -- modes ------------------------------------------------------------------------------------------------------------
def reed(job):
    out = job.case("plate-reed").folder
    rows = couplet.read_csv(out / "reed" / "frequencies.csv")
    error = rows["frequency [Hz]"] / np.array(TABLE_4_1) - 1
    rms, worst = np.sqrt(np.mean(error ** 2)), np.abs(error).max()
    return f"rms {100 * rms:.2f} %, worst {100 * worst:.2f} %", bool(rms <= 0.01 and worst <= 0.02)


# -- the plate in the flow --------------------------------------------------------------------------------------------
def thin_plate(job, structure):
    """Output folder and log of configs/thin-plate with 'plate' or 'solid'."""
    def make():
        out = job.scratch / f"thin-plate-{structure}"
        job.environment["COUPLET_BIN"] = str(job.build / "bin")
        result = job.done([job.root / "configs/thin-plate/run", structure, "--set", f"simulation.output.folder={out}"], 7200)
        return out, result.stdout
    return job.once(("thin-plate", structure), make)


def tip(job, structure):
    out, _ = thin_plate(job, structure)
    rows = couplet.read_csv(out / "structure" / "probes.csv")
    return rows["time [s]"], rows["tip x [m]"]


def swing(job, structure):
    """Mean of the first maximum and the following minimum, amplitude, period [m, m, s]."""
    time, x = tip(job, structure)
    found = couplet.extrema(time, x)
    tops = [(t, v) for t, v, kind in found if kind == "max"]
    return tops[0][1], tops[1][0] - tops[0][0]


def tip_bar(job):
    (a, _), (b, _) = swing(job, "plate"), swing(job, "solid")
    return f"plate_modal {a:.5f} m, solid_solver {b:.5f} m: {100 * (a / b - 1):+.2f} %", abs(a / b - 1) <= 0.03


def frequency_bar(job):
    (_, a), (_, b) = swing(job, "plate"), swing(job, "solid")
    return f"plate_modal {1 / a:.4f} Hz, solid_solver {1 / b:.4f} Hz: {100 * (b / a - 1):+.2f} %", abs(b / a - 1) <= 0.02


def seconds_of(log, name):
    """Seconds in 'solve' of a participant's closing table."""
    part = log[log.index(f"time of '{name}'"):]
    return float(re.search(r"^solve\s+([\d.]+)\s", part, flags=re.M).group(1))


def cost_bar(job):
    a, b = (seconds_of(thin_plate(job, p)[1], "structure") for p in ("plate", "solid"))
    return f"solve: plate_modal {a:.3f} s, solid_solver {b:.2f} s: {b / a:.0f} times", b / a >= 20


def coupled_restart(job):
    def make():
        result = job.run(["/usr/bin/python3", job.root / "tests/coupling/plate/restart.py", "coupled", job.root / "configs",
                          job.build / "bin"])
        if result.returncode != 0 and "apart by" not in result.stdout:
            raise RuntimeError((result.stdout + result.stderr).strip().splitlines()[-1])
        return result.stdout
    return job.once("coupled-restart", make)


def contact_in_flow(job):
    share = re.search(r"mismatch of the energies (\S+) J, (\S+) % of the impact's", coupled_restart(job))
    return f"{share.group(1)} J, {share.group(2)} % of the impact's", float(share.group(2)) <= 1


def restart_coupled(job):
    apart = max(map(float, re.findall(r"apart by (\S+) of", coupled_restart(job))))
    return f"apart by {apart:.1e} of the largest value", apart == 0
