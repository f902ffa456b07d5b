# SPDX-License-Identifier: Apache-2.0
"""The reed valve in three dimensions and its slice: motion of the mesh, lift, frequency, flow area, contact, other structures in the reed's place."""
import re

import numpy as np

import couplet

# -- motion of the mesh -----------------------------------------------------------------------------------------------
def moved(job, scene, method, mesh, dimension, parameters, end, steps, still, moving):
    """(least scaled Jacobian of the mesh, where it was refused and why; None where it came to the end)"""
    sides = [f"{name}: {{type: {kind}}}" for kind, names in re.findall(r"(\w+):([^,]*)", still) for name in names.split()]
    sides += [f"{name}: {{type: moving, motion: {{{motion}}}}}" for name, motion in moving.items()]
    folder = job.scratch / re.sub(r"\W+", "-", f"reed {scene} {method}")
    folder.mkdir(exist_ok=True)
    (folder / "case.yaml").write_text(f"""simulation: {{end-time: {end}, time-step: {end / steps}, max-step-halvings: 0, output: {{folder: out, interval: {end}}}, checkpoint: {{interval: 0}}}}
participants:
  mover: {{program: mesh_mover, mesh: {job.root / mesh}, mesh-parameters: {parameters}, dimension: {dimension}, method: {method}, boundaries: {{{', '.join(sides)}}}}}
""")
    done = job.run([job.build / "bin/mesh_mover", folder / "case.yaml"], 1200)
    file = folder / "out/mover/quality.csv"
    if not file.exists():
        raise RuntimeError((done.stderr or done.stdout)[-400:])
    rows, said = couplet.read_csv(file), re.search(r"(inverts cell|makes cell|no valid mesh)", done.stderr + done.stdout)
    refused = f"refused at {100 * rows['time [s]'][-1] / end:.2g} % of the way ({said[1] if said else ''})"
    return min(rows["least scaled Jacobian [1]"]), refused if done.returncode else None


def reaches(job, *scene):
    """`scene`: its name, mesh, dimension and mesh-parameters, end [s], steps, still boundaries, {moving one: its motion}."""
    (least, refused), *others = (moved(job, scene[0], method, *scene[1:]) for method in ("barrier", "laplacian", "pseudo-solid"))
    beside = ", ".join(f"{method} {where or 'comes through too'}" for method, (_, where) in zip(("laplacian", "pseudo-solid"), others))
    return f"{refused or f'all cells valid, least scaled Jacobian {least:.4f}'}; {beside}", not refused and least > 0


# -- the valve --------------------------------------------------------------------------------------------------------
START = 0.1e-3  # lift at rest [m]
COARSE, SMALL = "{size: 4e-3, growth: 1.4}", "{size: 5e-3, growth: 1.6}"  # 7.0 k cells, as shipped; 4.0 k cells
SOURCE = ("participants.fluid.compressibility=~", ".boundaries.outlet.absorbing=false")  # incompressible


def meshed(words):
    """The same parameters for the mesh of the fluid and of the mover; '~' for the file's own, 45 k cells."""
    return tuple(f"participants.{p}.mesh-parameters={words}" for p in ("fluid", "mover"))


def started(gap):
    """Keys of the reed at another lift at rest [m]; the mesh takes the parameter `lift`."""
    points = (f"point-{i}.point=[{x}, 0, {gap + 0.2e-3}]" for i, x in ((1, 0.030655), (2, 0.05334), (3, 0.076025)))
    return (f"participants.reed.placement.origin=[0, 0, {gap + 0.2e-3}]", *(f"participants.reed.probes.{p}" for p in points))


def valve(job, keys=()):
    """configs/reed-valve, 115 ms: 50 minutes."""
    return job.case("reed-valve", keys, (1, 1, 1, 1), 20000)


def lift(run, point=1, start=START):
    """(time [s], lift of a point [m])"""
    found = run.probes("reed")
    return found["time [s]"], start + found[f"point-{point} z [m]"]


def crests(t, z):
    """Where the lift is the largest within 8 ms, which is not yet half a cycle."""
    return np.array([i for i in range(1, len(t) - 1) if t[i] + 8e-3 <= t[-1] and z[i] >= z[np.abs(t - t[i]) <= 8e-3].max()], dtype=int)


def off(value, right):
    return f"{100 * (value / right - 1):+.1f} %"


def settling(job):
    """Incompressible, from the start of the source: frequency from peak to peak, and what is left of the swing in the end."""
    run = valve(job, (*SOURCE, *meshed(SMALL), "simulation.end-time=200 ms"))  # half an hour
    t, z = lift(run, 2)
    tops = crests(t, z)
    if len(tops) < 2:
        return "no two crests", False
    f, late = 1 / (t[tops[1]] - t[tops[0]]), z[t > t[-1] - 1 / 56.3]
    swing = np.ptp(late) / 2 / late.mean()
    return (f"{f:.1f} Hz ({off(f, 56.3)}), {1e3 * lift(run, 1)[1].max():.2f} mm at point 1; swings by {100 * swing:.1f} % of {1e3 * late.mean():.2f} mm at point 2 in the last cycle of "
            f"{1e3 * t[-1]:.0f} ms", abs(f / 56.3 - 1) <= 0.03 and swing <= 0.05)


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
    met = len(lands) >= 5 and np.ptp(periods[-3:]) <= 0.02 * periods[-3:].mean() and abs(f / 57.9 - 1) <= 0.05 and abs(highest / 3.07 - 1) <= 0.1
    return (f"lands at {times} ms, {', '.join(f'{1 / p:.1f}' for p in periods)} Hz from landing to landing (last three {off(f, 57.9)}, {100 * np.ptp(periods[-3:]) / periods[-3:].mean():.1f} % "
            f"apart); {highest:.2f} mm at point 1 ({off(highest, 3.07)})", met)


def survey(job, key, values):
    """In air, 4.0 k cells, 45 ms, for each value of a key: largest lift at point 1, frequency between the last two crests of point 2, landings."""
    texts = []
    for name, value in values.items():
        run = valve(job, (*meshed(SMALL), key.replace("{}", value), "simulation.end-time=45 ms"))
        t, z = lift(run, 2)
        periods, lands = np.diff(t[crests(t, z)]), ", ".join(f"{1e3 * at:.1f}" for at in landings_of(run))
        frequency = f"{1 / periods[-1]:.1f} Hz" if periods.size else "no two crests"
        texts.append(f"{name}: {1e3 * lift(run, 1)[1].max():.2f} mm, {frequency}, " + (f"lands at {lands} ms" if lands else "does not land"))
    return "; ".join(texts), None


def price(job):
    """Processor hours of 60 ms in air on 45 k cells, by the rate of the first 5 ms."""
    run = valve(job, (*meshed("~"), "simulation.end-time=5 ms", "simulation.output.interval=0"))
    hours = run.cost.cpu / 3600 * 60 / 5
    return f"{hours:.1f}", hours <= 6


def areas(run):
    """(lift of point 2 [m], effective flow area of the whole valve [mm^2]) while it opens for the first time."""
    found = run.table("fluid", "flow-areas.csv")
    at = np.interp(found["time [s]"], *lift(run, 2))
    until = int(np.argmax(at)) + 1
    return at[:until], 2e6 * found["valve effective area [m^2]"][:until]


def fine_areas(job):
    """At lifts of point 2 of 1, 2, 3 mm, opening, incompressible, on 7.0 k and 45 k cells; how far each curve leaves the straight lines between points 0.25 mm apart."""
    curves = [areas(valve(job, (*SOURCE, *meshed(mesh), "simulation.end-time=8 ms", "simulation.output.interval=0"))) for mesh in (COARSE, "~")]
    knots, rough = np.arange(1e-3, 3.01e-3, 0.25e-3), 0
    found = np.array([np.interp((1e-3, 2e-3, 3e-3), *curve) for curve in curves])
    apart = np.abs(found[0] / found[1] - 1).max()
    for at, area in curves:
        inside = (at > 1e-3) & (at < 3e-3)
        rough = max(rough, np.abs(area[inside] / np.interp(at[inside], knots, np.interp(knots, at, area)) - 1).max())
    texts = ", ".join(f"{mm} mm {coarse:.0f} and {fine:.0f} mm^2" for mm, coarse, fine in zip((1, 2, 3), *found))
    return f"opening, on 7.0 k and 45 k cells: {texts}; {100 * apart:.0f} % apart; each within {100 * rough:.1f} % of lines between points 0.25 mm apart", apart <= 0.1 and rough <= 0.03


HALF, END, WHOLE = 0.3e-3, 0.6e-3, 8e-3  # checkpoint, end of this run, what was asked for [s]


def mesh_one(job):
    """The price of mesh 1 of the source, and how far lift and force of a run that is continued are apart from the whole one."""
    def run(end, ranks=(1, 1, 1, 1), flags=()):
        keys = (*SOURCE, *meshed("{size: 0.85e-3, growth: 1.12}"), f"simulation.end-time={end}", f"simulation.checkpoint.interval={HALF}", "simulation.output.interval=0")
        return job.case("reed-valve", keys, ranks, 3 * 3600, flags)

    def apart(other):
        worst = 0
        for file, column in (("reed/probes.csv", "point-1 z [m]"), ("fluid/forces.csv", "plate pressure z [N]")):
            a, b = (dict(zip(np.round(found["time [s]"], 9), found[column])) for found in (r.table(*file.split("/")) for r in (whole, other)))
            worst = max(worst, max(abs(a[t] - b[t]) for t in b if t > HALF + 1e-9) / max(map(abs, a.values())))
        return worst

    whole = run(END)
    restart = ("--restart", str(min((whole.folder / "checkpoints").glob("step-*"))))
    again, ranks = apart(run(END, flags=restart)), apart(run(HALF + 0.1e-3, (1, 2, 1, 2), restart))
    cells = int(re.search(r"^\[fluid 0\] mesh: (\d+) cells", whole.log, re.M)[1])
    wall = whole.cost.wall / 3600 * WHOLE / END
    return (f"{cells / 1000:.0f} k cells, {2 * cells / 1000:.0f} k of the whole valve: {whole.cost.cpu / 3600 / END / 1e3:.2f} core-hours per millisecond on 4 processes and two cores, "
            f"{whole.cost.memory:.0f} MB in the largest; 8 ms at that rate {wall:.1f} h of wall time; restarted: {'bit for bit' if again == 0 else f'{again:.0e} apart'}, "
            f"fluid and mover on two ranks: {ranks:.0e} apart", again == 0 and ranks < 1e-4 and wall <= 3)


# -- the slice --------------------------------------------------------------------------------------------------------
def any_stiffness(job):
    """The slice pressed shut as in coupling_reed_lands_*, the seat of the plate softer and stiffer."""
    texts, met = [], True
    for factor in (0.1, 1, 1e2, 1e4):
        keys = (f"participants.reed.contact.scale={1e-4 * factor:g}", "simulation.end-time=3.8e-3", "simulation.output.interval=0",
                '.boundaries.outlet.pressure="t<0.003?1000*sin(pi*t/0.003):0"')
        run = job.case("reed-slice", keys, timeout=1200)
        touching, deep = contact(run)
        share = unbalanced(run)
        met &= touching.size > 0 and share < 1e-6
        texts.append(f"{factor:g} times: " + (f"{1e3 * touching[0]:.2f} to {1e3 * touching[-1]:.2f} ms, {1e6 * deep:.2g} um deep, " if touching.size else "does not land, ")
                     + f"energies to {share:.0e}, {run.passes().mean():.2f} passes per step")
    return "; ".join(texts), met


def swapped(job):
    """The slice with the plate, with the modes of a solid, with the solid at large strain: first peak, trough, second peak, frequency."""
    modes = job.case("reed-slice/shapes", timeout=600).folder / "reed/modes.h5"
    runs = {"plate": job.case("reed-slice"), "modes of the solid": job.case("reed-slice/modes", (f"participants.reed.modes.file={modes}",)),
            "solid at large strain": job.case("reed-slice/solid", timeout=7200)}
    found = {}
    for name, run in runs.items():
        probes = run.probes("reed")
        t, gap = probes["time [s]"], 1000 * (probes["tip z [m]"] + 0.3e-3)
        first = int(np.argmax(gap[t < 0.01]))
        low = first + int(np.argmin(gap[first:(t < 0.0135).sum()]))
        second = low + int(np.argmax(gap[low:]))
        found[name] = gap[first], gap[low], gap[second], 1 / (t[second] - t[first])
    worst = max(abs(v[i] / found["plate"][i] - 1) for v in found.values() for i in range(4))
    return "; ".join(f"{name}: {v[0]:.3f}, {v[1]:.3f}, {v[2]:.3f} mm, {v[3]:.0f} Hz" for name, v in found.items()) + f" (first peak, trough, second peak): {100 * worst:.1f} % apart", worst <= 0.05


def landings(job):
    """What coupling_reed_lands_* print."""
    passed, total, _, output = job.ctest("^coupling_reed_lands_(plate|modes|solid)$")
    times = np.array([[1e3 * float(v) for v in found] for found in re.findall(r"touches from ([\d.e-]+) to ([\d.e-]+) s", output)])
    deepest = [1e6 * float(v) for v in re.findall(r"springs of the seat let it +([\d.e-]+) m", output)]
    apart = max(np.ptp(times[:, i]) / times[:, i].min() for i in (0, 1))
    return (f"{passed} of {total} tests; in the seat from {times[:, 0].min():.2f} to {times[:, 0].max():.2f} ms on, until {times[:, 1].min():.2f} to {times[:, 1].max():.2f} ms "
            f"({100 * apart:.0f} % apart), at most {max(deepest):.1f} um deep"), passed == total == 3 and apart <= 0.05
