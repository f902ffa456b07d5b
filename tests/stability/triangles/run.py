# SPDX-License-Identifier: Apache-2.0
"""Long steps with an implicit viscous term on triangles: bounded by friction there, so that pressure and forces stay right; given from
outside ('time-step') they grow out of nothing beside it, and the run says so.
Usage: run.py FLUID_SOLVER"""
import math
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import check, end, last  # noqa: E402

program, case = sys.argv[1], pathlib.Path(__file__).parent / "case.yaml"
SPEED, INNER, OUTER, VISCOSITY = 2, 0.5, 1.0, 0.5


def run(*sets):
    """Exit code, output, coefficients and energies at the end."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([program, case, "--strict", f"--set=simulation.output.folder={folder}", *(f"--set={s}" for s in sets)],
                              capture_output=True, text=True, timeout=200)
        files = pathlib.Path(folder) / "fluid"
        return done.returncode, done.stdout + done.stderr, last(files / "coefficients.csv"), last(files / "energy.csv")


# Couette's flow between cylinders: v = a r + b/r; the shear 2 mu b/r^2 on the inner wall, over rho U^2/2 with A = L = 1.
b = SPEED * INNER**2 * OUTER**2 / (OUTER**2 - INNER**2)
moment = -2 * math.pi * INNER**2 * 2 * VISCOSITY * b / INNER**2 / 0.5
code, text, coefficients, energy = run()
check("exit code 0, nothing is doubted", code == 0 and "warning:" not in text, text[-500:] if code else "")
check("moment within 1 %", abs(coefficients["inner moment"] / moment - 1) < 0.01, f"{coefficients['inner moment']:.4f} and {moment:.4f}")
sides = max(abs(coefficients["inner drag"]), abs(coefficients["inner lift"]))
# Of the momentum flux; a pressure extrapolated along the turning wall had 0.014, and first order in its sum.
check("no force to the side beyond a hundredth of the friction", sides < 0.08, f"{sides:.3g}")
power = -moment * 0.5 * SPEED  # what the inner wall gives (but for that of viscous power's own form: 2 mu e:e less a rotation)
check("viscous power of the order of the wall's", energy["viscous power"] < 1.5 * power, f"{energy['viscous power']:.3g} and {power:.3g} W")
code, text, coefficients, energy = run("participants.fluid.time-step=10 ms")
check("the neighbour, whose step is given, fails with --strict", code != 0, code)
check("and says why", "the limit of an implicit viscous term in cell" in text and "remove 'time-step'" in text)
check("and the flow diverges", "The flow diverges" in text)
# Sound at the start; the limit falls with the square of the cells' size as the walls draw together.
shrinking = [f"participants.fluid.{key}" for key in (
    'motion={displacement: ["-0.55*x*sin(pi*t/4)^2", "-0.55*y*sin(pi*t/4)^2"]}', "boundaries.inner={type: body}",
    "boundaries.outer={type: outlet, pressure: 0}", "time-step=1 ms")]
for until, sound in (("0.5 s", True), ("1.5 s", False)):
    code, text, _, _ = run(*shrinking, f"simulation.end-time={until}")
    said = "the limit of an implicit viscous term in cell" in text
    check(f"cells that shrink until {until}: {'nothing' if sound else 'the given step'} is doubted", (code == 0) == sound and said != sound, text[-300:])
end()
