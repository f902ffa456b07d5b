#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The first steps of configs/reed-slice: from rest, where the volume upstream is all that acts, no step fails; the same on other ranks,
and bit for bit after a restart. Its one seat: what states another is refused. Usage: run.py PROJECT BIN MPIRUN..."""
import csv
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import check, end, mpmd  # noqa: E402

project, programs, mpirun = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3:]


PROGRAMS = [programs / program for program in ("coupler", "fluid_solver", "plate_modal", "mesh_mover")]


def run(top, name, end, ranks=(1, 1, 1, 1), restart=None):
    """Times and tip heights of a run."""
    words = ["case.yaml", f"--set=simulation.output.folder={name}", f"--set=simulation.end-time={end}", "--set=simulation.checkpoint.interval=2e-4",
             *(["--restart", restart] if restart else [])]
    done = subprocess.run(mpmd([[program, *words] for program in PROGRAMS], ranks, mpirun), cwd=top, capture_output=True, text=True, timeout=100)
    check(f"{name}: exit code 0, no step failed", done.returncode == 0 and " failed:" not in done.stdout + done.stderr, (done.stdout + done.stderr)[-400:] if done.returncode else "")
    with open(top / name / "reed/probes.csv", newline="") as rows:
        return [(float(r["time [s]"]), float(r["tip z [m]"])) for r in csv.DictReader(rows)]


def refused(top, claim, message, *sets, run_it=False):
    """These settings end with this message."""
    words = ["case.yaml", *(f"--set={word}" for word in sets)]
    line = mpmd([[program, *words] for program in PROGRAMS], mpirun=mpirun) if run_it else [programs / "plate_modal", *words, "--check"]
    done = subprocess.run(line, cwd=top, capture_output=True, text=True, timeout=100)
    check(claim, done.returncode != 0 and message in done.stdout + done.stderr, (done.stdout + done.stderr)[-400:])


with tempfile.TemporaryDirectory() as folder:
    top = pathlib.Path(folder)
    for file in ("case.yaml", "fluid.geo", "plate.geo"):
        shutil.copy(project / "configs/reed-slice" / file, top)
    refused(top, "a contact's own height beside that of its gap is refused", "contact.height: the gap 'overlap' already defines it",
            "participants.reed.contact.height=0.03 mm")
    refused(top, "a contact's own opening beside that of its gap is refused", "contact.opening: the gap 'overlap' already defines it",
            "participants.reed.contact.opening=0.05 mm")
    refused(top, "an unknown gap is refused", "the fluid has no gap 'overlop'. Did you mean 'overlap'?", "participants.reed.contact.gap=overlop")
    refused(top, "a contact beside a gap that states another seat is refused", "the gap 'overlap' of the fluid states a seat as well",
            "participants.reed.contact.gap=~", "participants.reed.contact.height=0.03 mm")
    refused(top, "a seat that the mesh has elsewhere is refused", "the seat is stated at 0.0001 m, but the mesh has its wall 'seat' 0.0001 m below it",
            "participants.fluid.gaps.overlap.height=0.1 mm", run_it=True)
    whole = run(top, "whole", 4e-4)
    check("the reed lifts", len(whole) == 8 and all(b[1] > a[1] for a, b in zip(whole, whole[1:])) and whole[-1][1] > 1e-10, str(whole[-1:]))
    ranks = run(top, "ranks", 2e-4, (2, 3, 2, 3))
    off = max(abs(a[1] - b[1]) for a, b in zip(whole, ranks)) / whole[-1][1]
    check("on 3 ranks of the fluid and of the mover: the same", len(ranks) == 4 and off < 1e-6, f"{off:.1e}")
    rest = run(top, "rest", 4e-4, restart="whole/checkpoints/step-00000004")
    check("restarted bit for bit", len(rest) == 4 and rest == whole[4:], str(rest[-1:]))
end()
