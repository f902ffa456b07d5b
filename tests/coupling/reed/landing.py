#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The slice of configs/reed-slice pressed shut by a pressure from outside while the stream from the duct builds up: the reed lands on its seat,
a tenth of its gap above the wall, rests there, and is lifted off it. With the plate, with a solid's modes, and with a solid at large strain. The cells
beside the reed's edge are then 10 um high at one end and 60 um at the other; a face between them leans by 80 degrees.
Usage: landing.py plate|modes|solid|coarse-solid PROJECT BIN MPIRUN..."""
import csv
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import check, end, mpmd  # noqa: E402

kind, project, programs, mpirun = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]), sys.argv[4:]
case, structure = {"plate": ("case.yaml", "plate_modal"), "modes": ("modes.yaml", "plate_modal"), "solid": ("solid.yaml", "solid_solver"),
                   "coarse-solid": ("solid.yaml", "solid_solver")}[kind]
SEAT = -0.27e-3  # lift of the tip at which it lands [m]
CHECKPOINTS = 0.25e-3  # [s]


def run(top, name, end, ranks=(1, 1, 1, 1), restart=None):
    """What the run wrote to the terminal."""
    sets = [f"simulation.output.folder={name}", f"simulation.end-time={end}", f"simulation.checkpoint={{interval: {CHECKPOINTS}, keep: 20}}", "simulation.output.interval=0",
            'participants.fluid.boundaries.outlet.pressure="t<0.003?1000*sin(pi*t/0.003):0"']
    sets += [f"participants.{name}.mesh-parameters={{f: 0.5}}" for name in ("fluid", "mover", "reed")] if kind == "coarse-solid" else []
    sets += ["participants.reed.output.energies=true"] if structure == "solid_solver" else []
    words = [case, *(f"--set={word}" for word in sets), *(["--restart", restart] if restart else [])]
    line = mpmd([[programs / program, *words] for program in ("coupler", "fluid_solver", structure, "mesh_mover")], ranks, mpirun)
    done = subprocess.run(line, cwd=top, capture_output=True, text=True, timeout=280)
    said = done.stdout + done.stderr
    # 4: the run's own estimate finds so coarse a mesh not reliable.
    # The mover may refuse a guess of the coupling in which the reed is in the wall: that step is halved. The flow must hold.
    check(f"{name}: exit code 0 or 4, no step of the flow failed", done.returncode in (0, 4) and "'fluid' reports" not in said,
          [line for line in said.splitlines() if "'fluid' reports" in line][:2] or ("" if done.returncode in (0, 4) else said[-600:]))
    return said


def columns(top, name, file, *wanted):
    with open(top / name / "reed" / file, newline="") as rows:
        return [tuple(float(r[w]) for w in ("time [s]", *wanted)) for r in csv.DictReader(rows)]


def landing(top):
    said = run(top, "whole", 3.8e-3)
    tip, seat = columns(top, "whole", "probes.csv", "tip z [m]"), columns(top, "whole", "contact.csv", "force [N]", "penetration [m]", "energy [J]")
    touching = [row for row in seat if row[1] > 0]
    check("it lands before the load is gone and leaves the seat", touching and 2.2e-3 < touching[0][0] < 2.5e-3 and 2.5e-3 < touching[-1][0] < 3.4e-3,
          f"touches from {touching[0][0] if touching else 0} to {touching[-1][0] if touching else 0} s")
    check("it goes no deeper than the springs of the seat let it", max(row[2] for row in seat) < 5e-6, f"{max(row[2] for row in seat):.2e} m")
    check("the reed stands in the seat, then moves up", abs(min(z for _, z in tip) / SEAT - 1) < 0.05 and tip[-1][1] - tip[-5][1] > 2e-5,
          f"least lift {min(z for _, z in tip):.3e} m, at the end {tip[-5][1]:.3e} and {tip[-1][1]:.3e} m")
    lost = "lost by the scheme [J]" if structure == "solid_solver" else "mismatch [J]"
    energies = columns(top, "whole", "energies.csv", "kinetic [J]", "strain [J]", lost)
    most, off = max(k + s for _, k, s, _ in energies), max(abs(m) for *_, m in energies)
    check("its energies add up through the impacts", off < (1e-4 if structure == "solid_solver" else 1e-9) * most, f"{off:.1e} of {most:.1e} J")
    found = re.search(r"energy at the interface: .* differ by ([\d.e+-]+) % of the .*: balanced", said)
    check("so does the work of the fluid", found and float(found[1]) < 0.01, found[1] if found else [line for line in said.splitlines() if "energy at the interface" in line])
    in_seat = [n for n in range(1, 14) if any(abs(t - n * CHECKPOINTS) < 1e-9 and force > 0 for t, force, *_ in seat)]
    check("it is in its seat at a checkpoint", in_seat)
    return tip, seat, in_seat[0] if in_seat else 10


with tempfile.TemporaryDirectory() as folder:
    top = pathlib.Path(folder)
    for file in sorted((project / "configs/reed-slice").glob("*.*")):
        shutil.copy(file, top)
    if kind == "modes":
        shapes = subprocess.run([*mpirun, "-n", "1", str(programs / "solid_solver"), "shapes.yaml"],
                                cwd=top, capture_output=True, text=True, timeout=100)
        check("the solid's modes", shapes.returncode == 0, shapes.stderr[-300:])
    tip, seat, n = landing(top)
    half_way = str(sorted((top / "whole/checkpoints").iterdir())[n - 1].relative_to(top))
    run(top, "rest", n * CHECKPOINTS + 2e-4, restart=half_way)
    rest = columns(top, "rest", "probes.csv", "tip z [m]"), columns(top, "rest", "contact.csv", "force [N]", "penetration [m]", "energy [J]")
    same = [[row for row in whole if any(row[0] == other[0] for other in part)] == part for whole, part in zip((tip, seat), rest)]
    check("restarted in contact bit for bit", len(rest[0]) >= 4 and all(same), str(rest[0][-1:]))
    # One step: two ranks of the solid exchange hundreds of times in each.
    run(top, "ranks", n * CHECKPOINTS + 5e-5, ranks=(1, 1, 2, 1 if structure == "solid_solver" else 2), restart=half_way)
    t, z = columns(top, "ranks", "probes.csv", "tip z [m]")[-1]
    off = abs(z - dict(tip)[t]) / abs(SEAT)
    check("continued on two ranks: the same", off < 1e-6, f"{off:.1e} of the lift")
end()
