#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Extrema of the velocity on the centre lines at Re = 1000 against Albensoeder and Kuhlmann, J. Comput. Phys. 206 (2005) 536.
Usage: extrema.py [FOLDER of the participant], by default out/fluid."""
import pathlib
import sys

import numpy as np
from scipy.interpolate import barycentric_interpolate

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parents[1] / "client/python"))
import couplet  # noqa: E402
from couplet.series import extremum  # noqa: E402

REFERENCE = {"u_min": -0.2803833, "v_max": 0.2466511, "v_min": -0.4350186}


def extrema(folder):
    """u_min along x = z = 0.5; v_max and v_min along y = z = 0.5, by cubic interpolation between the columns of cells beside the line."""
    series = couplet.find_series(folder)
    last = len(series.times) - 1
    centres, velocity = series.centres(), series.field(last, "velocity")
    n = int(round(len(centres) ** (1 / 3)))
    order = np.lexsort(np.round(centres, 9).T[::-1])  # x slowest, z fastest
    place = np.unique(np.round(centres[:, 0], 9))
    u = velocity[order].reshape(n, n, n, 3)
    i = int(np.searchsorted(place, 0.5))
    beside, weights = slice(i - 2, i + 2), barycentric_interpolate(place[i - 2 : i + 2], np.eye(4), 0.5)
    upright = np.einsum("i,k,ijk->j", weights, weights, u[beside, :, beside, 0])
    across = np.einsum("j,k,ijk->i", weights, weights, u[:, beside, beside, 1])
    return {"u_min": extremum(place, upright, -1), "v_max": extremum(place, across, 1), "v_min": extremum(place, across, -1)}


def errors(folder):
    """Relative, in the order of REFERENCE."""
    return {name: abs(value / REFERENCE[name] - 1) for name, value in extrema(folder).items()}


if __name__ == "__main__":
    results = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here / "out" / "fluid"
    off = errors(results)
    for name, value in extrema(results).items():
        print(f"{name} {value:.5f}, Albensoeder and Kuhlmann {REFERENCE[name]:.5f}, {100 * off[name]:.2f} % off")
