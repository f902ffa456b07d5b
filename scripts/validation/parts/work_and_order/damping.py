# SPDX-License-Identifier: Apache-2.0
"""FSI3 of Turek and Hron for 20 s, default settings, on meshes that match and on 3:2 faces: whether the coupling, and the time scheme of
the plate, keep the energy that it gets."""
import numpy as np

import couplet

HERE = "configs/turek-hron"
MESHES = {"1:1": ("participants.solid.mesh={root}/scripts/validation/parts/work_and_order/plate-matched.geo", "participants.solid.mesh-parameters={n: 12}"),
          "3:2": ("participants.solid.mesh-parameters={nx: 62, ny: 9}",)}  # 41 and 6 faces of the fluid
END = 20  # s


def run(job, mesh, *more):
    """Summary of the last 1.2 s, work [J] of fluid and structure over the run, energies of the plate."""
    sets = [one.replace("{root}", str(job.root)) for one in MESHES[mesh]]
    folder = job.coupled(job.root / HERE / "case.yaml", f"fsi3-long-{mesh.replace(':', '-')}-{len(more)}", (
        f"simulation.end-time={END} s", "simulation.output.interval=0", "simulation.checkpoint.interval=0", "participants.solid.output.energies=true",
        *sets, *more), timeout=20000)
    balance = couplet.read_csv(folder / "coupler" / "balance.csv")
    works = [float(np.sum(balance[name])) for name in balance if name.endswith("work of the step [J]")]
    return job.beside(f"{HERE}/summary.py").summary(folder), works, couplet.read_csv(folder / "solid" / "energies.csv")


def text(found):
    return f"{1e3 * found['uy_mean']:.2f} +- {1e3 * found['uy_amp']:.2f} mm, {found['uy_f']:.2f} Hz"


def work(job, mesh):
    found, (given, taken, *_), _ = run(job, mesh)
    apart = abs(given + taken if given * taken < 0 else given - taken) / max(abs(given), abs(taken))
    return f"{END} s; {text(found)}; work {given:.8g} and {taken:.8g} J: {apart:.1e} apart", apart <= 1e-10


def amplitude(job):
    one, three = run(job, "1:1")[0], run(job, "3:2")[0]
    off = three["uy_amp"] / one["uy_amp"] - 1
    return f"{text(three)} for {text(one)}: {100 * off:+.2f} %", abs(off) <= 0.03


def ledger(job, mesh):
    """What the plate's own time scheme loses or makes, of what it holds at most and of what went in."""
    energies = run(job, mesh)[2]
    lost = np.array(energies["lost by the scheme [J]"])
    held = np.array(energies["strain [J]"]) + np.array(energies["kinetic [J]"])
    worst = np.abs(lost).max() / held.max()
    return f"{worst:.1e} of the most energy that it holds", worst <= 1e-3
