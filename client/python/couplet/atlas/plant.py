# SPDX-License-Identifier: Apache-2.0
"""Map of the tank's plant: its control ends a charge or a discharge where the front leaves the bed, which few cells smear."""
import math
import re

from .atlas import Axis, Map

# A tank of 4 hours for Andasol's plant: a bed without wall, ground and losses, under a clear sky; days 3 to 5 are reported.
CASE = """simulation: {{name: plant, end-time: 5 day, time-step: 15 min, output: {{folder: out, interval: 5 day}}}}
participants:
  tank:
    program: thermocline
    diameter: 30.5 m
    fluid: {{type: solar-salt}}
    bed:
      cells: {cells}
      advection: {advection}
      initial-temperature: 290 degC
      layers: [{{height: 13.16 m, porosity: 0.22, diameter: 15 mm}}]
    ambient: {{type: clear-sky, latitude: 37 deg, altitude: 1100 m, from: 06-21}}
    flow:
      type: plant
      electric-power: 50 MW
      block-efficiency: 0.38
      field-area: 510120 m^2
      field-efficiency: 0.70
      hot: 390 degC
      cold: 290 degC
      cut-off: {margin} K
      restart: {restart} K
    report: {{run-in: 2 day}}
"""
FINE = 800  # cells of the reference, which has the limited scheme


def discharged(advection, cells, margin, runner):
    """Exergy per day that the tank gives to the power block [MWh]."""
    folder = runner.folder("plant", advection, cells, margin)
    code, doubted = runner.alone("thermocline", folder, {"case.yaml": CASE.format(cells=int(cells), advection=advection, margin=margin, restart=0.6 * margin)})
    summary = folder / "out" / "tank" / "summary.csv"
    found = re.search(r"^B_D,[^,]*,(.+)$", summary.read_text(), re.M) if code == 0 else None
    return (float(found.group(1)) if found else math.nan), code, doubted


def run(panel, cells, margin, runner):
    value, code, doubted = discharged(panel, cells, margin, runner)
    fine, *_ = runner.once(margin, lambda: discharged("tvd", FINE, margin, runner))
    return value / fine, code, doubted


MAPS = [
    Map("tank-plant", "Tank: a plant whose control sees the front", "exergy discharged per day, over that of 800 cells",
        Axis("cells of the bed", [15, 30, 60, 120, 240]), Axis("margin of the cut-off [K]", [2, 5, 15, 40]), ["upwind", "tvd", "implicit"], run, lambda v: abs(v - 1),
        about="""Mechanism: a charge or a discharge ends when the outlet differs by the margin, while the middle of the front is still inside the bed. Few cells,
the upwind scheme and long implicit steps spread the front, so that more of the bed stays unused: 2 z sigma of its height, z standard deviations of
a normal distribution beyond which the margin's share of the range lies, sigma^2 = dz H (upwind), plus v dt H (implicit), less what film and grains spread anyway. The run counts that as the error of its mesh and warns from 0.15 on."""),
]
