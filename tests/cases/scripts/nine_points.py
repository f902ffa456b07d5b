#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The error measure of the elliptic plate: the reference itself has none, and a known deviation is found as it is."""
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "configs" / "elliptic-plate"))
import nine_points  # noqa: E402

x, y = np.array([2.5, 1.0, 0.0]), np.array([0.4, 1.3, 2.0])
s, phi = nine_points.map_back(x, y)
assert np.allclose((2 + 1.25 * s) * np.cos(phi), x) and np.allclose((1 + 1.75 * s) * np.sin(phi), y)
assert np.isclose(nine_points.von_mises(np.array([3.0, 0, 0, 0, 0, 0])), 3)
assert np.isclose(nine_points.von_mises(np.array([1.0, 1, 1, 0, 2, 0])), 2 * np.sqrt(3))

# cells in scrambled order come back by their place in (s, phi, z), the mean of those that share one; fields of low degree are interpolated exactly
shape = (7, 9, 5)
axes = [np.linspace(0, end, n) for end, n in zip((1, np.pi / 2, nine_points.THICKNESS), shape)]
S, F, Z = (a.ravel() for a in np.meshgrid(*axes, indexing="ij"))
middles = np.meshgrid(*((np.arange(n) + 0.5) * end / n for n, end in zip(shape, (1, np.pi / 2, nine_points.THICKNESS))), indexing="ij")
for share in (1, 2, 6):
    s, phi, z = (np.repeat(a.ravel(), share) for a in middles)
    scramble = np.random.default_rng(7).permutation(len(s))
    places = np.stack([(2 + 1.25 * s) * np.cos(phi), (1 + 1.75 * s) * np.sin(phi), z], axis=-1)[scramble]
    values = np.arange(float(len(s)))
    place, found = nine_points.grid(places, shape)
    assert found == share
    assert np.allclose(nine_points.means(values[scramble], place, found, shape).ravel(), values.reshape(-1, share).mean(axis=1))
try:
    nine_points.grid(places[1:], shape)
    raise SystemExit("a grid with a hole passed")
except ValueError:
    pass
for n in (3, 4, 5):
    z = np.linspace(0, nine_points.THICKNESS, n)
    assert np.isclose(nine_points.at_middle((1 + z + 2 * z**2)[None, None], z)[0, 0], 1 + 0.3 + 2 * 0.09)
field = nine_points.Plate.splines(axes, (S**2 * F**3).reshape(shape)[:, :, :1])[0]
assert np.isclose(field.ev(0.37, 0.81), 0.37**2 * 0.81**3)


class Exact:
    """Gives the reference back, the displacement by 2 % too large."""
    cells = 1

    def __init__(self, _):
        pass

    def displacement(self, x, _):
        return 1.02 * np.stack(nine_points.reference()[2:5], axis=-1)

    def stress(self, x, _):
        return np.stack([nine_points.reference()[5]] + 5 * [0 * x], axis=-1)


nine_points.Plate = Exact
u, stress, _ = nine_points.errors("nowhere")
assert np.isclose(u, 0.02) and np.isclose(stress, 0), (u, stress)
