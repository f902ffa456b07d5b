#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Stretch along the axis and shear of its sections at K = 10, as figures 3.12 and 3.13 of the thesis, for beams 10, 20 and 40 sides long.
Usage: maps.py [PICTURE.png] [--across N] [--build build]: runs solid_solver three times, about a minute with 4 cells across; by default
out/bent-beam.png."""
import argparse
import math
import pathlib
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "client/python"))
import couplet  # noqa: E402
from couplet.runs import environment  # noqa: E402

SIDE, SIDES = 0.2, (10, 20, 40)
S = "participants.solid."


def settings(across, sides):
    """--set values of a beam so many sides long, K = 10 in one command."""
    length = SIDE * sides
    pull = 10 * 15.293e6 * (SIDE**4 / 12) / (SIDE**2 * length**2) / math.sqrt(2)
    return ("%smesh-parameters={n: %d, m: %d, L: %g}" % (S, across, across * sides, length),
            f"{S}boundaries.tip.value=[{pull!r}*t, {pull!r}*t, 0]", f"{S}probes={{tip: {{point: [0, 0, {length:g}]}}}}",
            S + "output={strain: true}")


class Section:
    """Cells of the section through the axis and the diagonal of the load: place, stretch of fibres that lay along the axis, angle by
    which these and the section's diagonal have left the right angle [degrees]."""

    def __init__(self, folder, across):
        series = couplet.find_series(folder / "solid")
        last, centres = len(series.times) - 1, series.centres()
        on = np.abs(centres[:, 0] - centres[:, 1]) < 0.25 * SIDE / across
        self.x = centres[on]
        points = series.file["mesh/coordinates"][...] + series.field(last, "displacement") if "coordinates" not in series.file[
            "steps"][series.steps[last]] else series.coordinates(last)
        self.now = np.array([points[cell].mean(axis=0) for cell, chosen in zip(series.cells, on) if chosen])
        green = np.zeros((on.sum(), 3, 3))
        for i, a in enumerate("xyz"):
            for j, b in enumerate("xyz"):
                green[:, i, j] = series.field(last, f"strain-{min(a, b)}{max(a, b)}")[on]
        C = 2 * green + np.eye(3)  # F^T F
        s = np.array([1, 1, 0]) / math.sqrt(2)
        along, cross = C[:, 2, 2], np.einsum("i,nij,j->n", s, C, s)
        self.stretch = np.sqrt(along)
        self.angle = np.degrees(math.pi / 2 - np.arccos(np.einsum("i,nij->nj", s, C)[:, 2] / np.sqrt(along * cross)))  # (3.8)
        # Value on the axis: mean over the adjacent cells, weighted by height.
        z = np.unique(np.round(self.x[:, 2], 9))
        middle = np.abs(self.x[:, 0]) < 0.75 * SIDE / across
        self.growth = float(np.mean([self.stretch[middle & (np.abs(self.x[:, 2] - h) < 1e-6)].mean() for h in z]) - 1)


def picture(sections, file):
    figure, axes = plt.subplots(2, len(sections), figsize=(10, 7), dpi=130, constrained_layout=True, squeeze=False)
    for row, (name, values) in enumerate((("stretch of the axis' fibres", "stretch"), ("shear of the sections [degrees]", "angle"))):
        low = min(getattr(s, values).min() for s in sections.values())
        high = max(getattr(s, values).max() for s in sections.values())
        for ax, (sides, section) in zip(axes[row], sections.items()):
            across = (section.now[:, 0] + section.now[:, 1]) / math.sqrt(2)
            drawn = ax.tripcolor(across, section.now[:, 2], triangles(section), getattr(section, values), vmin=low, vmax=high,
                                 shading="gouraud", cmap="viridis")
            ax.set(aspect="equal", xlabel="along the load [m]", title=f"L = {sides} sides")
        figure.colorbar(drawn, ax=axes[row], label=name, shrink=0.8)
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file)


def triangles(section):
    """Returns the triangles of the grid of cell centers."""
    s, z = np.round(section.x[:, 0], 9), np.round(section.x[:, 2], 9)
    columns, rows = np.unique(s), np.unique(z)
    at = -np.ones((len(rows), len(columns)), int)
    at[np.searchsorted(rows, z), np.searchsorted(columns, s)] = np.arange(len(s))
    a, b, c, d = at[:-1, :-1].ravel(), at[:-1, 1:].ravel(), at[1:, 1:].ravel(), at[1:, :-1].ravel()
    return np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def text(section):
    return f"axis {100 * section.growth:+.2f} % longer, stretch {section.stretch.min():.3f} to {section.stretch.max():.3f}, " \
           f"shear up to {np.abs(section.angle).max():.1f} degrees"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("picture", nargs="?", type=pathlib.Path, default=HERE / "out/bent-beam.png")
    parser.add_argument("--across", type=int, default=4)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    options = parser.parse_args()
    sections = {}
    with tempfile.TemporaryDirectory(prefix="couplet-bent-beam-") as scratch:
        for sides in SIDES:
            folder = pathlib.Path(scratch) / str(sides)
            sets = [w for s in (*settings(options.across, sides), f"simulation.output.folder={folder}") for w in ("--set", s)]
            subprocess.run([options.build.resolve() / "bin" / "solid_solver", HERE / "case.yaml", *sets], check=True, env=environment(),
                           stdout=subprocess.DEVNULL)
            sections[sides] = Section(folder, options.across)
            print(f"L = {sides} sides: {text(sections[sides])}", flush=True)
    options.picture.parent.mkdir(exist_ok=True)
    picture(sections, options.picture)
    print(f"picture: {options.picture}")


if __name__ == "__main__":
    main()
