# SPDX-License-Identifier: Apache-2.0
"""The reed valve in three dimensions and its slice: motion of the mesh, lift, frequency, flow area, contact, other
structures in the reed's place."""
import re

import numpy as np

import couplet


# -- motion of the mesh -----------------------------------------------------------------------------------------------
def moved(job, scene, method, mesh, dimension, parameters, end, steps, still, moving):
    """(least scaled Jacobian of the mesh, where it was refused and why; None where it came to the end)"""
    sides = [
        f"{name}: {{type: {kind}}}" for kind, names in re.findall(r"(\w+):([^,]*)", still) for name in names.split()
    ]
    sides += [f"{name}: {{type: moving, motion: {{{motion}}}}}" for name, motion in moving.items()]
    folder = job.scratch / re.sub(r"\W+", "-", f"reed {scene} {method}")
    folder.mkdir(exist_ok=True)
    (folder / "case.yaml").write_text(
        f"""simulation: {{end-time: {end}, time-step: {end / steps}, max-step-halvings: 0, output: {{folder: out, interval: {end}}}, checkpoint: {{interval: 0}}}}
participants:
  mover: {{program: mesh_mover, mesh: {job.root / mesh}, mesh-parameters: {parameters}, dimension: {dimension}, method: {method}, boundaries: {{{', '.join(sides)}}}}}
"""
    )
    done = job.run([job.build / "bin/mesh_mover", folder / "case.yaml"], 1200)
    file = folder / "out/mover/quality.csv"
    if not file.exists():
        raise RuntimeError((done.stderr or done.stdout)[-400:])
    rows, said = couplet.read_csv(file), re.search(
        r"(inverts cell|makes cell|no valid mesh)", done.stderr + done.stdout
    )
    refused = f"refused at {100 * rows['time [s]'][-1] / end:.2g} % of the way ({said[1] if said else ''})"
    return min(rows["least scaled Jacobian [1]"]), refused if done.returncode else None


def reaches(job, *scene):
    """`scene`: its name, mesh, dimension and mesh-parameters, end [s], steps, still boundaries, {moving one: its
    motion}."""
    (least, refused), *others = (
        moved(job, scene[0], method, *scene[1:]) for method in ("barrier", "laplacian", "pseudo-solid")
    )
    beside = ", ".join(
        f"{method} {where or 'comes through too'}" for method, (_, where) in zip(("laplacian", "pseudo-solid"), others)
    )
    return f"{refused or f'all cells valid, least scaled Jacobian {least:.4f}'}; {beside}", not refused and least > 0


# -- the valve --------------------------------------------------------------------------------------------------------
START = 0.1e-3  # lift at rest [m]
COARSE, SMALL = "{size: 4e-3, growth: 1.4}", "{size: 5e-3, growth: 1.6}"  # 7.0 k cells, as shipped; 4.0 k cells


def meshed(words):
    """The same parameters for the mesh of the fluid and of the mover; '~' for the file's own, 45 k cells."""
    return tuple(f"participants.{p}.mesh-parameters={words}" for p in ("fluid", "mover"))


def started(gap):
    """Keys of the reed at another lift at rest [m]; the mesh takes the parameter `lift`."""
    points = (f"point-{i}.point=[{x}, 0, {gap + 0.2e-3}]" for i, x in ((1, 0.030655), (2, 0.05334), (3, 0.076025)))
    return (
        f"participants.reed.placement.origin=[0, 0, {gap + 0.2e-3}]",
        *(f"participants.reed.probes.{p}" for p in points),
    )


def valve(job, keys=()):
    """configs/reed-valve, 115 ms: 50 minutes."""
    return job.case("reed-valve", keys, (1, 1, 1, 1), 20000)


def lift(run, point=1, start=START):
    """(time [s], lift of a point [m])"""
    found = run.probes("reed")
    return found["time [s]"], start + found[f"point-{point} z [m]"]


def crests(t, z):
    """Where the lift is the largest within 8 ms, which is not yet half a cycle."""
    return np.array(
        [i for i in range(1, len(t) - 1) if t[i] + 8e-3 <= t[-1] and z[i] >= z[np.abs(t - t[i]) <= 8e-3].max()],
        dtype=int,
    )


def off(value, right):
    return f"{100 * (value / right - 1):+.1f} %"


def unbalanced(run):
    """Largest mismatch of energy and work over the largest energy of the reed."""
    found = run.table("reed", "energies.csv")
    return np.abs(found["mismatch [J]"]).max() / (found["strain [J]"] + found["kinetic [J]"]).max()


def energy(job):
    share = unbalanced(valve(job))
    return f"{share:.1g} of the largest energy", share <= 1e-8


def contact(run):
    """(times in contact [s], largest penetration [m])"""
    found = run.table("reed", "contact.csv")
    return found["time [s]"][found["force [N]"] > 0], found["penetration [m]"].max()


def landings_of(run):
    """[s] Contacts at least 8 ms after the one before."""
    touching, _ = contact(run)
    return touching[np.flatnonzero(np.diff(touching, prepend=-1) > 8e-3)] if touching.size else touching


def landing(job, mesh=COARSE, gap=START):
    run = valve(job, () if (mesh, gap) == (COARSE, START) else (*meshed(f"{mesh[:-1]}, lift: {gap}}}"), *started(gap)))
    lands, highest = landings_of(run), 1e3 * lift(run, 1, gap)[1].max()
    periods, times = np.diff(lands), ", ".join(f"{1e3 * t:.1f}" for t in lands)
    if periods.size < 1:
        return f"lands at {times} ms; {highest:.2f} mm at point 1", False
    f = 1 / periods[-3:].mean()
    met = (
        len(lands) >= 5
        and np.ptp(periods[-3:]) <= 0.02 * periods[-3:].mean()
        and abs(f / 57.9 - 1) <= 0.05
        and abs(highest / 3.07 - 1) <= 0.1
    )
    return (
        (
            f"lands at {times} ms, {', '.join(f'{1 / p:.1f}' for p in periods)} Hz from landing to landing (last three"
            f" {off(f, 57.9)}, {100 * np.ptp(periods[-3:]) / periods[-3:].mean():.1f} % apart); {highest:.2f} mm at"
            f" point 1 ({off(highest, 3.07)})"
        ),
        met,
    )


def survey(job, key, values):
    """In air, 4.0 k cells, 45 ms, for each value of a key: largest lift at point 1, frequency between the last two
    crests of point 2, landings."""
    texts = []
    for name, value in values.items():
        run = valve(job, (*meshed(SMALL), key.replace("{}", value), "simulation.end-time=45 ms"))
        t, z = lift(run, 2)
        periods, lands = np.diff(t[crests(t, z)]), ", ".join(f"{1e3 * at:.1f}" for at in landings_of(run))
        frequency = f"{1 / periods[-1]:.1f} Hz" if periods.size else "no two crests"
        texts.append(
            f"{name}: {1e3 * lift(run, 1)[1].max():.2f} mm, {frequency}, "
            + (f"lands at {lands} ms" if lands else "does not land")
        )
    return "; ".join(texts), None


def price(job):
    """Processor hours of 60 ms in air on 45 k cells, by the rate of the first 5 ms."""
    run = valve(job, (*meshed("~"), "simulation.end-time=5 ms", "simulation.output.interval=0"))
    hours = run.cost.cpu / 3600 * 60 / 5
    return f"{hours:.1f}", hours <= 6


HALF, END, WHOLE = 0.3e-3, 0.6e-3, 8e-3  # checkpoint, end of this run, what was asked for [s]


def swapped(job):
    """The slice with the plate, with the modes of a solid, with the solid at large strain: first peak, trough, second
    peak, frequency."""
    modes = job.case("reed-slice/shapes", timeout=600).folder / "reed/modes.h5"
    runs = {
        "plate": job.case("reed-slice"),
        "modes of the solid": job.case("reed-slice/modes", (f"participants.reed.modes.file={modes}",)),
        "solid at large strain": job.case("reed-slice/solid", timeout=7200),
    }
    found = {}
    for name, run in runs.items():
        probes = run.probes("reed")
        t, gap = probes["time [s]"], 1000 * (probes["tip z [m]"] + 0.3e-3)
        first = int(np.argmax(gap[t < 0.01]))
        low = first + int(np.argmin(gap[first : (t < 0.0135).sum()]))
        second = low + int(np.argmax(gap[low:]))
        found[name] = gap[first], gap[low], gap[second], 1 / (t[second] - t[first])
    worst = max(abs(v[i] / found["plate"][i] - 1) for v in found.values() for i in range(4))
    return (
        "; ".join(f"{name}: {v[0]:.3f}, {v[1]:.3f}, {v[2]:.3f} mm, {v[3]:.0f} Hz" for name, v in found.items())
        + f" (first peak, trough, second peak): {100 * worst:.1f} % apart",
        worst <= 0.05,
    )
