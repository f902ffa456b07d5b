#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Motion of the tip beside a finite-element computation. Usage: plot.py [PICTURE.png [FOLDER ...]], by default
out/vibrating-cantilever.png of out/solid."""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import vibration


def main():
    out = vibration.here / "out"
    picture = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else out / "vibrating-cantilever.png"
    folders = [pathlib.Path(f) for f in sys.argv[2:]] or [out / "solid"]
    figure, ax = plt.subplots(figsize=(9, 4), dpi=130, constrained_layout=True)
    t, y = vibration.reference()
    ax.plot(t, y, "k--", lw=1, label="finite elements (3-D, trapezoidal, 0.02 s)")
    for folder in folders:
        if not (folder / "probes.csv").exists():
            sys.exit(f"There is no result in {folder}. Run the case first (see its README).")
        t, y = vibration.history(folder)
        period, decay, _ = vibration.fit(t, y)
        ax.plot(t, y, lw=1.2, label=f"Couplet ({folder.parent.name}): {period:.3f} s, decay {100 * decay:.3f} % a period")
    ax.set(xlabel="t [s]", ylabel="tip [m]", xlim=(0, 100), ylim=(-0.11, 0.145))
    ax.legend(fontsize=8, loc="upper center", ncol=2)
    ax.grid(alpha=0.3)
    figure.savefig(picture)
    print(f"picture: {picture}")


main()
