#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The tank's wall as solid_solver sees it (thermoelastic finite volumes, 400 x 3 cells of an axisymmetric wedge) under the
temperature and the pressure that the tank's rings have after the first day: its hoop stress against the rings'.
One way: the filler does not answer to the displacement of this wall. Run the case first.
Usage: wall.py [--tank out/tank] [--bin build/bin] [--picture FILE.png]"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "scripts"))
import couplet_series as couplet  # noqa: E402

RADIUS, TOP, THICKNESS = 9.1, (1.8, 4.66, 7.52, 10.38, 13.24, 99), (0.0286, 0.019, 0.0156, 0.0095, 0.0079, 0.019)
CASE = """simulation: {{name: wall, end-time: 1 s, time-step: 1 s, output: {{folder: out}}}}
participants:
  wall:
    program: solid_solver
    mesh: {mesh}
    analysis: static
    material:
      density: 7850 kg/m^3
      youngs-modulus: 192 GPa
      poissons-ratio: 0.3
      expansion: {{of: T, at: [477, 577], values: [1.39e-5, 1.49e-5]}}
    gravity: [0, 0, -9.81]
    temperature: {{of: z, at: [{z}], values: [{temperature}]}}
    thermal-expansion: {{reference-temperature: 204 degC}}
    boundaries:
      inside: {{type: pressure, value: {{of: z, at: [{z}], values: [{pressure}]}}}}
      outside: {{type: free}}
      bottom: {{type: symmetry}}
      top: {{type: free}}
      side-a: {{type: symmetry}}
      side-b: {{type: symmetry}}
"""


def rings(file, time):
    rows = np.genfromtxt(file, delimiter=",", skip_header=1)
    part = rows[np.isclose(rows[:, 0], time)]
    if not len(part):
        sys.exit(f"{file} has no profile at t = {time:g} s.")
    return part[:, 1], part[:, 2] + 273.15, part[:, 3]


def thickness(z):
    return np.array(THICKNESS)[np.searchsorted(TOP, z)]


def solve(z, temperature, hoop, programs):
    """Height and mean hoop stress of each row of cells [Pa]."""
    text = lambda values: ", ".join(f"{v:.8g}" for v in values)
    with tempfile.TemporaryDirectory(prefix="couplet-wall-") as folder:
        case = pathlib.Path(folder) / "case.yaml"
        case.write_text(CASE.format(mesh=HERE / "wall.geo", z=text(z), temperature=text(temperature),
                                    pressure=text(hoop * thickness(z) / RADIUS)))
        result = subprocess.run([str(programs / "solid_solver"), str(case)], capture_output=True, text=True)
        if result.returncode:
            sys.exit(result.stdout + result.stderr)
        series = couplet.find_series(case.parent / "out" / "wall")
        last = len(series.times) - 1
        centres, stress = series.centres(), series.field(last, "stress-yy")
    rows = np.round(centres[:, 2], 6)
    heights = np.unique(rows)
    return heights, np.array([stress[rows == h].mean() for h in heights])


def compare(tank, programs):
    """Height-averaged difference and difference of the maximum, of the finite-volume wall's; and the profiles."""
    z, temperature, hoop = rings(pathlib.Path(tank) / "wall.csv", 86400)
    heights, stress = solve(z, temperature, hoop, pathlib.Path(programs))
    # The same points for both, away from the ends that the rings do not know and from the joints' single cells.
    joint = np.min(np.abs(heights[:, None] - np.array(TOP[:5])), axis=1) < 0.03
    wet = (heights < 12.76) & ~joint
    ours = np.interp(heights[wet], z, hoop)
    mean = np.abs(ours - stress[wet]).mean() / stress[wet].mean()
    place = np.argmax(stress * wet)
    return {"mean": mean, "maximum": abs(hoop[z < 12.76].max() / stress[wet].max() - 1), "at": heights[place],
            "at 3.4 m": abs(np.interp(3.4, z, hoop) / np.interp(3.4, heights, stress) - 1)}, (z, hoop, heights, stress)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tank", type=pathlib.Path, default=HERE / "out" / "tank")
    parser.add_argument("--bin", type=pathlib.Path, default=HERE.parents[1] / "build" / "bin")
    parser.add_argument("--picture", type=pathlib.Path)
    arguments = parser.parse_args()
    found, (z, hoop, heights, stress) = compare(arguments.tank, arguments.bin)
    print(f"rings against finite volumes: mean difference {100 * found['mean']:.1f} %, at the maximum "
          f"{100 * found['maximum']:.1f} % (z = {found['at']:.2f} m), at 3.4 m {100 * found['at 3.4 m']:.1f} %")
    if arguments.picture:
        import matplotlib
        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
        figure, ax = plt.subplots(figsize=(7, 4), dpi=130, constrained_layout=True)
        ax.plot(z, hoop / 1e6, label="rings")
        ax.plot(heights, stress / 1e6, label="finite volumes")
        ax.set(xlabel="height [m]", ylabel="hoop stress after the first day [MPa]")
        ax.grid(alpha=0.3)
        ax.legend()
        figure.savefig(arguments.picture)
        print(f"picture: {arguments.picture}")


if __name__ == "__main__":
    main()
