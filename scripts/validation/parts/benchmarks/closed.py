# SPDX-License-Identifier: Apache-2.0
"""Measures of the closed box under an elastic lid, and of its variant with an opening of an eighth of the side."""
import math

import couplet

FILES = {"closed": "configs/closed-cavity/case.yaml", "nearly closed": "configs/closed-cavity/nearly-closed.yaml"}
MESHES = 8, 16, 32
SCHEMES = {
    "semi-implicit": (),
    "implicit": ("coupling.scheme=implicit",),
    "semi-implicit, Robin": ("coupling.order=structure-first", "participants.fluid.volume-level=none", "participants.fluid.boundaries.lid.surface-density=50"),
}


def run(job, kind, n, step, scheme="semi-implicit"):
    opening = f", m: {n // 8}" if kind != "closed" else ""  # an eighth of the side on all meshes
    sets = [f"simulation.time-step={step} ms", "simulation.end-time=0.4 s", "simulation.output.interval=0", *SCHEMES[scheme],
            *(f"participants.{name}.mesh-parameters={{n: {n}{opening if name != 'lid' else ''}}}" for name in ("fluid", "lid", "mover"))]
    return job.coupled_run(job.root / FILES[kind], f"{kind}-{n}-{step}-{scheme}".replace(" ", "-").replace(",", ""), sets)


def lid(result):
    """Height of the lid's middle at the end [m]."""
    return couplet.read_csv(result.folder / "lid" / "probes.csv")["middle y [m]"][-1]


def passes(result):
    rows = couplet.read_csv(result.folder / "coupler" / "residuals.csv")
    return len(rows["step"]) / len(set(rows["step"]))


def extrapolation(job, kind):
    """Mesh and step are halved together: the finest run beside the limit of the three."""
    values = [lid(run(job, kind, n, 160 / n)) for n in MESHES]
    first, second = values[1] - values[0], values[2] - values[1]
    ratio = min(max(first / second, 2), 4) if first * second > 0 else 2  # order between 1 and 2
    limit = values[2] + second / (ratio - 1)
    return (f"lid's middle {' '.join(f'{1e3 * v:.4f}' for v in values)} mm on {', '.join(f'{n} x {n}' for n in MESHES)} cells and steps of 20, 10, 5 ms, limit "
            f"{1e3 * limit:.4f} mm: {100 * (values[2] / limit - 1):+.2f} %, order {math.log2(ratio):.1f}"), abs(values[2] / limit - 1) <= 0.02


def compared(job, kind):
    found = {scheme: run(job, kind, 16, 10, scheme) for scheme in SCHEMES}
    return "; ".join(f"{scheme}: {passes(r):.1f} passes per step, {r.cost.cpu:.1f} processor s, {1e3 * lid(r):.4f} mm" for scheme, r in found.items()), None
