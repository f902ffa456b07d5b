#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The compressed body, coloured by von Mises stress. Usage: plot.py [PICTURE.png], by default out/porous-body.png"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from generate import faces_of
from matplotlib.collections import PolyCollection

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "client/python"))
import couplet  # noqa: E402

TURN, TILT = np.radians(-50), np.radians(25)  # of the camera


def to_camera(x):
    """Horizontal, vertical, towards the camera."""
    c, s = np.cos(TURN), np.sin(TURN)
    right, depth = c * x[..., 0] - s * x[..., 1], s * x[..., 0] + c * x[..., 1]
    c, s = np.cos(TILT), np.sin(TILT)
    return np.stack([right, c * x[..., 2] + s * depth, s * x[..., 2] - c * depth], axis=-1)


def main():
    out, picture = couplet.result_of(HERE, "solid")
    series = couplet.find_series(out / "solid")
    last = len(series.times) - 1
    tets, stress = np.array(series.cells), series.field(last, "equivalent-stress") / 1e6
    points = to_camera(series.coordinates(last) * 1e3)
    faces, number, count = faces_of(tets)
    outside = count[number] == 1
    corners, owner = points[faces[outside]], np.tile(np.arange(len(tets)), 4)[outside]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outwards = corners.mean(axis=1) - points[tets[owner]].mean(axis=1)
    normal *= np.sign((normal * outwards).sum(axis=1) / np.linalg.norm(normal, axis=1) ** 2)[:, None]
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    seen = np.flatnonzero(normal[:, 2] > 0)
    seen = seen[np.argsort(corners[seen].mean(axis=1)[:, 2])]
    scale = plt.Normalize(0, np.percentile(stress, 99))
    colours = plt.get_cmap("viridis")(scale(stress[owner[seen]]))
    colours[:, :3] *= (0.35 + 0.65 * np.clip(normal[seen] @ [-0.4, 0.5, 0.77], 0, 1))[:, None]
    figure, ax = plt.subplots(figsize=(6.4, 6), dpi=130, constrained_layout=True)
    ax.add_collection(PolyCollection(corners[seen][:, :, :2], facecolors=colours, edgecolors=colours, linewidths=0.2))
    ax.autoscale()
    ax.set_aspect("equal")
    ax.axis("off")
    figure.colorbar(plt.cm.ScalarMappable(scale, "viridis"), ax=ax, shrink=0.6, label="von Mises stress [MPa]")
    figure.savefig(picture)
    force = couplet.read_csv(out / "solid" / "reactions.csv")["bottom z [N]"][-1]
    print(f"{len(tets)} tetrahedra: the plates press with {force:.2f} N; largest stress {stress.max():.0f} MPa")
    print(f"picture: {picture}")


main()
