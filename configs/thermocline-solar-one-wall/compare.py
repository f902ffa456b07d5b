#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Hoop stress of the coupled finite-volume wall after the first day against that of the rings.
Usage: compare.py [--coupled out] [--rings ../thermocline-solar-one/out/tank] [--picture FILE.png]"""
import argparse
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "client/python"))
import couplet  # noqa: E402

JOINTS, DAY, BED = (1.8, 4.66, 7.52, 10.38), 86400, 12.76


def rings(folder):
    rows = np.genfromtxt(pathlib.Path(folder) / "wall.csv", delimiter=",", skip_header=1)
    part = rows[np.isclose(rows[:, 0], DAY)]
    return part[:, 1], part[:, 3]


def finite_volumes(folder):
    """Heights of the rows of cells and their mean hoop stress (the wedge is cut at y = 0: stress yy) [Pa]."""
    series = couplet.find_series(pathlib.Path(folder) / "wall")
    stress = series.field(series.nearest(DAY), "stress-yy")
    rows = np.round(series.centres()[:, 2], 6)
    heights = np.unique(rows)
    return heights, np.array([stress[rows == h].mean() for h in heights])


def compare(coupled, alone):
    """Differences relative to the finite volumes: mean over the height of the bed, of the largest stress, at 3.4 m."""
    z, ours = rings(alone)
    heights, stress = finite_volumes(coupled)
    # Where plates meet, the mesh has one cell of changing thickness, which the rings lack.
    wet = (heights < BED) & (np.min(np.abs(heights[:, None] - np.array(JOINTS)), axis=1) > 0.03)
    gap = np.abs(np.interp(heights[wet], z, ours) - stress[wet])
    at = np.interp(3.4, heights, stress)
    return {"mean": gap.mean() / stress[wet].mean(), "maximum": abs(ours[z < BED].max() / stress[wet].max() - 1),
            "at 3.4 m": abs(np.interp(3.4, z, ours) / at - 1), "stress at 3.4 m": at,
            "place": heights[wet][np.argmax(stress[wet])]}, (z, ours, heights, stress)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--coupled", type=pathlib.Path, default=HERE / "out")
    parser.add_argument("--rings", type=pathlib.Path, default=HERE.parent / "thermocline-solar-one" / "out" / "tank")
    parser.add_argument("--picture", type=pathlib.Path)
    arguments = parser.parse_args()
    found, (z, ours, heights, stress) = compare(arguments.coupled, arguments.rings)
    print(f"rings against finite volumes: mean difference {100 * found['mean']:.1f} %, of the maxima "
          f"{100 * found['maximum']:.1f} % (at z = {found['place']:.2f} m), at 3.4 m {100 * found['at 3.4 m']:.1f} % "
          f"({found['stress at 3.4 m'] / 1e6:.1f} MPa)")
    if arguments.picture:
        import matplotlib
        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
        figure, ax = plt.subplots(figsize=(7, 4), dpi=130, constrained_layout=True)
        ax.plot(z, ours / 1e6, label="rings")
        ax.plot(heights, stress / 1e6, label="finite volumes, coupled")
        ax.set(xlabel="height [m]", ylabel="hoop stress after the first day [MPa]")
        ax.grid(alpha=0.3)
        ax.legend()
        figure.savefig(arguments.picture)
        print(f"picture: {arguments.picture}")


if __name__ == "__main__":
    main()
