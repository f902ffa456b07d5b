# SPDX-License-Identifier: Apache-2.0
"""Large strain beside CalculiX and the updated-Lagrangian method: case E on the same mesh, whole processes on one core, processor seconds turn by turn."""
import csv
import math
import re

import couplet

S = "participants.solid."
CONVERGED = 0.43134  # u1 / L at K = 1.6, Saint Venant-Kirchhoff


def race(job, across, along, times, most):
    found = job.beside("benchmarks/peers/race.py").bent_beam(job, across, along, 1.6, times)
    mine, u = found.pop("ours")
    words = [f"ours {mine:.2f} s ({100 * (u / CONVERGED - 1):+.2f} %)"]
    words += [f"{who} {s:.2f} s ({100 * (v / CONVERGED - 1):+.2f} %): {s / mine:.1f}x" for who, (s, v) in found.items()]
    if not found:
        return "; ".join(words) + "; CalculiX is not installed", None if most is None else False
    return "; ".join(words), None if most is None else min(s for s, _ in found.values()) / mine >= most


def best(job):
    """The cheapest of each one's meshes that errs by at most 0.1 %, each run three times in turns."""
    peers, limit = job.beside("benchmarks/peers/race.py"), 0.001
    meshes = {"ours": [(2, 20), (4, 40)], "C3D8I": [(2, 20), (4, 40), (4, 80), (8, 40), (8, 80)],
              "C3D20": [(2, 5), (2, 10), (2, 20), (4, 20), (4, 40)]}
    chosen, words = {}, []
    for who, of_whom in meshes.items():
        for mesh in of_whom:
            runs = [peers.our_beam(job, *mesh, 1.6)[:2] if who == "ours" else peers.calculix_bent(job, *mesh, 1.6, who) for _ in range(3)]
            if runs[0] is None:
                return "CalculiX is not installed", False
            seconds, error = sorted(r[0] for r in runs)[1], runs[0][1] / CONVERGED - 1
            if abs(error) <= limit and (who not in chosen or seconds < chosen[who][0]):
                chosen[who] = seconds, f"{who} {mesh[0]}x{mesh[0]}x{mesh[1]} {seconds:.2f} s ({100 * error:+.3f} %)"
    words = "; ".join(chosen[who][1] if who in chosen else f"{who}: no mesh of those tried" for who in meshes)
    return words, "ours" in chosen and all(chosen["ours"][0] <= s for s, _ in chosen.values())


def growth(job):
    """Processor seconds per cell and Newton iteration, large over small."""
    peers, each = job.beside("benchmarks/peers/race.py"), {}
    for across in (8, 16):
        runs = [peers.our_beam(job, across, 10 * across, 1.6) for _ in range(3 if across == 8 else 1)]
        seconds, _, newton = min(runs)
        each[across] = seconds / (10 * across**3) / sum(newton)
    return f"{1e6 * each[8]:.2f} and {1e6 * each[16]:.2f} us: {each[16] / each[8]:.2f} times", each[16] / each[8] < 2


THESIS = {(2, 1.6): 0.3922, (4, 1.6): 0.4206}  # table 3.6, meshes 1 and 2


def segregated(job):
    """The updated-Lagrangian method against table 3.6 of the thesis, in one load step (total Lagrangian) and in four, and Newton's time on the same mesh."""
    words, agrees, factor = [], True, 0
    for (n, K), wanted in THESIS.items():
        aitken = (f"{S}solution-method={{type: segregated, acceleration: aitken, max-iterations: 40000, relative-tolerance: 1e-6}}",)
        pull = K * 15.293e6 * (0.2**4 / 12) / (0.04 * 4) / math.sqrt(2)
        found = {}
        for name, sets in (("one", (*aitken, "simulation.time-step=1")), ("four", (*aitken, "simulation.time-step=0.25")),
                           ("newton", (f"{S}solution-method.relative-tolerance=1e-6", "simulation.time-step=1"))):
            run = job.alone("bent-beam", (
                "%smesh-parameters={n: %d, m: %d, L: 2}" % (S, n, 10 * n), f"{S}material.law=saint-venant-kirchhoff",
                f"{S}boundaries.tip.value=[{pull!r}*t, {pull!r}*t, 0]", *sets))
            tip = couplet.read_csv(run.folder / "solid" / "probes.csv")
            solver = [float(line.split()[3]) for line in run.log.splitlines() if line.startswith("solid: linear solver")]
            found[name] = math.hypot(tip["tip x [m]"][-1], tip["tip y [m]"][-1]) / 2, solver[-1]
        agrees = agrees and all(abs(found[k][0] / wanted - 1) <= 1e-3 for k in ("one", "four"))
        factor = found["one"][1] / found["newton"][1]
        words.append(f"{n}x{n}x{10 * n}: {found['one'][0]:.5f} in one load step, {found['four'][0]:.5f} in four (thesis {wanted}), Newton "
                     f"{found['newton'][0]:.5f}; solve {found['one'][1]:.2f} s for Newton's {found['newton'][1]:.2f} s: {factor:.0f}x")
    return "; ".join(words), agrees and factor >= 20


def pairs(job):
    """The estimate of `output: {large-strain-estimate: true}` and what `kinematics: finite-strain` changes, 7 bodies."""
    tests, _ = job.gtest("verification_solid_large_strain_estimate")
    found = {t.rsplit("/", 1)[-1]: (float(v["told"]), float(v["found"])) for t, v in tests.items() if "told" in v}
    text = "; ".join(f"{name.replace('_', ' ')}: {100 * told:.1f} of {100 * true:.1f} %" for name, (told, true) in found.items())
    return text, len(found) >= 6 and all(1 / 1.5 <= told / true <= 1.5 for told, true in found.values())


def flap(job):
    """Tip at 0.4 s; the linear flap, then two schemes of coupling at large strain."""
    def tip(name, *sets):
        folder = job.coupled(job.root / "configs/perpendicular-flap/case.yaml", f"flap-20-{name}", [
            "participants.fluid.boundaries.inlet.velocity=[20 m/s, 0 m/s]", "participants.mover.form=incremental",
            "participants.mover.stiffening-volumes=current", "simulation.end-time=0.4 s", *sets])
        table = couplet.read_csv(folder / "solid" / "probes.csv")
        return table["tip x [m]"][-1], table["tip y [m]"][-1]
    large = "participants.solid.kinematics=finite-strain"
    linear, semi, implicit = tip("linear"), tip("semi-implicit", large), tip("implicit", large, "coupling.scheme=implicit")
    apart = max(abs(a - b) for a, b in zip(semi, implicit)) / abs(implicit[0])
    return (f"tip {linear[0]:.4f}, {linear[1]:+.4f} m linear; {semi[0]:.4f}, {semi[1]:+.4f} m finite strain, semi-implicit; "
            f"{implicit[0]:.4f}, {implicit[1]:+.4f} m implicit; linear {100 * (linear[0] / implicit[0] - 1):+.1f} % along the flow, "
            f"schemes {100 * apart:.2f} % apart"), apart <= 0.01


def study(job):
    """The committed study of case E: its series, those refused, the peers, and what the deflection costs to 0.5 %."""
    folder = job.root / "docs/validation/studies/bent-beam"
    with open(folder / "runs.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    good = [r for r in rows if not r["reason"]]
    kinds = {axis: sorted({r[axis] for r in good}) for axis in ("gradient", "method", "cells")}
    refused = {(r["method"], r["gradient"]) for r in rows if r["reason"]}
    cheapest = min((r for r in good if float(r["error of deflection"]) <= 0.005), key=lambda r: float(r["processor [s]"]))
    peers = re.findall(r"^\| (CalculiX \w+) \| ([\d.]+) \| ([\d.]+) \|", (folder / "report.md").read_text(), re.M)
    theirs = min(((float(s), who) for who, s, error in peers if float(error) <= 0.005), default=None)
    text = (f"{len(good)} runs: gradients {', '.join(kinds['gradient'])}; methods {', '.join(kinds['method'])}; cells {', '.join(kinds['cells'])}; {len(refused)} pairs of "
            f"method and gradient refused with their reason; to 0.5 %: {cheapest['mesh']}-{cheapest['method']}-{cheapest['cells']} {float(cheapest['processor [s]']):.2f} s"
            + (f", {theirs[1]} {theirs[0]:.2f} s" if theirs else ""))
    return text, (len(kinds["gradient"]) >= 2 and len(kinds["method"]) >= 3 and len(kinds["cells"]) == 3 and len({who for who, _, _ in peers}) == 3
                  and (folder / "error-deflection.png").exists())


def drawn(job):
    """configs/bent-beam/maps.py, four cells across."""
    maps = job.beside("configs/bent-beam/maps.py")
    sections = {n: maps.Section(job.alone("bent-beam", maps.settings(4, n)).folder, 4) for n in maps.SIDES}
    maps.picture(sections, job.root / "docs" / "pictures" / "bent-beam.png")
    return "; ".join(f"L {n} sides: {maps.text(section)}" for n, section in sections.items()), True
