# SPDX-License-Identifier: Apache-2.0
"""Thermal strain and plane stress at large strain beside their differential equations, a body of revolution beside its benchmark."""
import math

from validation.parts.right_by_default.scenes import probe, warnings


def bisect(wrong, low, high):
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if wrong(middle) < 0 else (low, middle)
    return low


def hot_inner_wall():
    """Of an incompressible ring in plane strain with stretches s(R): r^2 = c + 2 int s^3 R dR, and no traction at either wall:
    int (t_hoop - t_radial) / r dr = 0 with t_hoop - t_radial = 2 (c10 + c01 / s^2) (b_hoop - b_radial)."""
    n, c10, c01 = 2000, 0.8, 0.2

    def gap(inner):
        square, total = inner * inner, 0.0
        for i in range(n):
            R = 1 + (i + 0.5) / n
            s = 1 + 0.2 * math.log(2 / R) / math.log(2)
            at = square + s**3 * R / n  # r^2 in the middle
            square += 2 * s**3 * R / n
            hoop = at / (R * s) ** 2  # of the elastic part; the radial one follows from its volume
            radial = s * s / hoop
            total += 2 * (c10 + c01 / s**2) * (hoop - radial) * s**3 * R / at / n
        return total

    return bisect(gap, 0.9, 1.5) - 1


def sheet_inner_wall():
    """Of an incompressible sheet (neo-Hooke, mu = 1): dP/dR = (P_hoop - P) / R, P = a - a^-3 b^-2, no traction at the hole, outer
    radius 3."""
    n = 200

    def radial(P, b):
        return bisect(lambda a: a - a**-3 * b**-2 - P, 0.1, 10)

    def outer(inner):
        y = [inner, 0.0]

        def rate(R, at):
            b = at[0] / R
            a = radial(at[1], b)
            return (a, (b - b**-3 * a**-2 - at[1]) / R)

        h = 1 / n
        for i in range(n):
            R = 1 + i * h
            k = rate(R, y)
            k2 = rate(R + h / 2, [y[j] + h / 2 * k[j] for j in (0, 1)])
            y = [y[j] + h * k2[j] for j in (0, 1)]
        return y[0] - 3

    return bisect(outer, 1.0, 3.0) - 1


def run_of(job, file):
    name = file.replace("/", "-")
    return job.once(("file", file), lambda: job.case_run(job.root / "configs" / f"{file}.yaml", job.scratch / name, (), {"solid": 1}, 600))


def ring(job, case, right, within):
    """`right`: the function that gives it."""
    run = run_of(job, f"rubber-ring/{case}")
    error = probe(run, "inner wall x [m]") / globals()[right]() - 1
    said = warnings(run)
    return f"{100 * error:+.3f} %{', ' + said[0] if said else ', no warning'}", abs(error) <= within and not said
