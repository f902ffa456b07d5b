# SPDX-License-Identifier: Apache-2.0
"""Fluid, solid and mover on several ranks each where the first rank holds no part of the interface: the same motion as on one, and a
mesh that follows it. Such a mover once left its mesh at rest silently. With default tolerances, added masses up to 91 times the
bar's: the fluid answers each pass, though its first guess meets its own tolerance.
Usage: run.py PROGRAMS"""
import pathlib
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import COUPLED, check, end, last, mpmd  # noqa: E402

programs, case = pathlib.Path(sys.argv[1]), pathlib.Path(__file__).parent / "case.yaml"
HEIGHT, LENGTH = 0.4, 1.0


def run(ranks, *settings):
    """Displacement of the bar's face [m] and volume of the fluid [m^3] at the end; all passes and halvings."""
    with tempfile.TemporaryDirectory() as folder:
        line = mpmd([[programs / program, case, f"--set=simulation.output.folder={folder}", *settings] for program in COUPLED], (1, *ranks))
        done = subprocess.run(line, capture_output=True, text=True, timeout=250)
        if done.returncode:
            print(done.stdout[-2000:], done.stderr[-1000:])
            check(f"ranks {ranks}: exit code 0", False, done.returncode)
            return (float("nan"),) * 4 + ("",)
        folder = pathlib.Path(folder)
        steps, halvings, mean = re.search(r"(\d+) steps, (\d+) halvings.*iterations: mean ([\d.]+)", done.stdout).groups()
        return last(folder / "solid/probes.csv")["face x"], last(folder / "fluid/balance.csv")["volume"], int(steps) * float(mean), int(halvings), done.stdout


alone = run((1, 1, 1))
swept = HEIGHT * (LENGTH + alone[0])  # but for what the last guess of the motion was off
check("the bar moves and the mesh follows", alone[0] > 0.01 and abs(alone[1] - swept) < 0.02 * HEIGHT * alone[0], f"{alone[:2]} and {swept} m^3")
for ranks in ((1, 1, 2), (2, 1, 1), (3, 2, 3)):
    moved, volume, *_ = run(ranks)
    check(f"ranks {ranks}: the motion of one rank each", abs(moved - alone[0]) < 1e-5 * alone[0], f"{moved} and {alone[0]} m")
    check(f"ranks {ranks}: the mesh follows", abs(volume - alone[1]) < 1e-5 * HEIGHT * alone[0], f"{volume} and {alone[1]} m^3")

# rho_f L over rho_s times 1 m. Passes of ten steps with a pressure tolerance of 1e-9 were 34 and 37. At 1000 rounding
# decides, so that it is a row of validation (docs/validation/coupling-accuracy.md): of densities that differ by 1e-4 a third
# have failed steps, since each pass that shows the quasi-Newton method a new mode multiplies it by 1e4. The trapezoidal rule keeps
# the response of the bar the same in all steps. Generalized alpha, whose first step is a trapezoidal one, takes 41 passes at 91.
DEFAULTS = ("--set=participants.fluid.pressure-tolerance=1e-6", "--set=coupling.convergence.relative=1e-4",
            "--set=participants.solid.time-scheme.type=trapezoidal")
for ratio, most in ((10, 36), (91, 40)):
    moved, _, passes, halvings, _ = run((1, 1, 1), f"--set=participants.fluid.density={1000 * ratio}", *DEFAULTS)
    check(f"added mass {ratio}, default tolerances: each step converges", halvings == 0, f"{halvings} halvings")
    check(f"added mass {ratio}, default tolerances: at most {most} passes", passes <= most, f"{passes} passes")

# A residual of the position is an error 4 r/dt^2 of the acceleration.
for relative, told in (("1e-2", True), ("1e-6", False)):
    *_, text = run((1, 1, 1), f"--set=coupling.convergence.relative={relative}", "--set=simulation.time-step=0.5 ms")
    check(f"noise of the loads with a tolerance of {relative}", ("noise-of-the-coupling" in text) == told, text[-1500:])
end()
