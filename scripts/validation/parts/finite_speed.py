# SPDX-License-Identifier: Apache-2.0
"""Large strain beside CalculiX: case E on the same mesh, whole processes on one core, processor seconds turn by turn."""
import couplet_series as couplet
from validation.job import Bar

CONVERGED = 0.43134  # u1 / L at K = 1.6, Saint Venant-Kirchhoff


def race(across, along, times, most):
    def measure(job):
        found = job.beside("benchmarks/peers/race.py").bent_beam(job, across, along, 1.6, times)
        mine, u = found.pop("ours")
        words = [f"ours {mine:.2f} s ({100 * (u / CONVERGED - 1):+.2f} %)"]
        words += [f"{who} {s:.2f} s ({100 * (v / CONVERGED - 1):+.2f} %): {s / mine:.1f}x" for who, (s, v) in found.items()]
        if not found:
            return "; ".join(words) + "; CalculiX is not installed", None if most is None else False
        return "; ".join(words), None if most is None else min(s for s, _ in found.values()) / mine >= most
    return measure


def pairs(job):
    """What `output: {large-strain-estimate: true}` tells and what `kinematics: finite-strain` changes, 7 bodies."""
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


BARS = [
    Bar("E, Saint Venant-Kirchhoff, K 1.6 on 4x4x40: processor seconds of whole processes beside CalculiX C3D8, C3D8I", "reported",
        race(4, 40, 3, None)),
    Bar("the same on 8x8x80, median of three, turn by turn", ">= 10x faster", race(8, 80, 3, 10)),
    Bar("segregated updated-Lagrangian solver with Aitken (thesis 2.39-2.40), agreement on case E and speed", "agree; >= 20x faster",
        lambda job: ("not run: not built", False)),
    Bar("the linear run's verdict on geometric non-linearity against the true difference, 7 pairs", "within a factor of 1.5", pairs),
    Bar("flap at U = 20 m/s coupled, finite strain beside linear; semi-implicit and implicit", "printed; within 1 %", flap, long=True,
        but="to 0.4 s, before the first maximum: the linear flap, which grows longer as it turns, makes the fluid's mesh cross itself at 0.44 s, "
            "also with the incremental mover that is taken here"),
    Bar("maps of stretch and shear of case E, as figures 3.12, 3.13 of the thesis", "drawn", lambda job: ("not run: not built", False)),
]
