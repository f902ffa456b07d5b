#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A plate that is stopped in the middle of a contact and continued gives the same bytes as one that was not stopped, alone and with
a fluid in three dimensions.
Usage: restart.py alone|coupled CONFIGS BIN"""
import csv
import pathlib
import shutil
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import mpmd, said  # noqa: E402

KIND, CONFIGS, BIN = sys.argv[1], *map(pathlib.Path, sys.argv[2:4])
SEAT = "{height: -0.0202, direction: [-1, 0, 0], stiffness: 1e5}"
CASES = {
    # The sheet meets its seat at about 31 ms.
    "alone": ("plate-drop", ["plate_modal"], "sheet",
              ["simulation.time-step=1e-3", "simulation.end-time=0.04", "simulation.checkpoint={interval: 1e-3, keep: 100}",
               "simulation.output.interval=0", "participants.sheet.modes.number=12",
               "participants.sheet.contact.scale=1e-8"]),
    "coupled": ("thin-plate", ["coupler", "fluid_solver", "plate_modal", "mesh_mover"], "structure",
                ["simulation.end-time=0.16", "simulation.checkpoint={interval: 0.02, keep: 100}",
                 "simulation.output.interval=0", "participants.fluid.mesh-parameters={n: 4, growth: 1.6}",
                 "participants.mover.mesh-parameters={n: 4, growth: 1.6}",
                 "participants.structure.mesh-parameters={n: 8}", f"participants.structure.contact={SEAT}"]),
}


def run(folder, programs, case, sets, restart=None, changes=()):
    words = [f"--set={s}" for s in (f"simulation.output.folder={folder}", *sets, *changes)]
    words += (["--restart", restart] if restart else []) + (["--restart-with-changes"] if changes else [])
    return said(mpmd([BIN / program, case, *words] for program in programs), 500)


def main():
    name, programs, participant, sets = CASES[KIND]
    with tempfile.TemporaryDirectory(prefix="couplet-plate-") as scratch:
        here = pathlib.Path(scratch)
        shutil.copytree(CONFIGS / name, here / "case", ignore=shutil.ignore_patterns("out*"))
        case = here / "case" / "case.yaml"
        whole = here / "whole"
        run(whole, programs, case, sets)
        rows = list(csv.DictReader((whole / participant / "contact.csv").open()))
        touching = [i for i, row in enumerate(rows) if float(row["energy [J]"]) > 0]
        inside = [i for i in touching if i > 0 and i + 2 < len(rows)]
        if not inside:
            sys.exit(f"the structure never touches its seat: {rows}")
        step = inside[0] + 1  # the first step has row 0
        print(f"stopped after step {step} of {len(rows)}, while {rows[step - 1]['energy [J]']} J are in the seat")
        if KIND == "coupled":
            audit = list(csv.DictReader((whole / participant / "energies.csv").open()))
            impact = max(float(row["energy [J]"]) for row in rows)
            mismatch = max(abs(float(row["mismatch [J]"])) for row in audit)
            print(f"mismatch of the energies {mismatch:.2e} J, {100 * mismatch / impact:.2e} % of the impact's {impact:.3g} J")
            if mismatch > 0.01 * impact:
                sys.exit("the energies of the structure do not balance")
        # The continued run must not see what lies after the stop.
        again = here / "again"
        shutil.copytree(whole, again)
        kept = again / "checkpoints" / f"step-{step:08d}"
        for folder in (again / "checkpoints").iterdir():
            if folder != kept:
                shutil.rmtree(folder)
        run(again, programs, case, sets, kept)
        for file in ("modal.csv", "energies.csv", "contact.csv", "probes.csv"):
            compare(file, *((f / participant / file).read_text() for f in (whole, again)))
        print(f"{len(rows)} rows of four files are the same")
        if KIND == "alone":
            without_seat(here, programs, case, participant, sets, kept, step)


def without_seat(here, programs, case, participant, sets, kept, step):
    """The seat is taken away in the middle of the contact: nothing keeps its energy, and the balance goes on without it."""
    told = run(here / "again", programs, case, sets, kept, (f"participants.{participant}.contact=",))
    rows = list(csv.DictReader((here / "again" / participant / "energies.csv").open()))
    left = [float(row["seat [J]"]) for row in rows[step + 1:]]
    apart = max(abs(float(row["mismatch [J]"])) for row in rows[step + 1:]) / max(float(row["kinetic [J]"]) for row in rows)
    print(f"without the seat: {max(left)} J in it, balance off by {apart:.1e}")
    if max(left) != 0 or apart > 1e-9 or "this jump is not part of the balance" not in told:
        sys.exit("a seat that was taken away still holds energy, or nothing was said")


def compare(file, whole, again):
    if whole == again:
        print(f"{file}: apart by 0 of its largest value")
        return
    a, b = (list(csv.reader(text.splitlines())) for text in (whole, again))
    if a[0] != b[0] or len(a) != len(b):
        sys.exit(f"{file} has other columns or rows after the restart")
    size = max(abs(float(v)) for row in a[1:] for v in row[1:])
    apart = max(abs(float(x) - float(y)) for row, other in zip(a[1:], b[1:]) for x, y in zip(row, other))
    print(f"{file}: apart by {apart / size:.1e} of its largest value")
    sys.exit(f"{file} differs after the restart")


main()
