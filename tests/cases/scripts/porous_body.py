#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What configs/porous-body/generate.py promises: closed, in one piece, no slivers, true to the surface."""
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "configs" / "porous-body"))
import generate  # noqa: E402


def check(n):
    points, tets, triangles, patch = generate.make(n)
    volume = generate.volumes(points, tets)
    assert volume.min() > 0.01 * volume.mean(), f"{n}: smallest volume {volume.min() / volume.mean():.2e} of the mean"
    least, most = generate.smallest_angles(points, tets)
    assert least.min() > 9 and most.max() < 160, f"{n}: angles {least.min():.1f} to {most.max():.1f}"
    _, number, count = generate.faces_of(tets)
    assert count.max() == 2, f"{n}: a face belongs to {count.max()} cells"
    assert len(triangles) == (count == 1).sum() and len(generate.largest_piece(tets)) == len(tets), f"{n}: in pieces"
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [0, 2]]]), axis=1)
    _, times = np.unique(edges, axis=0, return_counts=True)
    assert (times % 2 == 0).all(), f"{n}: the boundary is open"
    for i, (axis, place) in enumerate(((2, 0), (2, generate.SIDE))):
        assert (points[triangles[patch == i]][:, :, axis] == place).all(), f"{n}: patch {generate.PATCHES[i]} is not flat"
    pores = np.unique(triangles[patch == 3])
    distance = np.abs(generate.gyroid(points[pores])) / np.linalg.norm(generate.gyroid_gradient(points[pores]), axis=1)
    on_surface = (distance < 1e-9).mean()
    assert on_surface > 0.98 and distance.max() < generate.NEAR * generate.SIDE / n, \
        f"{n}: {on_surface:.4f} of the pores' vertices on the gyroid, farthest {distance.max():.1e} m"
    return volume.sum() / generate.SIDE**3


fractions = [check(n) for n in (15, 21, 28)]
cells = (np.arange(160) + 0.5) / 160 * generate.SIDE
sample = np.stack(np.meshgrid(cells, cells, cells, indexing="ij"), -1)
true = (generate.gyroid(sample) > 0).mean()  # pieces that the cube cuts off are counted here
gaps = [abs(f - true) for f in fractions]
assert gaps[2] < 0.6 * gaps[0] and gaps[2] < 0.01 * true, f"solid fractions {fractions}, wanted {true}"
print(f"solid fractions {fractions}, of the gyroid {true}")
