# SPDX-License-Identifier: Apache-2.0
"""Bodies that move as the mesh mover's boundaries prescribe, a fluid around them, no structure: the forces of a fluid that moves its
mesh by itself, the same on several ranks, and after a restart. Usage: run.py PROGRAMS CONFIGS"""
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import check, end, last, mpmd  # noqa: E402

programs, case = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]) / "passing-cylinders/case.yaml"
COARSE = "mesh-parameters={n: 12, fine: 2}"
SHORT = ("simulation.end-time=0.5", "simulation.output.interval=1", f"participants.fluid.{COARSE}", "participants.fluid.pressure-tolerance=1e-9")
MOVER = (f"participants.mover.{COARSE}",)


def sets(settings):
    return [f"--set={s}" for s in settings]


def job(folder, ranks, *settings, more=()):
    words = [*more, *sets((*SHORT, *MOVER, f"simulation.output.folder={folder}", *settings))]
    line = mpmd([[programs / program, case, *words] for program in ("coupler", "fluid_solver", "mesh_mover")], (1, *ranks))
    return subprocess.run(line, capture_output=True, text=True, timeout=120)


def forces(folder):
    row = last(folder / "fluid/forces.csv")
    return [value for name, value in row.items() if "time" not in name]


def far(a, b):
    size = max(map(abs, a))
    return max(abs(x - y) for x, y in zip(a, b)) / size if len(a) == len(b) and size > 0 else float("inf")


with tempfile.TemporaryDirectory() as scratch:
    scratch = pathlib.Path(scratch)
    done = job(scratch / "one", (1, 1))
    if done.returncode:
        print(done.stdout[-3000:], done.stderr[-1000:])
    check("two bodies, each with its own motion: exit code 0", done.returncode == 0, done.returncode)
    one = forces(scratch / "one")
    for ranks in ((2, 1), (1, 2)):
        done = job(scratch / f"ranks{ranks[0]}", ranks)
        check(f"{ranks} ranks: the same forces", done.returncode == 0 and far(one, forces(scratch / f"ranks{ranks[0]}")) < 1e-5,
              done.returncode or far(one, forces(scratch / f"ranks{ranks[0]}")))
    half = scratch / "half"
    job(half, (1, 1), "simulation.end-time=0.25")
    done = job(half, (1, 1), more=("--restart", half / "checkpoints", "--restart-with-changes"))
    check("continued from a checkpoint: the same forces bit for bit", done.returncode == 0 and forces(half) == one,
          done.stdout[-500:] if done.returncode else f"{forces(half)} and {one}")

    # The whole mesh carried along, by the fluid itself and by a mover: the same points, so the same flow.
    away = "{translation: ['0.2*sin(2*t)^2', 0]}"
    still = ("participants.fluid.boundaries.sides.type=slip",)
    done = job(scratch / "carried", (1, 1), *still, *(f"participants.mover.boundaries.{p}={{type: moving, motion: {away}}}"
                                                      for p in ("upper", "lower", "ends", "sides")))
    check("a mesh that is carried along: exit code 0", done.returncode == 0, done.stdout[-500:])
    lines = case.read_text().splitlines()
    begin = lines.index("  mover:")
    stop = lines.index("coupling:")
    alone = scratch / "alone.yaml"
    alone.write_text("\n".join(lines[:begin]).replace("pair.geo", str(case.parent / "pair.geo")) + "\n")
    assert stop > begin
    done = subprocess.run([str(programs / "fluid_solver"), str(alone), *sets((*SHORT, *still, f"participants.fluid.motion={away}",
                                                                              f"simulation.output.folder={scratch / 'alone'}"))],
                          capture_output=True, text=True, timeout=120)
    check("a fluid that moves its mesh by itself: exit code 0", done.returncode == 0, done.stdout[-500:] + done.stderr[-500:])
    there, here = forces(scratch / "carried"), forces(scratch / "alone")
    check("the forces of a fluid that moves its mesh by itself", far(here, there) < 1e-6, f"{here} and {there}")
end()
