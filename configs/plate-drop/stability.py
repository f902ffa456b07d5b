#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Map of the contact rules: energy made in 1000 bounces over contact stiffness and step, from the test that holds them.
Usage: stability.py [PICTURE.png [BUILD]], by default out/contact-map.png; a table goes beside it as .csv."""
import json
import pathlib
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

here = pathlib.Path(__file__).resolve().parent
root = here.parents[1]


def measured(build):
    """Returns {(kappa, dt): (largest and last energy of conserving, of midpoint)}, over that of the start, minus 1."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "map.json"
        subprocess.run([build / "tests/stability/plate/stability_plate_contact", f"--gtest_output=json:{file}"], check=True,
                       capture_output=True)
        test = json.loads(file.read_text())["testsuites"][0]["testsuite"][0]
    points = {}
    for key, value in test.items():
        if key.startswith("map-"):
            kappa, dt = key[4:].replace("e-", "e_").replace("e+", "e").split("-")
            points[float(kappa), float(dt.replace("e_", "e-"))] = [float(v) for v in value.split()]
    return points


def main():
    picture = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here / "out" / "contact-map.png"
    build = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else root / "build"
    picture.parent.mkdir(exist_ok=True)
    points = measured(build)
    kappas, steps = sorted({k for k, _ in points}), sorted({d for _, d in points})
    with open(picture.with_suffix(".csv"), "w") as table:
        table.write("kappa [N/m],dt [s],steps a contact,conserving largest,conserving last,midpoint largest,midpoint last\n")
        for (kappa, dt), values in sorted(points.items()):
            table.write(f"{kappa:g},{dt:g},{np.pi / np.sqrt(kappa) / dt:.3g},{','.join(map(str, values))}\n")
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.6), dpi=120, constrained_layout=True)
    for ax, first, name in zip(axes, (0, 2), ("conserving", "midpoint")):
        grid = np.array([[max(points[k, d][first], -points[k, d][first + 1], 1e-16) for k in kappas] for d in steps])
        image = ax.imshow(np.log10(grid), origin="lower", cmap="RdYlGn_r", vmin=-14, vmax=1, aspect="auto")
        for j, d in enumerate(steps):
            for i, k in enumerate(kappas):
                largest, last = points[k, d][first:first + 2]
                value = largest if largest > -last else last
                ax.text(i, j, f"{value:+.0e}\n{np.pi / np.sqrt(k) / d:.2g} steps", ha="center", va="center", fontsize=7)
        ax.set(xticks=range(len(kappas)), xticklabels=[f"{k:g}" for k in kappas], yticks=range(len(steps)),
               yticklabels=[f"{d:g}" for d in steps], xlabel="contact stiffness / mass [1/s2]", ylabel="step [s]",
               title=f"rule: {name}")
    figure.colorbar(image, ax=axes, label="energy made or lost in 1000 bounces, log10")
    figure.savefig(picture)
    print(f"picture: {picture}, table: {picture.with_suffix('.csv')}")


main()
