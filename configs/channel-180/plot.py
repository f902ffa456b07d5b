#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Mean velocity and fluctuations over the distance to the wall, in wall units.
Usage: plot.py [PICTURE.png], by default out/channel-180.png."""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parents[1] / "client/python"))
import couplet  # noqa: E402

RE_TAU = 180
# Peaks (y+, value) of the spectral simulation of Moser, Kim and Mansour, Phys. Fluids 11 (1999) 943.
PEAKS = {"u rms": (15, 2.66), "v rms": (57, 0.84), "w rms": (37, 1.09), "-uv": (31, 0.72)}


def profiles(folder):
    """Means over the planes parallel to the walls and over both halves: y+, U+, rms of u, v, w and -<uv> by name."""
    series = couplet.find_series(folder)
    last = len(series.times) - 1
    y = np.round(series.centres()[:, 1], 9)
    mean, rms, shear = (series.field(last, name) for name in ("velocity-mean", "velocity-rms", "reynolds-shear"))
    layers = np.unique(y)
    over = {}
    for name, values in (("U", mean[:, 0]), ("u rms", rms[:, 0] ** 2), ("v rms", rms[:, 1] ** 2), ("w rms", rms[:, 2] ** 2),
                         ("-uv", -shear[:, 0])):
        line = np.array([values[y == layer].mean() for layer in layers])
        half = len(layers) // 2
        other = line[::-1][:half] * (-1 if name == "-uv" else 1)
        line = (line[:half] + other) / 2
        over[name] = np.sqrt(line) if "rms" in name else line
    return RE_TAU * layers[: len(layers) // 2], over


def main():
    out = here / "out"
    if not (out / "fluid").exists():
        sys.exit(f"There is no result in {out}. Run the case first (see its README).")
    yplus, over = profiles(out / "fluid")
    figure, axes = plt.subplots(1, 2, figsize=(10, 4), dpi=130, constrained_layout=True)
    axes[0].semilogx(yplus, over["U"], label="Couplet")
    axes[0].semilogx(yplus[yplus < 12], yplus[yplus < 12], "k:", label="y+")
    axes[0].semilogx(yplus[yplus > 20], np.log(yplus[yplus > 20]) / 0.41 + 5.2, "k--", label="ln(y+)/0.41 + 5.2")
    axes[0].set(xlabel="y+", ylabel="U+")
    for name, (place, value) in PEAKS.items():
        line, = axes[1].plot(yplus, over[name], label=name)
        axes[1].plot(place, value, "o", color=line.get_color(), fillstyle="none")
        i = int(np.argmax(over[name]))
        print(f"{name}: largest {over[name][i]:.2f} at y+ = {yplus[i]:.0f}, spectral {value} at {place}")
    axes[1].set(xlabel="y+", ylabel="fluctuations in wall units (circles: spectral peaks)")
    for ax in axes:
        ax.grid(alpha=0.3)
        ax.legend(fontsize=8)
    picture = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else out / "channel-180.png"
    figure.savefig(picture)
    print(f"bulk velocity {np.trapz(over['U'], yplus) / RE_TAU:.2f}, spectral 15.6\npicture: {picture}")


if __name__ == "__main__":
    main()
