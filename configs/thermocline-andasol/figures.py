# SPDX-License-Identifier: Apache-2.0
"""Pictures of the study of a tank of case A or G: figures 5.9, 5.11, 5.12 and 5.13 of the thesis."""
import pathlib
import re

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import couplet

DAY, HOUR = 86400.0, 3600.0


def summary(folder):
    """Returns {quantity: value} of a variant."""
    lines = (folder / "tank" / "summary.csv").read_text().splitlines()[1:]
    return {q: float(v) for q, _, v in (line.split(",") for line in lines)}


def diameters(study, axes, reference):
    """Figure 5.9: stored share of the excess, efficiency and factor of safety over the diameter."""
    found = []
    for folder in study.glob("diameter-*"):
        if (folder / "tank" / "summary.csv").exists():
            found.append((float(re.search(r"-([\d.]+)m$", folder.name).group(1)) / reference, summary(folder)))
    found.sort(key=lambda pair: pair[0])
    x = [pair[0] for pair in found]
    for name, label, style in (("Q_C/Q_excess", "stored / excess energy", "o-"), ("eta_th", "thermal efficiency", "s-")):
        axes.plot(x, [values[name] for _, values in found], style, label=label)
    axes.set(xlabel="diameter / that of the hot tank of the two it replaces", ylabel="%", ylim=(0, 105))
    other = axes.twinx()
    other.plot(x, [values["FoS_static"] for _, values in found], "^--", color="tab:red", label="factor of safety")
    other.set(ylabel="static factor of safety", ylim=(0, 1.1 * max(values["FoS_static"] for _, values in found)))
    handles = [*axes.get_legend_handles_labels()[0], *other.get_legend_handles_labels()[0]]
    axes.legend(handles, [h.get_label() for h in handles], fontsize=7, loc="lower left")
    axes.set_title("diameter (figure 5.9)", fontsize=9)


def stresses(study, axes):
    """Figure 5.11: mean daily extremes of the equivalent stress."""
    for name, colour in (("B", "tab:blue"), ("AR1", "tab:orange"), ("AR2", "tab:green")):
        file = study / name / "tank" / "stress.csv"
        if not file.exists():
            continue
        data = couplet.read_csv(file)
        axes.plot(data["mean daily highest share [-]"], data["z [m]"], color=colour, label=f"{name}, discharged")
        axes.plot(data["mean daily lowest share [-]"], data["z [m]"], "--", color=colour, label=f"{name}, charged")
    axes.axvline(1, color="0.6", lw=0.8)
    axes.set(xlabel="equivalent stress / yield strength (daily extremes, mean)", ylabel="height [m]", xlim=(0, None),
             ylim=(0, None))
    axes.legend(fontsize=7)
    axes.set_title("wall stress (figure 5.11)", fontsize=9)


def charge(study, axes):
    """Figure 5.12: the wall during the charge of the profile day, every two hours."""
    for name, style in (("B", "-"), ("CO2", ":")):
        file = study / name / "tank" / "profiles.csv"
        if not file.exists():
            continue
        data, plant = couplet.read_csv(file), couplet.read_csv(study / name / "tank" / "plant.csv")
        times = np.unique(data["time [s]"])
        flow = np.interp(times, plant["time [s]"], plant["tank flow [kg/s]"])
        charging = times[flow < 0]
        shown = charging[:: 2] if len(charging) > 1 else charging
        for k, time in enumerate(shown):
            at = data["time [s]"] == time
            axes.plot(data["wall [degC]"][at], data["z [m]"][at], style, color=plt.cm.viridis(k / max(len(shown) - 1, 1)),
                      label=f"{name} {time % DAY / HOUR:.0f} h" if style == "-" else (name if k == 0 else None))
    axes.set(xlabel="wall temperature [°C]", ylabel="height [m]", ylim=(0, None))
    axes.legend(fontsize=7)
    axes.set_title("charge of 9 July (figure 5.12)", fontsize=9)


def thickness(study, axes):
    """Figure 5.13: thickness of the thermocline, summer and winter."""
    for name, label in (("B", "June to August"), ("S1", "December to February")):
        file = study / name / "tank" / "plant.csv"
        if not file.exists():
            continue
        data = couplet.read_csv(file)
        # Skips the first month, in which the tank starts up.
        start = (31 if name == "B" else 30) * DAY
        keep = data["time [s]"] > start
        axes.plot((data["time [s]"][keep] - start) / DAY, data["thermocline thickness [m]"][keep], lw=0.7, label=label)
    axes.set(xlabel="day", ylabel="thickness of the thermocline [m]", xlim=(0, 92), ylim=(0, None))
    axes.legend(fontsize=7)
    axes.set_title("thermocline (figure 5.13)", fontsize=9)


def picture(case_folder, reference_diameter, title):
    """Draws out/<case>.png from out/study and returns its path."""
    study = pathlib.Path(case_folder) / "out" / "study"
    if not (study / "B" / "tank" / "summary.csv").exists():
        raise SystemExit(f"There is nothing in {study}: run couplet study {case_folder}/case.yaml first.")
    figure, axes = plt.subplots(2, 2, figsize=(11, 8), layout="constrained")
    diameters(study, axes[0, 0], reference_diameter)
    stresses(study, axes[0, 1])
    charge(study, axes[1, 0])
    thickness(study, axes[1, 1])
    figure.suptitle(title)
    file = pathlib.Path(case_folder) / "out" / f"{pathlib.Path(case_folder).name}.png"
    figure.savefig(file, dpi=110)
    return file
