#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Extrema of the centre-line profiles at Re = 1000 against Botella and Peyret, Comput. Fluids 27 (1998) 421, table 9.
Usage: extrema.py [FOLDER of the participant], by default out/fluid."""
import pathlib
import sys

import numpy as np
from scipy.interpolate import barycentric_interpolate

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parents[1] / "client/python"))
import couplet  # noqa: E402
from couplet.series import extremum  # noqa: E402

REFERENCE = {"u_min": -0.3885698, "v_max": 0.3769447, "v_min": -0.5270771}


def extrema(folder):
    """u_min on x = 0.5; v_max and v_min on y = 0.5, by cubic interpolation between the four columns beside the line."""
    series = couplet.find_series(folder)
    last = len(series.times) - 1
    centres, velocity = series.centres()[:, :2], series.field(last, "velocity")
    found = {}
    for axis, names in ((0, (("u_min", -1),)), (1, (("v_max", 1), ("v_min", -1)))):
        order = np.lexsort((centres[:, 1 - axis], np.round(centres[:, axis], 9)))
        n = int(round(np.sqrt(len(order))))
        grid = centres[order].reshape(n, n, 2)
        values = velocity[order][:, axis].reshape(n, n)
        columns = grid[:, 0, axis]
        i = int(np.searchsorted(columns, 0.5))
        line = barycentric_interpolate(columns[i - 2 : i + 2], values[i - 2 : i + 2], 0.5)
        for name, sign in names:
            found[name] = extremum(grid[0, :, 1 - axis], line, sign)
    return found


def errors(folder):
    """Relative, in the order of REFERENCE."""
    return {name: abs(value / REFERENCE[name] - 1) for name, value in extrema(folder).items()}


if __name__ == "__main__":
    results = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here / "out" / "fluid"
    off = errors(results)
    for name, value in extrema(results).items():
        print(f"{name} {value:.5f}, Botella and Peyret {REFERENCE[name]:.5f}, {100 * off[name]:.2f} % off")
