#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A sheet that falls on its seat: places, forces, energies. Usage: plot.py [PICTURE.png], by default out/plate-drop.png."""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parents[1] / "client/python"))
import couplet  # noqa: E402


def main():
    out, picture = couplet.result_of(here, "sheet")
    probes, seat, energies = (couplet.read_csv(out / "sheet" / f"{name}.csv") for name in ("probes", "contact", "energies"))
    time = 1e3 * probes["time [s]"]
    figure, axes = plt.subplots(3, 1, figsize=(9, 8), dpi=120, sharex=True, constrained_layout=True)
    for name in ("middle", "corner"):
        axes[0].plot(time, 1e3 * probes[f"{name} z [m]"], lw=0.9, label=name)
    axes[0].set(ylabel="displacement [mm]", title="a steel sheet of 200 x 200 x 1 mm falls on a tilted seat with a hole")
    axes[1].plot(time, seat["force [N]"], lw=0.8, color="tab:red")
    axes[1].set(ylabel="force of the seat [N]")
    for column, label in (("kinetic [J]", "kinetic"), ("strain [J]", "strain"), ("gravity [J]", "gravity"), ("seat [J]", "seat")):
        axes[2].plot(time, 1e3 * energies[column], lw=0.8, label=label)
    total = sum(energies[c] for c in ("kinetic [J]", "strain [J]", "gravity [J]", "seat [J]"))
    axes[2].plot(time, 1e3 * total, "k--", lw=1, label="sum")
    axes[2].set(ylabel="energy [mJ]", xlabel="time [ms]")
    for one in (axes[0], axes[2]):
        one.legend(fontsize=8, ncol=5)
    for one in axes:
        one.grid(alpha=0.3)
    figure.savefig(picture)
    swing = abs(energies["gravity [J]"]).max()
    print(f"mismatch of the energies: at most {abs(energies['mismatch [J]']).max():.2e} J of {swing:.3g} J")
    print(f"picture: {picture}")


main()
