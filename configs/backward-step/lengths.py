#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Where the flow reattaches on the floor, separates from the lid and comes back to it, in channel heights, from the lines beside the
walls. Usage: lengths.py [FOLDER], by default out/fluid."""
import pathlib
import sys

import numpy as np

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parents[1] / "client/python"))
import couplet  # noqa: E402

GARTLING = {"lower reattachment": 6.10, "upper separation": 4.85, "upper reattachment": 10.48}  # Gartling 1990


def turns(file, upwards):
    """Places where the velocity along the wall changes its sign that way, at the last output."""
    rows = couplet.read_csv(file)
    last = rows["time [s]"] == rows["time [s]"][-1]
    x, u = rows["x [m]"][last], rows["velocity x [m/s]"][last]
    found = [x[i] - u[i] * (x[i + 1] - x[i]) / (u[i + 1] - u[i]) for i in range(len(x) - 1)
             if (u[i] < 0 <= u[i + 1] if upwards else u[i] >= 0 > u[i + 1])]
    return [float(v) for v in found if v > 0.5]  # the corner eddy at the step is none of these


def lengths(folder):
    floor, off, back = turns(folder / "sample-near-floor.csv", True), turns(folder / "sample-near-lid.csv", False), turns(folder / "sample-near-lid.csv", True)
    return {"lower reattachment": floor[0] if floor else np.nan, "upper separation": off[0] if off else np.nan,
            "upper reattachment": back[-1] if back else np.nan}


def largest_error(folder):
    return max(abs(value / GARTLING[name] - 1) for name, value in lengths(folder).items())


if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here / "out" / "fluid"
    if not (folder / "sample-near-floor.csv").exists():
        sys.exit(f"There is no result in {folder}. Run the case first (see its README).")
    for name, value in lengths(folder).items():
        print(f"{name} {value:.3f}, Gartling {GARTLING[name]:.2f} ({100 * (value / GARTLING[name] - 1):+.1f} %)")
