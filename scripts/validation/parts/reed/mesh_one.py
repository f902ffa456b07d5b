# SPDX-License-Identifier: Apache-2.0
"""The valve on a mesh of the size of the source's mesh 1, for as long as a machine of two cores allows: its price, a restart, other ranks."""
import re

import numpy as np

from validation.parts.reed.valve import columns, meshed

MESH = meshed("{size: 0.85e-3, growth: 1.12}")
HALF, END, WHOLE = 0.3e-3, 0.6e-3, 8e-3  # checkpoint, end of this run, what was asked for [s]


def run(job, name, end, ranks=(1, 1, 1, 1), flags=()):
    sets = (*MESH, f"simulation.end-time={end}", f"simulation.checkpoint.interval={HALF}", "simulation.output.interval=0")
    return job.coupled_run(job.root / "configs/reed-valve/case.yaml", f"reed-mesh-one-{name}", sets, ranks, 3 * 3600, flags)


def continued(job, name, end, ranks=(1, 1, 1, 1)):
    first = sorted((run(job, "whole", END).folder / "checkpoints").glob("step-*"))[0]
    return run(job, name, end, ranks, ("--restart", str(first)))


def rows(result, file):
    """By time."""
    names = ("point-1 z [m]",) if file == "reed/probes.csv" else ("plate pressure z [N]",)
    t, values = columns(result, file, *names)
    return dict(zip(np.round(t, 9), values))


def apart(job, one, other):
    """Largest difference of lift and force over their largest values, at the times of the other."""
    worst = 0
    for file in ("reed/probes.csv", "fluid/forces.csv"):
        a, b = rows(one, file), rows(other, file)
        late = [t for t in b if t > HALF + 1e-9]
        worst = max(worst, max(abs(a[t] - b[t]) for t in late) / max(abs(v) for v in a.values()))
    return worst


def mesh_one(job):
    whole = run(job, "whole", END)
    cells = int(re.search(r"^\[fluid 0\] mesh: (\d+) cells", whole.log, re.M)[1])
    milliseconds = END * 1e3
    hours = whole.cost.cpu / 3600 / milliseconds
    again = apart(job, whole, continued(job, "again", END))
    ranks = apart(job, whole, continued(job, "ranks", HALF + 0.1e-3, (1, 2, 1, 2)))
    wall = whole.cost.wall / 3600 * WHOLE / END
    return (f"{cells / 1000:.0f} k cells, {2 * cells / 1000:.0f} k of the whole valve: {hours:.2f} core-hours per millisecond on 4 processes and two cores, {whole.cost.memory:.0f} MB in the largest; "
            f"8 ms at that rate {wall:.1f} h of wall time; restarted: {'bit for bit' if again == 0 else f'{again:.0e} apart'}, fluid and mover on two ranks: {ranks:.0e} apart",
            again == 0 and ranks < 1e-4 and wall <= 3)
