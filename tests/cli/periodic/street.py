# SPDX-License-Identifier: Apache-2.0
"""The step's part of the error of a vortex street (2D-2 on a coarse mesh) over many periods: what drifts is its phase, which no through-flow takes
away. It stays within a factor of 3 of the truth, which is the difference to a run with a 32nd of the step on the same mesh, at equal
times: root of the mean square over places all over the channel, the largest of the last period, over the size of the velocity. The same
with the reference moved in time to where it fits best, without the phase, is shown beside it.
Usage: street.py BIN CONFIGS PERIODS..."""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

programs, configs, periods = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), [int(n) for n in sys.argv[3:]]
F = "participants.fluid."
SIZE, STEP, FINER = 12, 0.01, 32  # cells on a quarter of the cylinder; [s], 38 steps a period
BEGIN, PERIOD = 2.0, 0.3765       # [s]; the street's first period after the gust, on this mesh
PLACES = [(x, y) for x in np.linspace(0.05, 2.15, 22) for y in np.linspace(0.03, 0.38, 8) if (x - 0.2) ** 2 + (y - 0.2) ** 2 > 0.06 ** 2]


def run(folder, end, step):
    """Times, velocities at the places, and the budget."""
    probes = ", ".join(f"p{i}: {{point: [{x:.5f}, {y:.5f}]}}" for i, (x, y) in enumerate(PLACES))
    sets = [F + f"mesh-parameters={{n: {SIZE}}}", F + f"probes={{{probes}}}", F + "output={}", f"simulation.end-time={end} s", f"simulation.time-step={step} s",
            f"simulation.output={{folder: {folder}, interval: {end} s}}"]
    done = subprocess.run([str(programs / "fluid_solver"), str(configs / "cylinder/case.yaml"), *(f"--set={s}" for s in sets)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"FAILED: exit code {done.returncode}\n{done.stdout[-1500:]}{done.stderr[-1500:]}")
    with open(folder / "fluid/probes.csv") as file:
        head = file.readline().strip().split(",")
        columns = [0, *(i for i, name in enumerate(head) if "velocity x" in name or "velocity y" in name)]
        data = np.array([np.fromstring(line, sep=",")[columns] for line in file])
    if len(columns) != 1 + 2 * len(PLACES):
        sys.exit(f"FAILED: {len(columns)} columns for {len(PLACES)} places: {head[:4]}")
    return data[:, 0], data[:, 1:], json.loads((folder / "fluid/run.json").read_text())["errors"]


def norm(difference):
    """Per row, over the places."""
    return np.sqrt((difference**2).sum(1) / len(PLACES))


def at(times, values, moments):
    i = np.clip(np.searchsorted(times, moments) - 1, 0, len(times) - 2)
    f = ((moments - times[i]) / (times[i + 1] - times[i]))[:, None]
    return (1 - f) * values[i] + f * values[i + 1]


def main():
    bad = 0
    with tempfile.TemporaryDirectory(prefix="couplet-street-") as temporary:
        folder = pathlib.Path(temporary)
        # A tenth of a period more, so that the reference can be moved.
        fine_times, fine, _ = run(folder / "fine", BEGIN + (max(periods) + 0.1) * PERIOD, STEP / FINER)
        for n in periods:
            end = round(BEGIN + n * PERIOD, 2)
            times, values, errors = run(folder / str(n), end, STEP)
            late = times > end - PERIOD
            size = norm(fine[fine_times > BEGIN]).max()
            truth, shape = (min(norm(values[late] - at(fine_times, fine, times[late] + lag)).max() for lag in lags) / size
                            for lags in ([0.0], np.linspace(-0.1, 0.1, 81) * PERIOD))
            good = 1 / 3 <= errors["step"] / truth <= 3
            bad += not good
            print("ok    " if good else "FAILED", f"2D-2, {n} periods: step {errors['step']:.3g}, truth {truth:.3g} (of it without the phase {shape:.3g}; mesh {errors['mesh']:.3g})")
    return bad > 0


if __name__ == "__main__":
    sys.exit(main())
