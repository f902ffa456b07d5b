# SPDX-License-Identifier: Apache-2.0
"""Bars of the modal plate: frequencies, statics, time, contact, energy, coupling with a fluid."""
import re
import shutil

import numpy as np

import couplet
from validation.job import Bar

SOURCES = ("plate_modal", "common/modes", "common/time", "configs/thin-plate", "configs/plate-reed", "configs/plate-drop",
           "tests/verification/plate")
TABLE_4_1 = [30.57, 129.3, 319.7, 980.6, 1039, 1545, 2039, 2288, 2702, 3738, 3828, 3925, 4147, 5412, 5443]  # thesis, Hz


# -- modes ------------------------------------------------------------------------------------------------------------
def frequencies(job, name):
    found, passed = job.recorded("verification_plate_frequencies", f"/{name}$", "worst")
    slope, _ = job.recorded("verification_plate_frequencies", f"/{name}$", "slope")
    return (f"worst {100 * found[0]:.3f} %, slope {slope[0]:.2f}",
            passed and found[0] <= 0.005 and slope[0] >= 1.8)


def reed(job):
    out, _ = job.solve("plate_modal", "plate-reed")
    rows = couplet.read_csv(out / "reed" / "frequencies.csv")
    error = rows["frequency [Hz]"] / np.array(TABLE_4_1) - 1
    rms, worst = np.sqrt(np.mean(error ** 2)), np.abs(error).max()
    return f"rms {100 * rms:.2f} %, worst {100 * worst:.2f} %", bool(rms <= 0.01 and worst <= 0.02)


def recorded(test, pattern, key, limit):
    def measure(job):
        values, passed = job.recorded(test, pattern, key)
        return f"{max(map(abs, values)):.2e}", passed and max(map(abs, values)) <= limit
    return measure


def passes(test, pattern, key=None, show="{}"):
    """A test holds itself to the bar; the number it recorded is shown."""
    def measure(job):
        tests, _ = job.gtest(test)
        chosen = {t: v for t, v in tests.items() if re.search(pattern, t)}
        if not chosen:
            raise LookupError(f"{test} has no test {pattern}")
        got = show.format(*[v[key] for v in chosen.values()]) if key else f"{len(chosen)} tests passed"
        passed = all(v["passed"] for v in chosen.values())
        return got if passed else f"{got}; a test failed", passed
    return measure


def ctest(pattern, least):
    def measure(job):
        passed, total, skipped, _ = job.ctest(pattern)
        return f"{passed} of {total} passed, {skipped} skipped", passed == total and total >= least
    return measure


# -- the plate in the flow --------------------------------------------------------------------------------------------
def thin_plate(job, structure):
    """Output folder and log of configs/thin-plate with 'plate' or 'solid'."""
    def make():
        out = job.scratch / f"thin-plate-{structure}"
        job.environment["COUPLET_BIN"] = str(job.build / "bin")
        result = job.run([job.root / "configs/thin-plate/run", structure, "--set", f"simulation.output.folder={out}"], 7200)
        if result.returncode != 0:
            raise RuntimeError(" / ".join((result.stderr.strip() or result.stdout.strip()).splitlines()[-3:]))
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


PLATES = (("clamped circle", "clamped_circle"), ("hinged circle", "simply_supported_circle"),
          ("clamped square", "clamped_square"), ("clamped square of quadrilaterals", "clamped_square_quadrilaterals"),
          ("hinged square", "simply_supported_square"), ("cantilever square", "cantilever_square"),
          ("free square", "free_square"))
FREQUENCIES, STATICS, DYNAMICS, CONTACT, FILE = ("verification_plate_frequencies", "verification_plate_statics",
                                                 "verification_plate_dynamics", "verification_plate_contact",
                                                 "verification_plate_modes_file")

def contact_costs_nothing(job):
    """Functions of the contact that callgrind sees in a run with a seat and in the same run without."""
    called = {}
    for name in ("with", "without"):
        folder = job.scratch / f"callgrind-{name}"
        folder.mkdir()
        text = (job.root / "tests/cli/wrong/plate.yaml").read_text()
        (folder / "case.yaml").write_text(text if name == "with" else re.sub(r".*contact:.*\n?", "", text))
        shutil.copy(job.root / "tests/cli/wrong/square.msh", folder)
        result = job.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=counts", job.build / "bin/plate_modal", "case.yaml"], cwd=folder)
        if result.returncode != 0:
            raise RuntimeError(result.stderr[-300:])
        called[name] = set(re.findall(r"couplet::plate::(Contact::\w+|seat_stiffness|Oscillators::solve_contact|PlateResults::write_contact)\(",
                                      (folder / "counts").read_text()))
    return f"{len(called['with'])} functions of the contact run with a seat, {len(called['without'])} without", \
        len(called["with"]) >= 5 and not called["without"]


BARS = [
    *[Bar(f"frequencies: {words}, 32 cells per side or rings, from 16", "worst <= 0.5 %, slope >= 1.8",
          lambda job, n=name: frequencies(job, n)) for words, name in PLATES],
    Bar("frequencies: reed, 15 modes against table 4.1", "rms <= 1 %, worst <= 2 %", reed),
    Bar("statics: constant curvature on distorted meshes, forces inside", "<= 1e-10 of the largest",
        recorded("verification_plate_patch", "leaves_no_force", "worst", 1e-10)),
    Bar("statics: constant curvature from its boundary values", "<= 1e-10",
        recorded("verification_plate_patch", "boundary_values", "worst", 1e-10)),
    *[Bar(f"statics: {name} under pressure", "<= 0.5 %", recorded(STATICS, "closed_forms_and", f"{name}-error", 0.005))
      for name in ("clamped-circle", "hinged-circle", "clamped-square", "hinged-square")],
    Bar("statics: plate of two thicknesses", "<= 0.5 %", recorded(STATICS, "two_thicknesses", "two-thicknesses", 0.005)),
    Bar("statics: plate of two thicknesses under its weight", "<= 0.5 %", recorded(STATICS, "two_thicknesses", "weight", 0.005)),
    Bar("statics: by 15 modes against direct", "<= 1 %", recorded(STATICS, "tends_to", "by-15", 0.01)),
    Bar("statics: by 120 modes against direct", "<= 0.01 %", recorded(STATICS, "tends_to", "by-120", 1e-4)),
    Bar("time: trapezoidal and Bathe, with and without damping", "order >= 1.9", passes(DYNAMICS, "second_order")),
    Bar("time: 15 modes against direct integration of the same plate", "<= 1 %",
        recorded(DYNAMICS, "fifteen", "apart", 0.01)),
    Bar("time: energy balances to rounding; Bathe's loss is seen", "1e-12; the audit reports it", passes(DYNAMICS, "balances")),
    Bar("contact: rebound speed, conserving rule, 7 steps a contact", "<= 1e-12",
        recorded(CONTACT, "rebound", "conserving", 1e-12)),
    Bar("contact: rebound speed, midpoint rule, order of its error", ">= 1.7",
        passes(CONTACT, "rebound", "midpoint-slope", "{}"), but="mean over 40 places of the impact within a step"),
    Bar("contact: penetration in an impact v sqrt(m/kappa), three kappa", "<= 2 %",
        recorded(CONTACT, "those_of_a_spring", "depth", 0.02)),
    Bar("contact: duration pi sqrt(m/kappa)", "<= 2 %", recorded(CONTACT, "those_of_a_spring", "duration", 0.02)),
    Bar("contact: penetration at rest is weight over kappa", "1e-6", passes(CONTACT, "at_rest_is_the_weight")),
    Bar("contact: growth of energy in 1000 bounces, 0.2 to 20 steps a contact", "<= 1e-9",
        recorded(CONTACT, "thousand", "growth", 1e-9)),
    Bar("contact: drift of the midpoint rule beside it, 3 steps a contact", "reported",
        lambda job: (f"{job.recorded(CONTACT, 'drift', 'drift')[0][0]:.3g} of the energy", None)),
    Bar("contact: mode on a seat at its rest position bounces at 2 f_1", "<= 1 %",
        lambda job: (lambda r: (f"{r[0][0]:.5f} of 2 f_1", r[1] and abs(r[0][0] - 1) <= 0.01))(
            job.recorded(CONTACT, "twice_its_frequency", "frequency-ratio"))),
    Bar("contact: 15 modes on a tilted seat, with and without a hole, energy", "1e-8", passes(CONTACT, "keeps_its_energy")),
    Bar("ranks: 1, 2, 3 agree", "1e-10; contract suite with and without a seat", ctest("^(contract_plate|verification_plate_modes_file)", 6)),
    Bar("modes on file: reused while mesh and data are the same; damaged ones refused", "tests pass", passes(FILE, "reused|wrong|of_its_mesh")),
    Bar("contact with the fluid attached: mismatch of the energies", "<= 1 % of the impact's energy", contact_in_flow),
    Bar("restart: alone, in the middle of a contact", "bit for bit", ctest("^coupling_plate_restart_alone", 1)),
    Bar("restart: coupled, in the middle of a contact", "bit for bit", restart_coupled),
    Bar("stability: 1000 bounces over five stiffnesses and four steps, conserving", "energy kept to 1e-8",
        recorded("stability_plate_contact", "Map", "conserving", 1e-8)),
    Bar("stability: the midpoint rule on the same map", "reported",
        lambda job: (f"up to {job.recorded('stability_plate_contact', 'Map', 'midpoint')[0][0]:.3g} times the energy made", None)),
    Bar("effects: damping and gravity off, no seat", "no allocation, no memory of theirs", passes("verification_plate_effects", "Effects")),
    Bar("effects: no instruction of the contact without a seat (callgrind)", "none", contact_costs_nothing),
    Bar("wrong configurations: exact messages", "pass", ctest("^cli_wrong_configurations$", 1)),
    Bar("thin plate in the flow: first maximum of the tip, plate_modal against solid_solver", "<= 3 %", tip_bar, long=True),
    Bar("thin plate in the flow: frequency", "<= 2 %", frequency_bar, long=True),
    Bar("thin plate in the flow: cost of the structure's solve", "plate_modal >= 20 times cheaper", cost_bar, long=True),
]
