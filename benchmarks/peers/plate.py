# SPDX-License-Identifier: Apache-2.0
"""The elliptic plate of configs/elliptic-plate for other programs: geometry, and the error at the nine points from
values on a structured grid in (s, phi)."""
import pathlib
import sys

import numpy as np
from scipy.interpolate import RectBivariateSpline

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "configs/elliptic-plate"))
import nine_points  # noqa: E402

YOUNG, POISSON, PRESSURE, THICKNESS = 210e9, 0.3, 1e6, nine_points.THICKNESS


def place(s, phi, z):
    return (2 + 1.25 * s) * np.cos(phi), (1 + 1.75 * s) * np.sin(phi), z


def error(s, phi, displacement):
    """Relative L2 error over the nine points; `displacement` of the middle plane: (s, phi, component)."""
    _, x, *wanted, _ = nine_points.reference()
    at = nine_points.map_back(x, x)
    found = [RectBivariateSpline(s, phi, displacement[..., k], kx=3, ky=3).ev(*at) for k in range(3)]
    return np.linalg.norm(np.array(found) - wanted) / np.linalg.norm(wanted)
