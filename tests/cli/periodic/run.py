# SPDX-License-Identifier: Apache-2.0
"""The step's part of the error of a flow that a pulsating force drives through a channel (Womersley) must not grow with the number of
periods: it stays within a factor of 3 of the truth, which is the difference to a run with an eighth of the step on the same mesh.
Usage: run.py BIN CONFIGS PERIODS..."""
import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile

programs, configs, periods = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), [int(n) for n in sys.argv[3:]]
F = "participants.fluid."
PLACES = (0.03, 0.1, 0.2, 0.35, 0.5)
PERIOD = 1.0
# alpha: half the height times sqrt(omega / nu), and steps per period; at alpha 1 friction holds the flow to its force.
FLOWS = ((3, 40), (10, 40), (1, 5))


def run(folder, alpha, end, steps):
    """Probes of the last period by their time in thousandths of it, and the budget."""
    viscosity = 0.25 * 2 * math.pi / PERIOD / alpha ** 2
    probes = ", ".join(f"p{i}: {{point: [2, {y}]}}" for i, y in enumerate(PLACES))
    sets = [F + "boundaries={inlet: {type: periodic, partner: outlet}, outlet: {type: periodic, partner: inlet}, walls: {type: no-slip}}",
            F + "mesh-parameters={n: 16}", F + f"viscosity={viscosity} Pa s", F + 'body-force=["0.2 + cos(2*pi*t)", 0]', F + f"probes={{{probes}}}",
            F + "output={}", f"simulation.end-time={end} s", f"simulation.time-step={PERIOD / steps} s", f"simulation.output={{folder: {folder}, interval: {end} s}}"]
    done = subprocess.run([str(programs / "fluid_solver"), str(configs / "pulsing-channel/case.yaml"), *(f"--set={s}" for s in sets)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"FAILED: exit code {done.returncode}\n{done.stdout[-1500:]}{done.stderr[-1500:]}")
    with open(folder / "fluid/probes.csv", newline="") as file:
        rows = list(csv.reader(file))
    columns = [i for i, name in enumerate(rows[0]) if "velocity x" in name or name.endswith("x [m/s]")]
    late = {round(float(r[0]) / PERIOD * 1000, 3): [float(r[i]) for i in columns] for r in rows[1:] if float(r[0]) > end - PERIOD - 1e-9}
    return late, json.loads((folder / "fluid/run.json").read_text())["errors"]


def norm(values):
    return math.sqrt(sum(v * v for v in values) / len(values))


def main():
    bad = 0
    with tempfile.TemporaryDirectory(prefix="couplet-periodic-") as temporary:
        for alpha, steps in FLOWS:
            for n in periods:
                coarse, errors = run(pathlib.Path(temporary) / f"a{alpha}-{n}", alpha, n * PERIOD, steps)
                fine, _ = run(pathlib.Path(temporary) / f"f{alpha}-{n}", alpha, n * PERIOD, 8 * steps)
                common = sorted(set(coarse) & set(fine))
                size = max(norm(fine[k]) for k in common)
                truth = max(norm([a - b for a, b in zip(coarse[k], fine[k])]) for k in common) / size
                good = len(common) >= steps and 1 / 3 <= errors["step"] / truth <= 3
                bad += not good
                print("ok    " if good else "FAILED", f"alpha {alpha}, {steps} steps per period, {n} periods: step {errors['step']:.3g}, truth {truth:.3g} ({len(common)} times, size {size:.3g})")
    return bad > 0


if __name__ == "__main__":
    sys.exit(main())
