#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Wall temperature and hoop stress through both days (thesis figure 5.6). Usage: plot.py [PICTURE.png]"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

here = pathlib.Path(__file__).resolve().parent


def main():
    file = here / "out" / "tank" / "wall.csv"
    if not file.exists():
        sys.exit(f"There is no {file}. Run the case first (see its README).")
    picture = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here / "out" / "solar-one.png"
    rows = np.genfromtxt(file, delimiter=",", skip_header=1)
    times = np.unique(rows[:, 0])
    figure, axes = plt.subplots(2, 2, figsize=(10, 7), dpi=130, constrained_layout=True, sharex=True)
    for day in (0, 1):
        chosen = [t for t in times if 24 * day <= t / 3600 <= 24 * day + 18]
        colours = plt.cm.viridis(np.linspace(0, 0.9, len(chosen)))
        for t, colour in zip(chosen, colours):
            part = rows[rows[:, 0] == t]
            hours = t / 3600 - 24 * day
            style = dict(color=colour, ls="-" if hours <= 9 else "--", lw=1.2, label=f"+{hours:.0f} h")
            axes[0, day].plot(part[:, 1], part[:, 2], **style)
            axes[1, day].plot(part[:, 1], part[:, 3] / part[:, 5], **style)
        axes[0, day].set(title=f"day {day + 1}: charge from 9 am (lines), discharge from 6 pm (dashes)",
                         ylabel="wall temperature [degC]")
        axes[1, day].set(xlabel="height [m]", ylabel="hoop stress / yield strength")
        axes[0, day].legend(fontsize=7)
    for ax in axes.flat:
        ax.grid(alpha=0.3)
        ax.title.set_fontsize(9)
    figure.savefig(picture)
    last = rows[rows[:, 0] == 24 * 3600]
    print(f"hoop stress at 3.4 m after the first day: {np.interp(3.4, last[:, 1], last[:, 3]) / 1e6:.1f} MPa")
    print(f"picture: {picture}")


main()
