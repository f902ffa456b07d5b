# SPDX-License-Identifier: Apache-2.0
"""Fluid, solid and mover on several ranks each where the first rank holds no part of the interface: the same motion as on one, and a
mesh that follows it. Such a mover once left its mesh at rest without a word.
Usage: run.py PROGRAMS"""
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import check, end, last  # noqa: E402

programs, case = pathlib.Path(sys.argv[1]), pathlib.Path(__file__).parent / "case.yaml"
HEIGHT, LENGTH = 0.4, 1.0


def run(ranks):
    """Displacement of the bar's face [m] and volume of the fluid [m^3] at the end."""
    with tempfile.TemporaryDirectory() as folder:
        words = ["mpirun", "--oversubscribe"]
        for program, n in zip(("coupler", "fluid_solver", "solid_solver", "mesh_mover"), (1, *ranks)):
            words += [":"] * (program != "coupler") + ["-n", str(n), programs / program, case, f"--set=simulation.output.folder={folder}"]
        done = subprocess.run([str(w) for w in words], capture_output=True, text=True, timeout=250)
        if done.returncode:
            print(done.stdout[-2000:], done.stderr[-1000:])
            check(f"ranks {ranks}: exit code 0", False, done.returncode)
            return float("nan"), float("nan")
        folder = pathlib.Path(folder)
        return last(folder / "solid/probes.csv")["face x"], last(folder / "fluid/balance.csv")["volume"]


alone = run((1, 1, 1))
swept = HEIGHT * (LENGTH + alone[0])  # but for what the last guess of the motion was off
check("the bar moves and the mesh follows", alone[0] > 0.01 and abs(alone[1] - swept) < 0.02 * HEIGHT * alone[0], f"{alone} and {swept} m^3")
for ranks in ((1, 1, 2), (2, 1, 1), (3, 2, 3)):
    moved, volume = run(ranks)
    check(f"ranks {ranks}: the motion of one rank each", abs(moved - alone[0]) < 1e-5 * alone[0], f"{moved} and {alone[0]} m")
    check(f"ranks {ranks}: the mesh follows", abs(volume - alone[1]) < 1e-8, f"{volume} and {alone[1]} m^3")
end()
