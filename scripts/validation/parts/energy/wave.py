# SPDX-License-Identifier: Apache-2.0
"""The suddenly pulled bar: overshoot and energies of each time scheme beside the closed form."""
import couplet

SCHEMES = {"trapezoidal": "{type: trapezoidal}", "Bathe": "{type: bathe}", "generalised-alpha 0.5": "{type: generalised-alpha, spectral-radius: 0.5}",
           "three-point": "{type: three-point}", "Euler": "{type: euler}"}
LOAD, HEIGHT, DENSITY, YOUNG, LENGTH, END = 1000.0, 0.01, 1000.0, 1e6, 1.0, 0.06
SPEED = (YOUNG / DENSITY) ** 0.5
BACK = SPEED * END - LENGTH  # way of the reflected front [m]
KINETIC = 0.5 * DENSITY * (LOAD / (DENSITY * SPEED)) ** 2 * HEIGHT * (LENGTH - BACK)
STRAIN = 0.5 * LOAD**2 / YOUNG * HEIGHT * (LENGTH - BACK + 4 * BACK)


def wave(job, scheme):
    run = job.alone("wave-bar", (f"participants.solid.time-scheme={SCHEMES[scheme]}",))
    probes = couplet.read_csv(run.folder / "solid" / "probes.csv")
    energies = couplet.read_csv(run.folder / "solid" / "energies.csv")
    before = 0.045  # the reflected front is not there yet
    most = max(s for t, s in zip(probes["time [s]"], probes["middle stress-xx [Pa]"]) if t < before) / LOAD - 1
    whole = KINETIC + STRAIN
    off = (energies["kinetic [J]"][-1] + energies["strain [J]"][-1]) / whole - 1
    least = min(lost - before for before, lost in zip([0.0, *energies["lost by the scheme [J]"]], energies["lost by the scheme [J]"])) / whole
    return (f"overshoot {100 * most:.0f} %; energy {100 * off:+.2f} % of the closed form, lost "
            f"{100 * energies['lost by the scheme [J]'][-1] / whole:.2f} %, least loss of a step {least:+.1e}"), (
                None if scheme == "Euler" else abs(off) <= 0.01 and least >= -1e-8)
