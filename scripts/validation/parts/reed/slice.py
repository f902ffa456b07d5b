# SPDX-License-Identifier: Apache-2.0
"""What the slice of the reed valve does, settle or oscillate, on three meshes and with three steps, with and without what compresses."""
import couplet
import numpy as np

REST = 0.3  # gap under the tip at rest [mm]
FLUIDS = {
    "air and 50 cm^3 of it upstream": (),
    "air, nothing upstream": ("participants.fluid.compressibility.upstream-volume=0",),
    "incompressible": ("participants.fluid.compressibility.scheme=none", "participants.fluid.boundaries.outlet.absorbing=false"),
}
MESHES, STEPS = (0.5, 0.75, 1), (100, 50, 25)  # cells along each side, of the case's; us
FROM, END = 7e-3, 25e-3  # the jet has its velocity from 5 ms on [s]
DIES_OUT = 0.5  # of the range of the first half after FROM: what the second half of a reed that settles is below


def motion(job, name, mesh, step):
    """(settles or oscillates, mean gap [mm], range [mm] and frequency [Hz] of the second half)."""
    size = [f"participants.{p}.mesh-parameters={{f: {mesh}}}" for p in ("fluid", "mover", "reed")]
    sets = (*FLUIDS[name], *size, f"simulation.time-step={step}e-6", f"simulation.end-time={END}", "simulation.output.interval=0")
    run = job.coupled_run(job.root / "configs/reed-slice/case.yaml", f"slice-{list(FLUIDS).index(name)}-{mesh}-{step}", sets, timeout=3600)
    rows = couplet.read_csv(run.folder / "reed/probes.csv")
    t, gap = np.array(rows["time [s]"]), 1e3 * np.array(rows["tip z [m]"]) + REST
    half = (FROM + END) / 2
    first, second = gap[(t >= FROM) & (t < half)], gap[t >= half]
    late = second - second.mean()
    rises = t[t >= half][1:][(late[:-1] < 0) & (late[1:] >= 0)]
    frequency = (len(rises) - 1) / (rises[-1] - rises[0]) if len(rises) > 1 else float("nan")
    return ("settles" if np.ptp(second) < DIES_OUT * np.ptp(first) else "oscillates"), second.mean(), np.ptp(second), frequency


def statements(job):
    texts, same = [], True
    for name in FLUIDS:
        by_mesh = [motion(job, name, mesh, 50) for mesh in MESHES]
        by_step = [motion(job, name, MESHES[0], step) for step in STEPS]
        same &= by_mesh[-1][0] == by_mesh[-2][0] == by_step[-1][0] == by_step[-2][0]
        _, mean, span, frequency = by_mesh[-1]
        apart = [" and ".join(f"{abs(pair[-1][i] - pair[-2][i]):.2g}" for pair in (by_mesh, by_step)) for i in (1, 2, 3)]
        texts.append(f"{name}: {', '.join(dict.fromkeys(m[0] for m in (*by_mesh, *by_step)))}; finest mesh: mean gap {mean:.2f} mm ({apart[0]} between the two finest meshes and steps), "
                     f"range {span:.2f} mm ({apart[1]}), " + (f"{frequency:.0f} Hz ({apart[2]})" if frequency > 0 else "fewer than two periods in the second half"))
    return "; ".join(texts), same
