# SPDX-License-Identifier: Apache-2.0
"""Measures of the reed valve in three dimensions and of its slice: lift, frequency, energy, effective flow area, other structures in the reed's place."""
import re

import couplet
import numpy as np

START = 0.3e-3  # lift at rest [m]

POINTS = ("; where the source's control points lie is unknown: its instants at a lift of 0.08 d = 2.79 mm at point 2 rule out that 3.89 mm is the tip and point 2 the centre, "
          "for the first mode lifts the tip 1.59 times as far as the centre; on 46 k cells the tip is 39 % too high")


def columns(run, file, *names):
    rows = couplet.read_csv(run.folder / file)
    return [rows["time [s]"], *(rows[name] for name in names)]


def valve(job, name="coarse", *more):
    """configs/reed-valve, 40 ms: about 15 minutes."""
    return job.coupled_run(job.root / "configs/reed-valve/case.yaml", f"reed-valve-{name}", more, ranks=(1, 1, 1, 1), timeout=20000)


def first_cycle(t, lift):
    """Largest lift and its time, least lift after it and its time; the cycle goes from the start to that least lift."""
    top = int(np.argmax(lift))
    after = top + int(np.argmin(lift[top:]))
    return lift[top], t[top], lift[after], t[after]


def lifts(job):
    run = valve(job)
    t, *z = columns(run, "reed/probes.csv", *(f"point-{i} z [m]" for i in (1, 2, 3)))
    tops = [1000 * (START + v.max()) for v in z]
    met = abs(tops[0] / 3.89 - 1) <= 0.1
    return (f"{tops[0]:.2f} mm at point 1 (tip), {tops[1]:.2f} mm at point 2 (centre), {tops[2]:.2f} mm at point 3, at {1000 * t[np.argmax(z[0])]:.1f} ms; "
            f"at point 1 {100 * (tops[0] / 3.89 - 1):+.0f} %, at point 2 {100 * (tops[1] / 3.89 - 1):+.0f} % of 3.89 mm{'' if met else POINTS}"), met


def frequency(job):
    t, z = columns(valve(job), "reed/probes.csv", "point-1 z [m]")
    _, top, least, end = first_cycle(t, z)
    f = 1 / end
    return f"{f:.1f} Hz ({100 * (f / 56.3 - 1):+.0f} %): open widest at {1000 * top:.1f} ms, least lift {1000 * (least + START):.2f} mm at {1000 * end:.1f} ms; chamber and start are assumptions (the drawing is missing)", abs(f / 56.3 - 1) <= 0.1


def energy(job):
    t, mismatch, strain, kinetic = columns(valve(job), "reed/energies.csv", "mismatch [J]", "strain [J]", "kinetic [J]")
    off = np.abs(mismatch).max() / (strain + kinetic).max()
    return f"{100 * off:.2g} % of the largest energy", off <= 0.01


AIR = tuple(f"participants.fluid.{key}" for key in ("compressibility.speed-of-sound=346", "compressibility.upstream-volume=1e-4", "boundaries.outlet.absorbing=true"))


def meshed(words):
    """The same parameters for the mesh of the fluid and of the mover; '~' for the file's own, 46 k cells."""
    return tuple(f"participants.{p}.mesh-parameters={words}" for p in ("fluid", "mover"))


# name: (words, settings)
IN_AIR = {"air": ("6.8 k cells", ()), "air-coarser": ("3.3 k cells", meshed("{size: 6e-3, growth: 1.6}")), "air-short": ("6.8 k cells, steps of 25 us", ("simulation.time-step=25 us",))}


def landing(job, name):
    """In air that compresses, with 100 cm^3 of it upstream: (lift of point 1 [mm], its time [ms], frequency [Hz], lands, opens again, words)."""
    run = valve(job, name, *AIR, *IN_AIR[name][1])
    t, z = columns(run, "reed/probes.csv", "point-1 z [m]")
    s, force = columns(run, "reed/contact.csv", "force [N]")
    highest, top, least, end = first_cycle(t, z)
    lift, f = 1e3 * (highest + START), 1 / end
    opened = t[z > 1e-3].min() if (z > 1e-3).any() else np.inf
    lands = s[(force > 0) & (s > opened)]
    again = lands.size > 0 and bool((z[t > lands[0]] > 1e-3).any())
    where = f"lands at {1e3 * lands[0]:.1f} ms and {'opens again' if again else 'stays'}" if lands.size else f"does not land in 40 ms, least lift {1e3 * (least + START):.2f} mm"
    words = f"{lift:.2f} mm at point 1 ({100 * (lift / 3.07 - 1):+.0f} %) at {1e3 * top:.1f} ms, {f:.1f} Hz ({100 * (f / 57.9 - 1):+.0f} %), {where}"
    return lift, f, lands.size > 0 and again, words


def closing(job):
    """Whether the reed comes back to its seat, on two meshes and with two steps."""
    found = {name: landing(job, name) for name in IN_AIR}
    lift, f, returns, _ = found["air"]
    return ("; ".join(f"{IN_AIR[name][0]}: {words}" for name, (*_, words) in found.items()),
            returns and abs(lift / 3.07 - 1) <= 0.1 and abs(f / 57.9 - 1) <= 0.1)


def areas(job, run):
    """(lift of point 2 [m], effective flow area of the whole valve [mm^2]) while it opens for the first time."""
    t, area = columns(run, "fluid/flow-areas.csv", "valve effective area [m^2]")
    s, z = columns(run, "reed/probes.csv", "point-2 z [m]")
    lift = np.interp(t, s, z) + START
    top = int(np.argmax(lift)) + 1
    return lift[:top], 2e6 * area[:top]


def fine_areas(job):
    """At lifts of point 2 of 1, 2, 3 mm, opening, on 6.8 k and 46 k cells; how far each curve leaves the straight lines between points 0.25 mm apart."""
    texts, apart, rough = [], 0, 0
    curves = {"6.8 k": areas(job, valve(job)), "46 k cells": areas(job, fine(job))}
    for at in (1e-3, 2e-3, 3e-3):
        coarse, finer = (np.interp(at, *curve) for curve in curves.values())
        apart = max(apart, abs(coarse / finer - 1))
        texts.append(f"{1000 * at:g} mm {coarse:.0f} and {finer:.0f} mm^2")
    for lift, area in curves.values():
        inside = (lift > 1e-3) & (lift < 3e-3)
        knots = np.arange(1e-3, 3.01e-3, 0.25e-3)
        rough = max(rough, np.abs(area[inside] / np.interp(lift[inside], knots, np.interp(knots, lift, area)) - 1).max())
    return f"opening, on {' and '.join(curves)}: {', '.join(texts)}; {100 * apart:.0f} % apart; each within {100 * rough:.1f} % of lines between points 0.25 mm apart", apart <= 0.1 and rough <= 0.03


def fine(job):
    """46 k cells, until it has nearly closed: about an hour."""
    return valve(job, "fine", *meshed("~"), "simulation.end-time=22.6 ms", "simulation.output.interval=0")


def fine_lifts(job):
    run = fine(job)
    t, *z = columns(run, "reed/probes.csv", *(f"point-{i} z [m]" for i in (1, 2)))
    tops = [1000 * (START + v.max()) for v in z]
    _, top, least, end = first_cycle(t, z[0])
    return (f"{tops[0]:.2f} mm at point 1 ({100 * (tops[0] / 3.89 - 1):+.0f} %), {tops[1]:.2f} mm at point 2 ({100 * (tops[1] / 3.89 - 1):+.0f} %), at {1000 * top:.1f} ms; "
            f"least lift {1000 * (least + START):.2f} mm at {1000 * end:.1f} ms, {1 / end:.1f} Hz ({100 * (1 / end / 56.3 - 1):+.0f} %)"), abs(tops[0] / 3.89 - 1) <= 0.1


STIFF = (0.1, 1, 1e2, 1e4)  # of the seat of configs/reed-slice


def any_stiffness(job):
    """The slice pressed shut as in coupling_reed_lands_*, the seat of the plate softer and stiffer."""
    texts, met = [], True
    for factor in STIFF:
        sets = [f"participants.reed.contact.scale={1e-4 * factor:g}", "simulation.end-time=3.8e-3", "simulation.output.interval=0",
                'participants.fluid.boundaries.outlet.pressure="t<0.003?1000*sin(pi*t/0.003):0"']
        run = job.coupled_run(job.root / "configs/reed-slice/case.yaml", f"reed-stiffness-{factor:g}", sets, timeout=1200)
        s, force, deep = columns(run, "reed/contact.csv", "force [N]", "penetration [m]")
        t, off, strain, kinetic = columns(run, "reed/energies.csv", "mismatch [J]", "strain [J]", "kinetic [J]")
        touching = s[force > 0]
        share = np.abs(off).max() / (strain + kinetic).max()
        passes = re.search(r"([\d.]+) (?:passes|iterations) per step", run.log)
        met &= touching.size > 0 and share < 1e-6
        texts.append(f"{factor:g} times: " + (f"{1e3 * touching[0]:.2f} to {1e3 * touching[-1]:.2f} ms, {1e6 * deep.max():.2g} um deep, " if touching.size else "does not land, ")
                     + f"energies to {share:.0e}" + (f", {passes[1]} passes per step" if passes else ""))
    return "; ".join(texts), met


def swapped(job):
    """The slice with the plate, with the modes of a solid, with the solid at large strain."""
    here = job.root / "configs/reed-slice"
    shapes = job.case_run(here / "shapes.yaml", job.scratch / "reed-shapes", (), {}, 600)
    runs = {"plate": job.coupled_run(here / "case.yaml", "reed-slice-plate", (), timeout=3600),
            "modes of the solid": job.coupled_run(here / "modes.yaml", "reed-slice-modes", (f"participants.reed.modes.file={shapes.folder}/reed/modes.h5",), timeout=3600),
            "solid at large strain": job.coupled_run(here / "solid.yaml", "reed-slice-solid", (), timeout=7200)}
    found = {}
    for name, run in runs.items():
        t, z = columns(run, "reed/probes.csv", "tip z [m]")
        gap = 1000 * (z + START)
        first = int(np.argmax(gap[t < 0.01]))
        low = first + int(np.argmin(gap[first:(t < 0.0135).sum()]))
        second = low + int(np.argmax(gap[low:]))
        found[name] = gap[first], gap[low], gap[second], 1 / (t[second] - t[first])
    off = max(abs(v[i] / found["plate"][i] - 1) for v in found.values() for i in range(4))
    return "; ".join(f"{name}: {v[0]:.3f}, {v[1]:.3f}, {v[2]:.3f} mm, {v[3]:.0f} Hz" for name, v in found.items()) + f" (first peak, trough, second peak): {100 * off:.1f} % apart", off <= 0.05


def landings(job):
    """What coupling_reed_lands_* print."""
    passed, total, _, output = job.ctest("^coupling_reed_lands_(plate|modes|solid)$")
    times = np.array([[1e3 * float(v) for v in found] for found in re.findall(r"touches from ([\d.e-]+) to ([\d.e-]+) s", output)])
    deepest = [1e6 * float(v) for v in re.findall(r"springs of the seat let it +([\d.e-]+) m", output)]
    off = max(np.ptp(times[:, i]) / times[:, i].min() for i in (0, 1))
    return (f"{passed} of {total} tests; in the seat from {times[:, 0].min():.2f} to {times[:, 0].max():.2f} ms on, until {times[:, 1].min():.2f} to {times[:, 1].max():.2f} ms "
            f"({100 * off:.0f} % apart), at most {max(deepest):.1f} um deep"), passed == total == 3 and off <= 0.05
