# SPDX-License-Identifier: Apache-2.0
"""The load on walls: a cylinder that starts to oscillate in a viscous fluid, refined in step and mesh."""
import csv
import math

import couplet

AT = 1.25  # s
SWING = ("participants.fluid.viscosity=1 Pa s", "participants.fluid.viscous=implicit",
         'participants.fluid.motion.translation=["-(5/(4*pi))*(1-cos(0.4*pi*t))", 0]')


def force(job, step, cells):
    """x force [N] of a cylinder that moves by -(5/4 pi)(1 - cos 0.4 pi t), viscosity 1 Pa s: given at the middle of the steps."""
    def make():
        run = job.alone("oscillating-cylinder",
                            (*SWING, "participants.fluid.mesh-parameters={n: %d}" % cells, f"simulation.end-time={AT + 2 * step}", f"simulation.time-step={step}"))
        with open(run.folder / "fluid" / "forces.csv", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        parts = [i for i, name in enumerate(rows[0]) if name.endswith(" x [N]")]
        found = {round(float(row[0]) / step): sum(float(row[i]) for i in parts) for row in rows[1:]}
        n = round(AT / step)
        return (found[n] + found[n + 1]) / 2
    return job.once(("oscillating cylinder", step, cells), make)


def in_time(job):
    a, b, c = (force(job, step, 48) for step in (0.025, 0.0125, 0.00625))
    order = math.log2((a - b) / (b - c))
    return f"{a:.5f}, {b:.5f}, {c:.5f} N: order {order:.2f}", order >= 1.9


def near(job):
    fine, got = force(job, 0.0025, 192), force(job, 0.01, 48)
    return f"{100 * (got / fine - 1):+.3f} % of {fine:.5f} N", abs(got / fine - 1) <= 1e-3


def power(job):
    """Of the last step to 1.25 s: what the wall gives beside what the fluid gains and its viscosity takes, by forces.csv and energy.csv."""
    step = 0.01
    run = job.alone("oscillating-cylinder", (
        *SWING, "participants.fluid.mesh-parameters={n: 48}", f"simulation.end-time={AT}", f"simulation.time-step={step}", "participants.fluid.output.energy-budget=true"))
    forces, energy = (couplet.read_csv(run.folder / "fluid" / name) for name in ("forces.csv", "energy.csv"))
    force = sum(forces[name][-1] for name in forces if name.endswith(" x [N]"))
    moved = -(5 / (4 * math.pi)) * (math.cos(0.4 * math.pi * (AT - step)) - math.cos(0.4 * math.pi * AT))
    given = -force * moved / step
    taken = (energy["kinetic energy [J]"][-1] - energy["kinetic energy [J]"][-2]) / step + energy["viscous power [W]"][-2:].mean()
    return f"wall {given:.5f} W, fluid {taken:.5f} W: {100 * (taken / given - 1):+.2f} %", abs(taken / given - 1) < 1e-10
